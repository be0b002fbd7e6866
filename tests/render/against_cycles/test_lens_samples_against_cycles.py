"""Pictures through a real lens against Cycles with an OSL camera that traces the same lens."""

import math

import numpy as np
import pytest

from addon.lens_io.lens_shelf import LensShelf
from benchmarks.bokeh.lens import has_osl
from benchmarks.referees.osl_lens import osl_lens, shader_source
from tests.pictures import (
    render_aplanat,
    render_cycles,
    render_picture,
    save_side_by_side,
    ssim,
)

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

FOCUS = 2.0
# A picture that is distorted afterwards is traced larger.
_LARGER = 1.05


def use_lens(data, name, sensor_width, distortion="NONE", exposure="EVEN"):
    """Give a camera a lens wide open, with its focal length; return it as the OSL camera has it."""
    prescription = LensShelf([]).find(name).lens.prescription
    f_number = prescription.configuration(None).f_number
    lens = osl_lens(prescription, None, FOCUS, f_number)
    data.dof.use_dof, data.dof.aperture_fstop, data.dof.focus_distance = True, f_number, FOCUS
    data.lens = 2.0 * lens.pupil_radius * f_number
    data.sensor_fit, data.sensor_width = "HORIZONTAL", sensor_width
    data.aplanat.lens = name
    data.aplanat.distortion, data.aplanat.exposure = distortion, exposure
    data.aplanat.bokeh.use = False
    return lens


def world(scene, color):
    import bpy

    scene.world = bpy.data.worlds.new("world")
    background = next(n for n in scene.world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*color, 1.0)


def balls(scene):
    """Balls of plain colours from near to far, all over the picture."""
    import bpy

    rng = np.random.default_rng(3)
    for number in range(24):
        depth = (0.8, 1.4, 2.0, 3.5, 8.0)[number % 5]
        x, y = rng.uniform(-0.36, 0.36), rng.uniform(-0.24, 0.24)
        bpy.ops.mesh.primitive_ico_sphere_add(
            subdivisions=3, radius=0.04 * depth, location=(x * depth, y * depth, -depth)
        )
        material = bpy.data.materials.new("ball")
        tree = material.node_tree
        tree.nodes.clear()
        glow = tree.nodes.new("ShaderNodeEmission")
        glow.inputs["Color"].default_value = (*rng.uniform(0.1, 1.0, 3), 1.0)
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(glow.outputs["Emission"], output.inputs["Surface"])
        bpy.context.object.data.materials.append(material)


def wall(scene, side):
    """A chequered wall of two triangles in the plane of focus."""
    import bpy

    y, x = np.mgrid[:512, :512] // 8
    light = 0.1 + 0.8 * ((x + y) % 2)
    image = bpy.data.images.new("chequers", 512, 512, float_buffer=True)
    image.pixels = np.dstack([light, light, light, np.ones_like(light)]).astype(np.float32).ravel()
    bpy.ops.mesh.primitive_plane_add(size=side, location=(0.0, 0.0, -FOCUS))
    material = bpy.data.materials.new("wall")
    tree = material.node_tree
    tree.nodes.clear()
    picture = tree.nodes.new("ShaderNodeTexImage")
    picture.image = image
    glow = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(picture.outputs["Color"], glow.inputs["Color"])
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(glow.outputs["Emission"], output.inputs["Surface"])
    bpy.context.object.data.materials.append(material)


def traced(scene, data, lens, samples, folder, sides=None, wavelength=587.5618):
    """Render the traced lens; `sides` are those of the sensor that the picture shows, mm."""
    import _cycles

    height = data.sensor_width * scene.render.resolution_y / scene.render.resolution_x
    size = (data.sensor_width, height) if sides is None else sides
    source = shader_source(lens, size, data.lens, wavelength_nm=wavelength)
    (folder / "lens.osl").write_text(source)
    assert _cycles.osl_compile(str(folder / "lens.osl"), str(folder / "lens.oso"))
    data.type, data.custom_bytecode = "CUSTOM", (folder / "lens.oso").read_text()
    data.custom_bytecode_hash = "0" * 32
    picture = render_cycles(scene, samples)
    data.type = "PERSP"
    return picture


