"""A camera's bokeh as a value: what its settings become, and what they ask for in vain."""

import math
from dataclasses import replace

import numpy as np
import pytest

from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_bokeh.openings.pictures import PictureIris
from addon.scene.camera.bokeh import corner_tangent
from addon.scene.camera.camera import read_camera
from addon.scene.extract import SceneExtractor
from addon.scene.settings import read_passes, read_sampling
from addon.snapshot.camera import BokehSettings
from addon.snapshot.changes import same_camera
from addon.snapshot.film import Film
from tests import scene_builders as scenes

FILM = Film(96, 64, (0, 0, 96, 64))
TESSAR = "tessar-50mm-f2.8"
# Float properties have 32 bits.
SINGLE = 1e-6


@pytest.fixture
def camera(camera):
    camera.dof.use_dof = True
    camera.dof.focus_distance = 4.0
    camera.aplanat.bokeh.use = True
    return camera


@pytest.fixture
def bokeh(camera):
    return camera.aplanat.bokeh


def read(bpy):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return read_camera(depsgraph, depsgraph.scene.camera, FILM)


def test_bokeh_starts_as_the_settings_do(camera, aplanat_bpy):
    assert read(aplanat_bpy).bokeh == BokehSettings(highlights="AUTO")


def test_a_new_camera_has_it_until_it_is_switched_off(bokeh, aplanat_bpy):
    bokeh.property_unset("use")
    assert read(aplanat_bpy).bokeh is not None
    bokeh.use = False
    assert read(aplanat_bpy).bokeh is None


def test_all_numbers_and_choices_arrive(bokeh, aplanat_bpy):
    wanted = {
        "threshold": 2.5,
        "gain": 0.5,
        "model": "CLUSTERED",
        "cluster_levels": 3,
        "similarity": 2.0,
        "visibility": "WARP",
        "layers": 2,
        "overscan": 0.5,
        "lens_views": 9,
        "profile_strength": 0.5,
    }
    for name, value in wanted.items():
        setattr(bokeh, name, value)
    bokeh.use_global_merge, bokeh.use_world = True, False
    found = read(aplanat_bpy).bokeh
    assert {name: getattr(found, name) for name in wanted} == wanted
    assert found.global_merge and not found.world


def test_an_unchanged_camera_takes_the_same_picture_and_a_changed_one_does_not(bokeh, aplanat_bpy):
    bokeh.grain, bokeh.onion = 0.2, 0.1
    bokeh.vignetting = "ANALYTIC"
    first = read(aplanat_bpy)
    assert same_camera(first, read(aplanat_bpy))
    bokeh.grain = 0.21
    assert not same_camera(first, read(aplanat_bpy))


def test_the_opening_is_that_of_blenders_aperture(camera, bokeh, aplanat_bpy):
    camera.dof.aperture_blades, camera.dof.aperture_rotation = 6, 0.25
    camera.dof.aperture_ratio, bokeh.blade_curvature = 2.0, 0.5
    look = read(aplanat_bpy).bokeh.appearance
    assert (look.iris.blades, look.iris.curvature) == (6, 0.5)
    assert look.iris.rotation == pytest.approx(0.25, abs=SINGLE)
    assert look.anamorphic_ratio == 2.0
    # Blender knows no iris of 1 or 2 blades.
    camera.dof.aperture_blades = 0
    assert read(aplanat_bpy).bokeh.appearance.iris == BladedIris()


def test_a_real_lens_has_its_own_spherical_aberration_and_vignetting(camera, bokeh, aplanat_bpy):
    bokeh.hardness = 0.75
    thin = read(aplanat_bpy).bokeh
    assert (thin.appearance.edge, thin.vignetting) == (0.75, "NONE")
    camera.aplanat.lens = TESSAR
    bokeh.hardness = 0.75
    real = read(aplanat_bpy).bokeh
    assert (real.appearance.edge, real.vignetting) == (0.0, "LENS")


def test_an_anamorphic_lens_says_that_its_distortion_is_that_along_the_height(camera, aplanat_bpy):
    camera.aplanat.lens, camera.dof.aperture_fstop = "anamorphic-60mm-f2", 4.0
    assert read(aplanat_bpy).report == ()
    camera.aplanat.distortion = "LENS"
    assert "distortion along the height" in read(aplanat_bpy).report[-1]
    camera.aplanat.distortion, camera.dof.use_dof = "NONE", False
    assert read(aplanat_bpy).report == ()


