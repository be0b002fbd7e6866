"""Chromatic aberration of whole scenes: against Cycles, against many samples, against its model.

`aplanat bench --chromatic` prints the same numbers at larger sizes.
"""

import numpy as np
import pytest

from addon.device.context import ensure_context
from addon.errors import DeviceUnavailableError
from addon.sampling.chromatic import RGB_WAVELENGTHS_NM
from addon.sampling.equalizer import band
from addon.sampling.field_maps import FieldMap
from benchmarks.benches.chromatic import EVEN, SCENE_AXIAL
from benchmarks.benches.chromatic_measures import (
    aberration,
    centroid_errors,
    count_maxima,
    sampled_plan,
    with_aberration,
)
from benchmarks.benches.cycles_channels import channels_of_cycles
from benchmarks.benches.frames import BenchScene
from benchmarks.referees import chromatic_charts
from benchmarks.referees.picture_metrics import compare
from benchmarks.referees.shared_scenes import shared_scene
from tests.pictures import render_aplanat, render_picture

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

RESOLUTION = (112, 63)


class _Quiet:
    def say(self, _):
        """Say nothing."""


@pytest.fixture
def bench(aplanat_bpy):
    """Return a function that reads a scene; what it holds is given back at the end."""
    try:
        ensure_context()
    except DeviceUnavailableError as error:
        pytest.skip(str(error))
    made = []

    def make(scene):
        made.append(BenchScene(scene))
        return made[-1]

    yield make
    for one in made:
        one.close()


def against_cycles(scene, name, bench, cycles_samples, axial):
    read = bench(scene)
    chromatic = aberration(
        "RGB", scene.camera.data.lens / 1000.0, axial, 0.0, axial_map=EVEN, lateral_map=EVEN
    )
    snapshot = read.sampled("REFERENCE", 768)
    focus = snapshot.camera.lens.focus_distance
    distances = chromatic.focus_distances(focus, np.array(RGB_WAVELENGTHS_NM)).tolist()
    ours = read.draw(with_aberration(snapshot, chromatic)).picture[::-1]
    plain = read.draw(snapshot).picture[::-1]
    reference = channels_of_cycles(scene, name, distances, cycles_samples)
    return compare(ours, reference), compare(plain, reference)


def test_points_agree_with_cycles_channel_by_channel(bench):
    scene = chromatic_charts.points(RESOLUTION)
    ours, plain = against_cycles(scene, "points", bench, 1024, 1.0)
    assert ours["ssim_srgb"] >= 0.98
    # Without chromatic aberration it is another picture.
    assert plain["ssim_srgb"] < 0.95


def test_balls_agree_with_cycles_channel_by_channel(bench, shared):
    from benchmarks.benches.scenes import Case, open_scene

    file = shared_scene("balls", "flat", _Quiet())
    scene = open_scene(Case("balls", file, 1536, {}), RESOLUTION)
    ours, plain = against_cycles(scene, "balls", bench, 192, SCENE_AXIAL)
    assert ours["ssim_srgb"] >= 0.98
    assert plain["ssim_srgb"] < ours["ssim_srgb"]


def test_few_samples_of_the_spectrum_are_near_many(bench, shared):
    from benchmarks.benches.scenes import Case, open_scene

    file = shared_scene("balls", "flat", _Quiet())
    scene = open_scene(Case("balls", file, 128, {}), RESOLUTION)
    read = bench(scene)
    chromatic = aberration("SPECTRAL", scene.camera.data.lens / 1000.0, SCENE_AXIAL)
    few, many = (
        read.draw(with_aberration(read.sampled("REFERENCE", samples), chromatic)).picture
        # With more, the two are closer still; the benchmark takes 4096.
        for samples in (128, 512)
    )
    assert compare(few, many)["ssim_srgb"] >= 0.98