def _bilinear(picture, at):
    """Sample a picture at places in pixels, x and y, pixel centres at whole numbers."""
    size = np.array([picture.shape[1], picture.shape[0]])
    at = np.clip(at, 0.0, size - 1.001)
    low = at.astype(int)
    x, y = (at - low).T[..., None]
    column, row = low.T
    bottom = picture[row, column] * (1.0 - x) + picture[row, column + 1] * x
    top = picture[row + 1, column] * (1.0 - x) + picture[row + 1, column + 1] * x
    return bottom * (1.0 - y) + top * y


@pytest.mark.skipif(not has_osl(), reason="this Blender's Cycles comes without OSL")
def test_a_picture_is_that_of_the_traced_lens(empty_scene, camera, tmp_path):
    lens = use_lens(camera, "double-gauss-50mm-f2", 36.0, "LENS", "LENS")
    world(empty_scene, (0.05, 0.08, 0.15))
    balls(empty_scene)
    ours = render_aplanat(empty_scene, 128)
    theirs = traced(empty_scene, camera, lens, 768, tmp_path)
    camera.aplanat.lens = ""
    thin = render_aplanat(empty_scene, 128)
    save_side_by_side(tmp_path / "ours.png", ours, theirs)
    # Noise of the other picture alone leaves 0.98; a thin lens is far off.
    assert ssim(ours, theirs) > 0.96, tmp_path
    assert ssim(thin, theirs) < 0.94


@pytest.mark.skipif(not has_osl(), reason="this Blender's Cycles comes without OSL")
def test_another_wavelength_is_that_of_the_traced_lens(empty_scene, camera, tmp_path):
    violet = 435.8
    lens = use_lens(camera, "singlet-planoconvex-100mm", 20.0, "LENS", "LENS")
    world(empty_scene, (0.05, 0.08, 0.15))
    balls(empty_scene)
    chromatic = camera.aplanat.chromatic
    chromatic.use, chromatic.dispersion = True, "LENS"
    chromatic.wavelength_min, chromatic.wavelength_max = violet - 0.5, violet + 0.5
    ours = render_aplanat(empty_scene, 96)
    theirs = traced(empty_scene, camera, lens, 384, tmp_path, wavelength=violet)
    chromatic.use = False
    without = render_aplanat(empty_scene, 96)
    save_side_by_side(tmp_path / "ours.png", ours, theirs)
    assert ssim(ours, theirs) > 0.97, tmp_path
    assert 1.0 - ssim(without, theirs) > 2.0 * (1.0 - ssim(ours, theirs))


@pytest.mark.skipif(not has_osl(), reason="this Blender's Cycles comes without OSL")
def test_a_wall_of_two_triangles_is_blurred_by_the_curved_field(empty_scene, camera, tmp_path):
    lens = use_lens(camera, "petzval-100mm-f2.2", 30.0, "LENS", "LENS")
    wall(empty_scene, 90.0 / camera.lens)
    ours = render_aplanat(empty_scene, 128)
    theirs = traced(empty_scene, camera, lens, 512, tmp_path)
    save_side_by_side(tmp_path / "ours.png", ours, theirs)
    # Without dividing the triangles 0.8.
    assert ssim(ours, theirs) > 0.97, tmp_path


