"""Discs of highlights in colours, against the reference method, which knows no discs."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from addon.lens_bokeh.look.appearance import Appearance
from addon.lens_bokeh.look.vignetting_model import cat_eye
from addon.sampling.chromatic import ChromaticAberration
from addon.sampling.field_maps import FieldMap
from addon.sampling.highlights import highlight_share
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.content import ImageSnapshot, World, next_uid
from addon.snapshot.film import Sampling
from benchmarks.reference.chromatic import typical_coc
from tests.pictures import save_side_by_side, ssim
from tests.splat_pictures import library_lens

from ..conftest import WORLD_COLOR, make_renderer, render_snapshot, triangles_snapshot
from ..test_chromatic import LEVEL, STRONG, with_chromatic
from .bokeh_scenes import LAMPS, LENS, LIGHTS, PASSES, energy, lamp, with_bokeh

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT = 120, 80
# Multiples of the samples that share a place, and of the grid of wavelengths in a group.
MANY = 3 * 11 * 256
WHITE = (20.0, 20.0, 20.0)
SCENES = {
    # A lamp off the axis, behind the focus of all wavelengths.
    "behind": ([lamp(-1.5, 0.8, 8.0, 0.3)], [WHITE]),
    # In front of the focus of red, behind that of blue.
    "between": ([lamp(0.28, -0.2, 2.2, 0.1)], [WHITE]),
    "before": ([lamp(0.1, 0.12, 0.9, 0.035)], [WHITE]),
    "several": (LAMPS, LIGHTS),
}


def aberration(mode="SPECTRAL", axial=0.4, lateral=0.1, **others):
    return ChromaticAberration(mode, axial, lateral, STRONG, 0.05, **others)


def scene(name, chromatic, samples=192, lens=LENS, **options):
    corners, lights = SCENES[name]
    snapshot = triangles_snapshot(corners, lights, WIDTH, HEIGHT, lens, samples, **options)
    return with_chromatic(snapshot, chromatic)


def background(snapshot):
    return np.array(WORLD_COLOR) * snapshot.film.width * snapshot.film.height


def compare(snapshot, folder):
    """Compare splatted pictures with that of many samples; returns what the last one is."""
    many = replace(snapshot, sampling=Sampling("REFERENCE", MANY))
    expected = render_snapshot(many)["Combined"].astype(np.float64)
    for method in ("REFERENCE", "ADAPTIVE"):
        few = with_bokeh(snapshot)
        few = replace(few, sampling=replace(few.sampling, method=method))
        picture = render_snapshot(few)["Combined"].astype(np.float64)
        path = folder / f"{method}.png"
        save_side_by_side(path, picture[::-1], expected[::-1])
        assert ssim(picture, expected) >= 0.98, path
        # Lamps of 3 pixels, met by sub-pixels of a quarter and less: within a per cent.
        light = energy(expected) - background(snapshot)
        found = energy(picture) - background(snapshot)
        assert found / light == pytest.approx([1.0] * 3, abs=0.01), path


@pytest.mark.parametrize("mode", ["RGB", "SPECTRAL"])
@pytest.mark.parametrize("name", list(SCENES))
def test_discs_in_colors_are_what_the_reference_method_converges_to(name, mode, tmp_path):
    compare(scene(name, aberration(mode)), tmp_path)


MAPS = [
    (FieldMap("CURVE", curve_f=(0.0, 0.0)), FieldMap("COS_THETA")),
    (FieldMap("COS_THETA"), FieldMap("T2", "ONE_MINUS")),
]


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("maps", MAPS, ids=lambda maps: f"{maps[0].text}, {maps[1].text}")
def test_discs_follow_the_field(maps, parallel, tmp_path):
    axial_map, lateral_map = maps
    chromatic = aberration(axial=0.2, axial_map=axial_map, lateral_map=lateral_map)
    lens = ThinLens(0.2, 3.0, Iris(5, 0.2, 1.4))
    compare(scene("several", chromatic, lens=lens, parallel=parallel), tmp_path)


def test_the_worlds_highlights_are_discs_in_colors(tmp_path):
    snapshot = scene("several", aberration())
    pixels = np.zeros((128, 256, 4), np.float32)
    pixels[..., :3] = WORLD_COLOR
    # The camera looks along -z, to the image's upper end.
    bright = np.random.default_rng(5).random((128, 256)) < 0.004
    pixels[bright, :3] = 60.0
    image = ImageSnapshot(next_uid(), "world", pixels)
    content = snapshot.content
    world = World((1.0, 1.0, 1.0), image.uid)
    content = replace(content, images={image.uid: image}, world=world)
    view = np.eye(4)[[0, 2, 1, 3]] * np.array([1.0, 1.0, -1.0, 1.0])[:, None]
    camera = replace(snapshot.camera, view=view)
    snapshot = replace(snapshot, content=content, camera=camera)
    # Discs overlap: noise is less.
    many = replace(snapshot, sampling=Sampling("REFERENCE", MANY // 4))
    expected = render_snapshot(many)["Combined"].astype(np.float64)
    pictures = render_snapshot(with_bokeh(snapshot))
    picture = pictures["Combined"].astype(np.float64)
    save_side_by_side(tmp_path / "world.png", picture[::-1], expected[::-1])
    assert energy(pictures["Bokeh"]).min() > 0.1 * energy(expected).min()
    assert ssim(picture, expected) >= 0.98, tmp_path
    assert energy(picture) / energy(expected) == pytest.approx([1.0] * 3, abs=0.01)


@pytest.mark.parametrize("place", [(4.3, 0.0), (4.05, 2.75), (-4.3, -1.0)])
def test_colors_reach_in_from_outside_the_frame(place, tmp_path):
    corners, lights = [lamp(*place, 8.0, 0.15)], [(300.0, 300.0, 300.0)]
    snapshot = triangles_snapshot(corners, lights, WIDTH, HEIGHT, LENS, 96)
    # Smaller in blue: discs move towards the middle.
    snapshot = with_chromatic(snapshot, aberration(lateral=-0.15))
    many = replace(snapshot, sampling=Sampling("REFERENCE", MANY))
    expected = render_snapshot(many)["Combined"].astype(np.float64)
    picture = render_snapshot(with_bokeh(snapshot, overscan=1.0))["Combined"].astype(np.float64)
    save_side_by_side(tmp_path / "outside.png", picture[::-1], expected[::-1])
    assert ssim(picture, expected) >= 0.98, tmp_path
    light = energy(expected) - background(snapshot)
    found = energy(picture) - background(snapshot)
    assert found / light == pytest.approx([1.0] * 3, abs=0.03)


# The split -------------------------------------------------------------------------------------


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("depth", [2.35, 2.5, 2.7, 3.3])
def test_the_share_is_that_of_the_typical_circle(depth, parallel):
    # Around the focus of blue, in front of that of red; no map moves or grows the lamp.
    chromatic = aberration(lateral=0.0, axial=0.3, axial_map=LEVEL, lateral_map=LEVEL)
    corners = [lamp(0.2, 0.1, depth, 0.3)]
    snapshot = triangles_snapshot(corners, [WHITE], WIDTH, HEIGHT, LENS, 48, parallel=parallel)
    snapshot = with_chromatic(snapshot, chromatic)
    splitting = with_bokeh(snapshot)
    plan = plan_frame(splitting)
    coc = typical_coc(plan.chromatic, np.array([0.2, 0.1, -depth]), plan.coc_scale)
    share = float(highlight_share(coc, plan.bokeh.least_coc))
    pictures = render_snapshot(splitting)
    whole = render_snapshot(snapshot)["Combined"]
    light = energy(whole) - background(snapshot)
    # So bright that the samples keep nothing.
    light = light * WHITE[0] / (WHITE[0] - np.array(WORLD_COLOR))
    # A lamp of 20 pixels, met by 16 jittered samples and by sub-pixels.
    assert energy(pictures["Bokeh"]) == pytest.approx(share * light, rel=0.01)
    assert energy(pictures["Combined"]) == pytest.approx(energy(whole), rel=0.01)


def test_the_typical_circle_is_the_root_of_the_mean_square():
    snapshot = with_bokeh(scene("several", aberration(axial=0.1)))
    plan = plan_frame(snapshot)
    colors, eye = plan.bokeh.colors, np.array([0.4, 0.3, -2.0])
    axial = plan.chromatic.strengths(eye)[0]
    errors = np.array([band.focal_error for band in colors.bands])
    coc = plan.coc_scale * (plan.chromatic.inverse_focus_at(errors, axial) - 0.5)
    weights = np.mean([band.weights for band in colors.bands], axis=1)
    expected = np.sqrt((weights * coc**2).sum())
    assert typical_coc(plan.chromatic, eye, plan.coc_scale) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("method", ["REFERENCE", "ADAPTIVE"])
def test_without_strength_bokeh_keeps_its_bits(method):
    snapshot = with_bokeh(scene("several", None))
    snapshot = replace(snapshot, sampling=replace(snapshot.sampling, method=method))
    off = render_snapshot(snapshot)
    weak = render_snapshot(with_chromatic(snapshot, aberration(axial=0.0, lateral=0.0)))
    for name in PASSES:
        assert weak[name].tobytes() == off[name].tobytes()


def test_at_a_negligible_strength_there_is_one_disc():
    snapshot = with_bokeh(scene("several", aberration(axial=1e-4, lateral=1e-4)))
    assert len(plan_frame(snapshot).bokeh.colors.bands) == 1
    off = render_snapshot(with_chromatic(snapshot, None))["Combined"]
    weak = render_snapshot(snapshot)["Combined"]
    assert ssim(weak, off) > 0.999


def test_every_band_lies_within_what_culling_allows_for():
    snapshot = with_bokeh(scene("several", aberration(axial_map=FieldMap("COS_THETA"))))
    plan = plan_frame(snapshot)
    colors, chromatic = plan.bokeh.colors, plan.chromatic
    rng = np.random.default_rng(1)
    eye = np.column_stack([rng.uniform(-1, 1, (500, 2)), np.full(500, -1.0)])
    axial, lateral = chromatic.strengths(eye).T
    for band in colors.bands:
        change = chromatic.inverse_focus_at(band.focal_error, axial) - chromatic.inverse_focus
        assert change.min() >= colors.focus_changes[0] - 1e-9
        assert change.max() <= colors.focus_changes[1] + 1e-9
        assert np.abs(band.lateral_strength * lateral).max() <= colors.growth + 1e-9


# In the frame ----------------------------------------------------------------------------------


def test_a_draft_has_few_bands_and_the_same_light():
    snapshot = with_bokeh(scene("several", aberration()), passes=("Combined", "Bokeh"))
    renderer = make_renderer(snapshot)
    renderer._bokeh.seconds = np.inf
    plan = plan_frame(snapshot)
    renderer.restart(plan, snapshot, bokeh="DRAFT")
    renderer.advance(plan.samples)
    assert renderer.bokeh_drafted
    assert len(plan.bokeh.colors.draft().bands) == 4 < len(plan.bokeh.colors.bands)
    assert plan.bokeh.colors.draft().levels[-1].most == np.inf
    draft = renderer.read_passes()["Bokeh"]
    while renderer.bokeh_drafted:
        renderer.refine_bokeh()
    whole = renderer.read_passes()["Bokeh"]
    renderer.release()
    # Coarser sub-pixels meet small lamps less well.
    assert energy(draft) == pytest.approx(energy(whole), rel=0.1)
    assert draft.tobytes() != whole.tobytes()


def test_fringe_is_the_difference_of_whole_pictures():
    snapshot = with_bokeh(scene("several", aberration(), 24), passes=("Combined", "Fringe"))
    pictures = render_snapshot(snapshot)
    plain = render_snapshot(with_chromatic(snapshot, None, passes=("Combined",)))["Combined"]
    expected = pictures["Combined"][..., :3] - plain[..., :3]
    assert np.abs(pictures["Fringe"] - expected).max() < 1e-5


@pytest.mark.parametrize("chromatic", [None, aberration()], ids=["plain", "colors"])
def test_a_finer_raster_of_the_samples_leaves_the_discs_as_they_are(chromatic, monkeypatch):
    snapshot = with_bokeh(scene("several", chromatic), passes=("Bokeh",))
    expected = render_snapshot(snapshot)["Bokeh"]
    monkeypatch.setattr("addon.engine.planning.plan.subpixels", lambda *_: 2)
    assert plan_frame(snapshot).subpixels == 2
    assert render_snapshot(snapshot)["Bokeh"].tobytes() == expected.tobytes()


# With a real lens ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def real_lens():
    return library_lens("double-gauss-50mm-f2")


def with_lens(snapshot, real_lens, **settings):
    snapshot = with_bokeh(snapshot, passes=("Bokeh",), **settings)
    return replace(snapshot, camera=replace(snapshot.camera, real_lens=real_lens))


LOOKS = {
    "pupil": {"vignetting": "LENS"},
    "profile": {"vignetting": "NONE"},
    "rims": {"vignetting": "ANALYTIC", "appearance": Appearance(rims=cat_eye(0.3, 0.6, 3))},
}


def parting(picture):
    """Return by how much the channels of a picture differ, as a share of its brightest."""
    light = picture[..., :3].astype(np.float64)
    return np.ptp(light, axis=-1).max() / light.max()


@pytest.fixture(scope="module")
def light_of_discs(real_lens):
    """The light of a thin lens' discs, and what samples of the real lens have more than thin ones.

    A real lens does not show lamps as large as a pinhole does.
    """
    corners, _ = SCENES["behind"]
    snapshot = triangles_snapshot(corners, [WHITE], WIDTH, HEIGHT, LENS, 512)
    snapshot = replace(with_chromatic(snapshot, aberration()), passes=("Combined",))
    through = replace(snapshot, camera=replace(snapshot.camera, real_lens=real_lens))
    thin, seen = (energy(render_snapshot(part)["Combined"]) for part in (snapshot, through))
    return energy(render_snapshot(with_bokeh(snapshot, passes=("Bokeh",)))["Bokeh"]) + seen - thin


@pytest.mark.parametrize("look", list(LOOKS))
def test_any_look_has_all_the_light_in_colors(look, real_lens, light_of_discs):
    corners, _ = SCENES["behind"]
    snapshot = triangles_snapshot(corners, [WHITE], WIDTH, HEIGHT, LENS, 12)
    snapshot = with_chromatic(snapshot, aberration())
    drawn = render_snapshot(with_lens(snapshot, real_lens, **LOOKS[look]))["Bokeh"]
    # Discs of 4 to 10 pixels by texels of tables, and the noise of 512 samples.
    assert energy(drawn) == pytest.approx(light_of_discs, rel=0.02)
    assert parting(drawn) > 0.1


@pytest.mark.parametrize("look", ["profile", "rims"])
def test_a_real_lens_alone_has_no_colors(look, real_lens):
    corners, _ = SCENES["behind"]
    snapshot = triangles_snapshot(corners, [WHITE], WIDTH, HEIGHT, LENS, 12)
    drawn = render_snapshot(with_lens(snapshot, real_lens, **LOOKS[look]))["Bokeh"]
    # Half precision of the opening's channels.
    assert parting(drawn) < 2e-3