def test_masks_that_do_nothing_are_left_out(bokeh, aplanat_bpy):
    bokeh.dust, bokeh.dust_depth = 10, 0.0
    look = read(aplanat_bpy).bokeh.appearance
    assert look.grain is None and look.onion is None and look.diffraction is None
    bokeh.dust_depth, bokeh.texture_seed = 0.5, 7
    grain = read(aplanat_bpy).bokeh.appearance.grain
    assert (grain.strength, grain.dust, grain.seed) == (0.0, 10, 7)


def test_ringing_keeps_white_white(bokeh, aplanat_bpy):
    bokeh.diffraction = 0.5
    ringing = read(aplanat_bpy).bokeh.appearance.diffraction
    assert ringing.strength == 0.5
    assert np.sum(ringing.weights, axis=0) == pytest.approx([1.0, 1.0, 1.0])


def test_cats_eyes_of_strength_1_move_the_rims_by_a_radius_in_the_corner(
    camera, bokeh, aplanat_bpy, empty_scene
):
    bokeh.vignetting, bokeh.vignetting_strength = "ANALYTIC", 1.0
    # A sensor 36 mm wide behind a lens of 50 mm, in the shape of 96 x 64 pixels.
    corner = math.hypot(18.0, 12.0) / 50.0
    camera.lens, camera.sensor_width, camera.sensor_fit = 50.0, 36.0, "HORIZONTAL"
    assert corner_tangent(camera, empty_scene) == pytest.approx(corner, rel=SINGLE)
    front, rear = read(aplanat_bpy).bokeh.appearance.rims
    assert front.shift * corner == pytest.approx(-1.0, rel=SINGLE)
    assert rear.shift * corner == pytest.approx(1.0, rel=SINGLE)
    assert front.members == 1
    bokeh.vignetting_softness = 1.0
    assert read(aplanat_bpy).bokeh.appearance.rims[0].members > 4


def test_a_parallel_camera_has_no_cats_eyes_and_says_so(camera, bokeh, aplanat_bpy):
    camera.type, bokeh.vignetting = "ORTHO", "ANALYTIC"
    found = read(aplanat_bpy)
    assert found.bokeh.appearance.rims == ()
    assert "camera 'Camera': cat's eyes are left out" in found.report[0]