@pytest.mark.skipif(not has_osl(), reason="this Blender's Cycles comes without OSL")
def test_a_picture_through_cylinders_is_that_of_the_traced_lens(empty_scene, camera, tmp_path):
    from addon.lens_bokeh.samples.lens_rays import lens_rays
    from addon.optics.lens_facts import squeeze

    lens = use_lens(camera, "anamorphic-60mm-f2", 22.0, "NONE", "LENS")
    prescription = LensShelf([]).find("anamorphic-60mm-f2").lens.prescription
    camera.dof.aperture_ratio = squeeze(prescription)
    world(empty_scene, (0.05, 0.08, 0.15))
    balls(empty_scene)
    ours = render_aplanat(empty_scene, 128)
    render = empty_scene.render
    width, height = render.resolution_x, render.resolution_y
    # The sensor's picture is narrower than what is projected, and distorted: finer, and a little
    # larger, it is stretched and laid where our picture has it.
    sides = np.array([camera.sensor_width, camera.sensor_width * height / width])
    half = 0.5 * sides / camera.lens
    rays = lens_rays(prescription, None, FOCUS, 2.0, 0.3, sides=tuple(1.3 * half))
    render.resolution_x, render.resolution_y = 2 * width, 2 * height
    theirs = traced(
        empty_scene, camera, lens, 512, tmp_path, sides * rays.scale / rays.scale[1] * _LARGER
    )
    y, x = np.mgrid[:height, :width] + 0.5
    places = (np.stack([x / width, y / height], axis=-1).reshape(-1, 2) * 2.0 - 1.0) * half
    landing = places.copy()
    for _ in range(20):
        landing += places - rays.distortion.undone(landing)
    at = (landing / half / _LARGER + 1.0) * np.array([width, height]) - 0.5
    theirs = _bilinear(theirs, at).reshape(height, width, -1)
    save_side_by_side(tmp_path / "ours.png", ours, theirs)
    render.resolution_x, render.resolution_y = width, height
    camera.aplanat.lens = ""
    thin = render_aplanat(empty_scene, 128)
    assert ssim(ours, theirs) > 0.97, tmp_path
    assert 1.0 - ssim(thin, theirs) > 2.0 * (1.0 - ssim(ours, theirs))


def test_an_even_exposure_is_flat_and_that_of_the_lens_darkens_corners(empty_scene, camera):
    use_lens(camera, "double-gauss-50mm-f2", 36.0)
    world(empty_scene, (0.5, 0.5, 0.5))
    even = render_aplanat(empty_scene, 32)
    assert np.abs(even[..., :3] / 0.5 - 1.0).max() < 0.002
    assert np.abs(even[..., 3] - 1.0).max() < 0.002
    camera.aplanat.exposure = "LENS"
    lost = render_aplanat(empty_scene, 32)
    middle, corner = lost[30:34, 46:50].mean(), lost[:2, :2].mean()
    assert middle == pytest.approx(0.5 * 0.75 + 0.25 * 1.0, abs=0.01)
    tangent = math.hypot(18.0, 12.0) / camera.lens
    # The rims take more than the angle of the rays does.
    assert corner < middle / (1.0 + tangent**2) ** 2


def test_a_lens_that_cannot_be_traced_leaves_the_picture_to_a_thin_one(empty_scene, camera):
    world(empty_scene, (0.1, 0.1, 0.1))
    balls(empty_scene)
    use_lens(camera, "double-gauss-50mm-f2", 36.0)
    camera.dof.focus_distance = 0.02
    real = render_aplanat(empty_scene, 4)
    camera.aplanat.lens = ""
    assert np.array_equal(real, render_aplanat(empty_scene, 4))


@pytest.mark.parametrize("fixed", [False, True])
def test_the_adaptive_method_sees_through_the_lens(empty_scene, camera, tmp_path, fixed):
    use_lens(camera, "petzval-100mm-f2.2", 36.0)
    world(empty_scene, (0.05, 0.08, 0.15))
    balls(empty_scene)
    wanted = render_aplanat(empty_scene, 256)
    settings = empty_scene.aplanat
    settings.method = "ADAPTIVE"
    settings.use_target_error = not fixed
    settings.render_samples = 32
    found = render_picture(empty_scene)
    camera.aplanat.lens = ""
    thin = render_picture(empty_scene)
    save_side_by_side(tmp_path / "pictures.png", found, wanted)
    assert ssim(found, wanted) > 0.99, tmp_path
    assert 1.0 - ssim(thin, wanted) > 1.5 * (1.0 - ssim(found, wanted))
    # Alpha is that of an even world, however many samples each tile had.
    assert np.abs(found[..., 3] - 1.0).max() < 0.002
