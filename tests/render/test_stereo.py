"""Stereoscopic renders: every view, seen from where Cycles sees it.

The referee is Cycles with a box filter of one pixel and 64 samples. The scene has flat colours of 0
to 1 and few edges; its pictures of one engine with two seeds differ by 4e-4 in the mean, those of
two neighbouring eyes by 2e-2 and more (orthographic: 2e-3).
"""

import numpy as np
import OpenEXR
import pytest

from benchmarks.scenes.small_scene import build_scene

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

# Three times the noise, a third of the smallest difference between two eyes.
TOLERANCE = 7e-4


def build(bpy, change):
    scene = build_scene(bpy)
    camera = scene.camera
    camera.location, camera.rotation_euler = (0.1, 0.2, 0.3), (0.1, 0.05, 0.2)
    camera.scale = (2, 2, 2)
    camera.data.dof.use_dof = False
    stereo = camera.data.stereo
    stereo.interocular_distance, stereo.convergence_distance = 0.4, 4.0
    render = scene.render
    render.use_multiview, render.views_format = True, "STEREO_3D"
    render.filter_size = 1.0
    scene.aplanat.pixel_filter, scene.aplanat.render_samples = "BOX", 64
    cycles = scene.cycles
    cycles.samples, cycles.pixel_filter_type, cycles.filter_width = 64, "BOX", 1.0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    change(bpy, scene)
    return scene


def render_views(bpy, folder, engine, change):
    """Render as an animation of one frame; return the pictures by the suffix of the file."""
    scene = build(bpy, change)
    scene.render.engine = engine
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR", "32"
    settings.views_format = "INDIVIDUAL"
    scene.render.filepath = str(folder / engine / "v_####")
    bpy.ops.render.render(animation=True, frame_start=1, frame_end=1)
    pictures = {}
    for path in sorted((folder / engine).iterdir()):
        with OpenEXR.File(str(path)) as file:
            pictures[path.name] = np.array(file.channels()["RGBA"].pixels)
    return pictures


def camera_set(**values):
    def change(_bpy, scene):
        for name, value in values.items():
            target = scene.camera.data
            *owners, name = name.split(".")
            for owner in owners:
                target = getattr(target, owner)
            setattr(target, name, value)

    return change


def focus_on_an_object(_bpy, scene):
    dof = scene.camera.data.dof
    dof.use_dof, dof.aperture_fstop = True, 0.2
    dof.focus_object = scene.objects["Near"]
    # Blurred edges are as noisy as the samples are few.
    scene.cycles.samples, scene.aplanat.render_samples = 512, 256


def a_camera_a_view(bpy, scene):
    scene.render.views_format = "MULTIVIEW"
    scene.camera.name = "Cam_L"
    scene.camera.data.lens = 70.0
    other = bpy.data.objects.new("Cam_R", bpy.data.cameras.new("R"))
    other.data.lens, other.location = 35.0, (0.5, 0, 0)
    scene.collection.objects.link(other)
    # No camera ends in _T: this view has the scene's own.
    third = scene.render.views.new("third")
    third.camera_suffix, third.file_suffix = "_T", "_third"


@pytest.mark.parametrize(
    "change",
    [
        camera_set(**{"stereo.convergence_mode": "OFFAXIS", "shift_x": 0.1}),
        camera_set(**{"stereo.convergence_mode": "OFFAXIS", "sensor_fit": "VERTICAL"}),
        camera_set(**{"stereo.convergence_mode": "OFFAXIS", "stereo.pivot": "CENTER"}),
        camera_set(**{"stereo.convergence_mode": "TOE"}),
        camera_set(**{"stereo.convergence_mode": "PARALLEL"}),
        camera_set(type="ORTHO", ortho_scale=3.0),
        focus_on_an_object,
        a_camera_a_view,
    ],
    ids=["off-axis", "vertical", "centre", "toe-in", "parallel", "ortho", "focus object", "views"],
)
def test_every_view_is_seen_as_cycles_sees_it(aplanat_bpy, tmp_path, change):
    ours = render_views(aplanat_bpy, tmp_path, "APLANAT", change)
    cycles = render_views(aplanat_bpy, tmp_path, "CYCLES", change)
    assert ours.keys() == cycles.keys() and len(ours) >= 2
    for name, picture in ours.items():
        assert np.abs(picture - cycles[name]).mean() < TOLERANCE, name
    first, second, *_ = ours.values()
    assert np.abs(first - second).mean() > 2 * TOLERANCE


def test_vectors_of_an_eye_are_measured_from_its_own_place(aplanat_bpy, tmp_path):
    def move(bpy, scene):
        scene.view_layers[0].use_pass_vector = True
        scene.camera.keyframe_insert("location", frame=1)
        scene.camera.location.x += 0.5
        scene.camera.keyframe_insert("location", frame=2)

    found = {}
    for engine in ("APLANAT", "CYCLES"):
        scene = build(aplanat_bpy, move)
        scene.render.engine = engine
        settings = scene.render.image_settings
        settings.media_type = "MULTI_LAYER_IMAGE"
        settings.file_format, settings.views_format = "OPEN_EXR_MULTILAYER", "INDIVIDUAL"
        scene.render.filepath = str(tmp_path / engine)
        aplanat_bpy.ops.render.render(animation=True, frame_start=1, frame_end=1)
        with OpenEXR.File(str(tmp_path / f"{engine}0001_R.exr"), separate_channels=True) as file:
            parts = {name: c.pixels for part in file.parts for name, c in part.channels.items()}
        found[engine] = np.array([parts[f"ViewLayer.Vector.{c}"][16, 24] for c in "XYZW"])
    # Cycles takes one place of the pixel, we its middle; the far plane moves by 3 pixels and more.
    np.testing.assert_allclose(found["APLANAT"], found["CYCLES"], atol=0.02)
    assert np.abs(found["APLANAT"]).max() > 1.0


def test_spherical_stereo_is_told(aplanat_bpy, tmp_path):
    from addon.engine.shared_resources import listen

    build(aplanat_bpy, camera_set(**{"stereo.use_spherical_stereo": True}))
    aplanat_bpy.context.scene.render.engine = "APLANAT"
    with listen() as heard:
        aplanat_bpy.ops.render.render()
    assert [line for line in heard.report if "camera 'Camera': spherical stereo" in line]