def test_fringes_have_no_bands(bench):
    scene, columns = chromatic_charts.bars((480, 90))
    read = bench(scene)
    chromatic = aberration(axial=0.2)
    counts = []
    for samples in (128, 2048):
        picture = read.draw(with_aberration(read.sampled("REFERENCE", samples), chromatic)).picture
        profile = picture[37:53].mean(axis=0)
        counts.append([[count_maxima(profile[a:b, c]) for c in range(3)] for a, b in columns])
    assert counts[0] == counts[1]
    # Three wavelengths make three separate bars.
    chromatic = aberration("RGB", axial=0.2)
    assert all(1 <= n <= 3 for each in counts[1] for n in each)


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.2, -0.1)])
@pytest.mark.parametrize("mode", ["RGB", "SPECTRAL"])
@pytest.mark.parametrize("lateral_map", [FieldMap(), FieldMap("T3", "EXP"), FieldMap("COS_THETA")])
def test_a_field_of_points_is_displaced_as_the_model_says(bench, shift, mode, lateral_map):
    scene, places = chromatic_charts.field_of_points((320, 180), shift)
    read = bench(scene)
    chromatic = aberration(mode, axial=0.0, lateral=0.04, lateral_map=lateral_map)
    snapshot = with_aberration(read.sampled("REFERENCE", 96), chromatic)
    assert centroid_errors(read.draw(snapshot).picture, snapshot, places) <= 0.1


def test_importance_sampling_of_a_narrow_band_has_a_third_of_the_variance(bench):
    read = bench(chromatic_charts.points(RESOLUTION))
    chromatic = aberration(equalizer=band(550.0, 40.0))
    many = with_aberration(read.sampled("REFERENCE", 1536), chromatic)
    truth = read.draw(many).picture
    squares = {True: 0.0, False: 0.0}
    for seed in (1, 2, 3):
        snapshot = with_aberration(read.sampled("REFERENCE", 48, seed=seed), chromatic)
        for importance in squares:
            found = read.draw(snapshot, plan=sampled_plan(snapshot, importance)).picture
            squares[importance] += float(np.square(found - truth).mean())
    assert squares[False] >= 3.0 * squares[True]


def test_hills_of_a_profile_are_counted():
    x = np.linspace(0.0, 1.0, 200)
    assert count_maxima(np.sin(np.pi * x)) == 1
    assert count_maxima(np.sin(3.0 * np.pi * x) ** 2) == 3
    # Ripples of less than 2 % are none.
    assert count_maxima(np.sin(np.pi * x) + 0.005 * np.sin(60.0 * x)) == 1


def test_discs_of_a_real_lens_have_the_colors_of_its_samples(empty_scene, camera):
    bpy = pytest.importorskip("bpy")
    for place in ((-0.06, 0.035, -1.2), (0.5, 0.3, -8.0)):
        bpy.ops.mesh.primitive_ico_sphere_add(
            subdivisions=2, radius=-0.006 * place[2], location=place
        )
        material = bpy.data.materials.new("lamp")
        tree = material.node_tree
        tree.nodes.clear()
        glow = tree.nodes.new("ShaderNodeEmission")
        glow.inputs["Strength"].default_value = 100.0
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(glow.outputs["Emission"], output.inputs["Surface"])
        bpy.context.object.data.materials.append(material)
    camera.lens, camera.sensor_width = 99.65, 20.0
    camera.dof.use_dof, camera.dof.aperture_fstop, camera.dof.focus_distance = True, 4.0, 2.0
    settings = camera.aplanat
    settings.lens, settings.bokeh.vignetting = "singlet-planoconvex-100mm", "LENS"
    chromatic = settings.chromatic
    chromatic.use, chromatic.dispersion, chromatic.mode = True, "LENS", "RGB"
    settings.bokeh.use = False
    samples = render_aplanat(empty_scene, 384)[..., :3]
    scene = empty_scene.aplanat
    scene.method, scene.use_target_error, scene.render_samples = "ADAPTIVE", False, 12
    settings.bokeh.use = True
    discs = render_picture(empty_scene)[..., :3]
    chromatic.use = False
    grey = render_picture(empty_scene)[..., :3]
    error, without = (np.square(each - samples).mean() for each in (discs, grey))
    # Noise of the samples is most of it.
    assert error < 0.3 * without
    # Each channel has all of its light.
    assert discs.sum(axis=(0, 1)) == pytest.approx(samples.sum(axis=(0, 1)), rel=0.03)