def iris_image(bpy, picture, name="iris"):
    height, width = picture.shape
    image = bpy.data.images.new(name, width, height, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = picture[..., None]
    image.pixels.foreach_set(pixels.ravel())
    return image


def test_an_image_takes_the_place_of_the_blades_and_stays_itself(camera, bokeh, aplanat_bpy):
    picture = np.zeros((4, 8), np.float32)
    picture[1:3, 2:] = 0.5
    bokeh.iris_image = iris_image(aplanat_bpy, picture)
    camera.dof.aperture_rotation = 0.5
    first = read(aplanat_bpy)
    iris = first.bokeh.appearance.iris
    assert isinstance(iris, PictureIris) and iris.rotation == pytest.approx(0.5, abs=SINGLE)
    assert iris.coverage(np.array([[0.3, 0.0]]), 0.01).shape == (1,)
    # The brightest counts as open, rows from the bottom.
    assert np.array_equal(iris.picture, picture)
    assert same_camera(first, read(aplanat_bpy))
    bokeh.iris_image.pixels[2 * 8 * 4] = 1.0
    bokeh.iris_image.update()
    assert not same_camera(first, read(aplanat_bpy))


def test_bytes_of_an_image_are_decoded(bokeh, aplanat_bpy):
    image = aplanat_bpy.data.images.new("iris", 2, 2)
    pixels = np.ones((2, 2, 4), np.float32)
    pixels[0, 0, :3] = 188 / 255
    image.pixels.foreach_set(pixels.ravel())
    bokeh.iris_image = image
    iris = read(aplanat_bpy).bokeh.appearance.iris
    # 188 is half as bright as white, within a byte's step.
    assert iris.picture[0, 0] == pytest.approx(0.5, abs=0.004)


def test_a_large_image_is_reduced_and_keeps_its_light(bokeh, aplanat_bpy):
    picture = np.random.default_rng(1).random((1500, 2500)).astype(np.float32)
    bokeh.iris_image = iris_image(aplanat_bpy, picture)
    iris = read(aplanat_bpy).bokeh.appearance.iris
    assert iris.picture.shape == (500, 834)
    assert iris.picture.sum() * 9 == pytest.approx(picture.sum(), rel=1e-5)


def test_an_unusable_image_is_told_and_the_blades_are_drawn(bokeh, aplanat_bpy):
    bokeh.iris_image = aplanat_bpy.data.images.new("black", 4, 4)
    found = read(aplanat_bpy)
    assert found.bokeh.appearance.iris == BladedIris()
    assert "iris image 'black'" in found.report[0] and "blades" in found.report[0]
    bokeh.iris_image.source = "FILE"
    bokeh.iris_image.filepath = "//nowhere.png"
    assert "cannot be read" in read(aplanat_bpy).report[0]


def test_everything_can_be_animated(camera, bokeh, empty_scene, aplanat_bpy):
    for name, values in (
        ("threshold", (1.0, 3.0)),
        ("gain", (1.0, 0.0)),
        ("hardness", (-1.0, 1.0)),
        ("use", (False, True)),
        ("visibility", ("WARP", "SPLAT")),
        ("model", ("POINT", "CLUSTERED")),
    ):
        for frame, value in zip((1, 11), values, strict=True):
            setattr(bokeh, name, value)
            assert camera.keyframe_insert(f"aplanat.bokeh.{name}", frame=frame), name
    empty_scene.frame_set(1)
    assert read(aplanat_bpy).bokeh is None
    empty_scene.frame_set(11)
    found = read(aplanat_bpy).bokeh
    assert (found.threshold, found.gain, found.appearance.edge) == (3.0, 0.0, 1.0)
    assert (found.visibility, found.model) == ("SPLAT", "CLUSTERED")


def test_a_driver_sets_the_hardness(camera, bokeh, empty_scene, aplanat_bpy):
    driver = camera.driver_add("aplanat.bokeh.hardness").driver
    driver.expression = "frame / 10"
    empty_scene.frame_set(5)
    assert read(aplanat_bpy).bokeh.appearance.edge == pytest.approx(0.5)


def test_a_material_may_never_shine_as_bokeh(camera, empty_scene, aplanat_bpy):
    bpy = aplanat_bpy
    material = scenes.emission(bpy, "Lamp", (1, 1, 1))
    scenes.add(bpy, "lamp", scenes.cube(bpy), material)
    with scenes.told_of_updates(bpy, SceneExtractor()) as extractor:

        def look():
            depsgraph = bpy.context.evaluated_depsgraph_get()
            return extractor.extract_content(depsgraph).materials.values()

        (first,) = look()
        assert first.highlights
        material.aplanat.highlights = "NEVER"
        (second,) = look()
        assert not second.highlights
        # Another number: pictures that were made of the old one are stale.
        assert second.uid != first.uid
        (third,) = look()
        assert third is second


def test_the_debug_view_is_read_and_told(bokeh, aplanat_bpy):
    assert read(aplanat_bpy).report == ()
    bokeh.debug_view = "CLUSTERS"
    found = read(aplanat_bpy)
    assert found.bokeh.debug_view == "CLUSTERS"
    assert found.report == ("camera 'Camera': the picture is the debug view of the bokeh",)
    bokeh.use = False
    assert read(aplanat_bpy).report == ()


def test_a_lamp_may_never_shine_as_bokeh(empty_scene, aplanat_bpy):
    bpy = aplanat_bpy
    lamp = bpy.data.lights.new("Lamp", "POINT")
    lamp.energy = 100.0
    scenes.add(bpy, "Lamp", lamp)
    with scenes.told_of_updates(bpy, SceneExtractor()) as extractor:

        def look():
            depsgraph = bpy.context.evaluated_depsgraph_get()
            return extractor.extract_content(depsgraph).lights

        (first,) = look()
        assert first.highlights
        lamp.aplanat.highlights = "NEVER"
        (second,) = look()
        assert second == replace(first, highlights=False)


def test_the_reference_method_samples_highlights_unless_told_otherwise(empty_scene):
    assert not read_sampling(empty_scene).reference_bokeh
    empty_scene.aplanat.use_reference_bokeh = True
    assert read_sampling(empty_scene).reference_bokeh


def test_the_two_parts_of_combined_are_passes(empty_scene):
    layer = empty_scene.view_layers[0]
    layer.use_pass_z = False
    layer.aplanat.use_pass_defocus = layer.aplanat.use_pass_bokeh = True
    assert read_passes(layer) == ("Combined", "Defocus", "Bokeh")
