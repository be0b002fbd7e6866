"""Scenes at the ends of what Blender lets one set: each renders, with finite pixels."""

import numpy as np
import pytest

from addon.engine.shared_resources import listen
from addon.errors import CameraError
from tests.scene_builders import emission

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture
def build(aplanat_bpy):
    """Build a lamp out of focus behind a card in focus: `build(width, height)`."""
    bpy = aplanat_bpy

    def make(width=48, height=27):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        scene.render.resolution_x, scene.render.resolution_y = width, height
        scene.render.resolution_percentage = 100
        camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        scene.collection.objects.link(camera)
        scene.camera = camera
        camera.rotation_euler = (np.pi / 2, 0.0, 0.0)
        dof = camera.data.dof
        dof.use_dof, dof.aperture_fstop, dof.focus_distance = True, 0.2, 3.0
        for name, at, size, color in (
            ("lamp", (-0.8, 9.0, 0.3), 0.6, (30.0, 20.0, 10.0)),
            ("card", (0.3, 3.0, 0.0), 0.5, (0.3, 0.2, 0.1)),
        ):
            scene.collection.objects.link(square(bpy, name, at, size, color))
        return scene

    return make


def square(bpy, name, at, size, color):
    half = size / 2.0
    data = bpy.data.meshes.new(name)
    corners = [(-half, 0, -half), (half, 0, -half), (half, 0, half), (-half, 0, half)]
    data.from_pydata(corners, [], [(0, 1, 2, 3)])
    data.materials.append(emission(bpy, name, color))
    item = bpy.data.objects.new(name, data)
    item.location = at
    return item


def render(bpy, method="ADAPTIVE", samples=None):
    """Render the open scene and return its passes, by view layer; nothing may be unfinished."""
    scene = bpy.context.scene
    scene.render.engine, scene.aplanat.method = "APLANAT", method
    if samples is not None:
        scene.aplanat.use_target_error, scene.aplanat.render_samples = False, samples
    elif method == "REFERENCE":
        scene.aplanat.render_samples = 16
    with listen(keep_pictures=True) as heard:
        bpy.ops.render.render()
    if heard.error is not None:
        raise heard.error
    for layer in heard.layers:
        for name, picture in layer.passes.items():
            assert np.isfinite(picture.pixels).all(), f"{layer.layer}: {name}"
    return {layer.layer: layer.passes for layer in heard.layers}


def combined(bpy, **how):
    return render(bpy, **how)["ViewLayer"]["Combined"].pixels.astype(np.float64)


def _camera(**values):
    def change(_bpy, scene):
        for name, value in values.items():
            setattr(scene.camera.data, name, value)

    return change


def _lens(**values):
    def change(_bpy, scene):
        for name, value in values.items():
            setattr(scene.camera.data.dof, name, value)

    return change


def _scaled(*scale):
    def change(bpy, scene):
        item = square(bpy, "scaled", (0.0, 4.0, 0.0), 1.0, (5.0, 5.0, 5.0))
        item.scale = scale
        scene.collection.objects.link(item)

    return change


def _mesh(vertices, edges=(), faces=()):
    def change(bpy, scene):
        data = bpy.data.meshes.new("odd")
        data.from_pydata(vertices, list(edges), list(faces))
        data.materials.append(emission(bpy, "odd", (9.0, 9.0, 9.0)))
        scene.collection.objects.link(bpy.data.objects.new("odd", data))

    return change


def _light(kind, **values):
    def change(bpy, scene):
        scale = values.pop("scale", (1.0, 1.0, 1.0)) if "scale" in values else (1.0, 1.0, 1.0)
        data = bpy.data.lights.new("light", kind)
        for name, value in values.items():
            setattr(data, name, value)
        item = bpy.data.objects.new("light", data)
        item.location, item.scale = (1.0, 2.0, 2.0), scale
        scene.collection.objects.link(item)
        white = bpy.data.materials.new("white")
        next(x for x in scene.objects if x.name == "card").data.materials[0] = white

    return change


def _empty_instance(bpy, scene):
    item = bpy.data.objects.new("instance", None)
    item.instance_type = "COLLECTION"
    item.instance_collection = bpy.data.collections.new("empty")
    scene.collection.objects.link(item)


def _nothing_left(bpy, scene):
    for item in list(scene.objects):
        if item.type == "MESH":
            bpy.data.objects.remove(item)


def _all_behind(_bpy, scene):
    scene.camera.rotation_euler.z = np.pi


def _all_held_out(_bpy, scene):
    for item in scene.objects:
        item.is_holdout = True


def _masked_away(_bpy, scene):
    next(x for x in scene.objects if x.name == "card").modifiers.new("mask", "MASK")


def _world(height, width):
    def change(bpy, scene):
        world = scene.world = bpy.data.worlds.new("world")
        nodes = world.node_tree.nodes
        node = nodes.new("ShaderNodeTexEnvironment")
        node.image = bpy.data.images.new("strip", width, height, float_buffer=True)
        pixels = np.random.default_rng(0).random(height * width * 4, np.float32)
        node.image.pixels.foreach_set(pixels)
        background = next(x for x in nodes if x.type == "BACKGROUND")
        world.node_tree.links.new(node.outputs["Color"], background.inputs["Color"])
        next(x for x in scene.objects if x.name == "card").data.materials[0] = (
            bpy.data.materials.new("lit")
        )

    return change


def _every_pass(_bpy, scene):
    for settings in (scene.view_layers[0], scene.view_layers[0].aplanat):
        for name in dir(settings):
            if name.startswith("use_pass_"):
                setattr(settings, name, True)


def _nothing_in_every_pass(bpy, scene):
    _nothing_left(bpy, scene)
    _every_pass(bpy, scene)


ODD = {
    "aperture almost closed": _lens(aperture_fstop=1e6),
    "one blade": _lens(aperture_blades=1),
    "two blades": _lens(aperture_blades=2),
    "sixteen blades": _lens(aperture_blades=16),
    "anamorphic": _lens(aperture_ratio=100.0),
    "focus far away": _lens(focus_distance=1e9),
    "shortest focal length": _camera(lens=1.0),
    "longest focal length": _camera(lens=5000.0),
    "orthographic": _camera(type="ORTHO"),
    "orthographic, scale 0": _camera(type="ORTHO", ortho_scale=0.0),
    "clip planes in one place": _camera(clip_start=1.0, clip_end=1.0),
    "clip planes swapped": _camera(clip_start=10.0, clip_end=1.0),
    "far clip plane": _camera(clip_start=1e-6, clip_end=1e12),
    "shifted away": _camera(shift_x=10.0),
    "scale 0": _scaled(0.0, 0.0, 0.0),
    "flat": _scaled(0.0, 1.0, 1.0),
    "mirrored": _scaled(-1.0, 1.0, 1.0),
    "tiny": _scaled(1e-7, 1e-7, 1e-7),
    "huge": _scaled(1e18, 1e18, 1e18),
    "edges only": _mesh([(0, 5, 0), (1, 5, 0)], edges=[(0, 1)]),
    "no vertices": _mesh([]),
    "all vertices in one place": _mesh([(0, 5, 0)] * 4, faces=[(0, 1, 2, 3)]),
    "mesh that a modifier removes": _masked_away,
    "light of no size": _light("AREA", size=0.0),
    "light scaled to nothing": _light("AREA", scale=(0.0, 0.0, 0.0)),
    "sun of no angle": _light("SUN", angle=0.0, energy=50.0),
    "narrow spot": _light("SPOT", spot_size=np.radians(1.0), spot_blend=0.0, shadow_soft_size=0.0),
    "light without energy": _light("POINT", energy=0.0),
    "empty instance": _empty_instance,
    "no meshes": _nothing_left,
    "everything behind the camera": _all_behind,
    "everything held out": _all_held_out,
    "every pass": _every_pass,
    "every pass of nothing": _nothing_in_every_pass,
    "world of one texel": _world(1, 1),
    "world of a row": _world(1, 300),
    "world of a column": _world(300, 1),
    "world that halves to a row": _world(7, 256),
    "world larger than its levels, and narrow": _world(2, 3000),
}


# A world's light is made once, whichever method asks for it, and takes a second.
_CASES = [(name, "ADAPTIVE") for name in ODD]
_CASES += [(name, "REFERENCE") for name in ODD if not name.startswith("world")]


@pytest.mark.parametrize("name, method", _CASES)
def test_an_odd_scene_renders(name, method, aplanat_bpy, build):
    ODD[name](aplanat_bpy, build())
    assert render(aplanat_bpy, method)


# Blender's own least resolution is 4 x 4; a render region may have a single pixel.
@pytest.mark.parametrize("size", [(4, 4), (4, 64), (200, 4)])
def test_a_tiny_picture_of_everything_renders(size, aplanat_bpy, build):
    scene = build(*size)
    _every_pass(aplanat_bpy, scene)
    passes = render(aplanat_bpy)["ViewLayer"]
    assert passes["Combined"].pixels.shape == (size[1], size[0], 4)


@pytest.mark.parametrize("size", [(1, 1), (2, 1), (1, 9), (40, 1)])
def test_a_tiny_region_of_everything_renders(size, aplanat_bpy, build):
    scene = build()
    settings = scene.render
    settings.use_border = settings.use_crop_to_border = True
    # Half a pixel more: Blender rounds both ends down.
    settings.border_min_x, settings.border_max_x = 4.5 / 48, (4.5 + size[0]) / 48
    settings.border_min_y, settings.border_max_y = 9.5 / 27, (9.5 + size[1]) / 27
    _every_pass(aplanat_bpy, scene)
    passes = render(aplanat_bpy)["ViewLayer"]
    assert passes["Combined"].pixels.shape == (size[1], size[0], 4)


@pytest.mark.parametrize("kind", ["BLACKMAN_HARRIS", "BOX"])
@pytest.mark.parametrize("method", ["ADAPTIVE", "REFERENCE"])
def test_a_pixel_filter_of_no_size_keeps_the_light(kind, method, aplanat_bpy, build):
    sums = []
    for size in (0.0, 1.0):
        scene = build()
        # Several triangles a pixel: the reference method draws sub-pixels.
        card = next(x for x in scene.objects if x.name == "card")
        card.modifiers.new("finer", "SUBSURF").render_levels = 6
        card.modifiers["finer"].subdivision_type = "SIMPLE"
        next(x for x in scene.objects if x.name == "lamp").scale = (4.0, 1.0, 4.0)
        scene.aplanat.pixel_filter, scene.render.filter_size = kind, size
        picture = combined(aplanat_bpy, method=method, samples=256)
        sums.append(picture[..., :3].sum(axis=(0, 1)))
    # A lamp of 18 pixels that 256 samples move by fractions of a pixel.
    np.testing.assert_allclose(sums[0], sums[1], rtol=0.01)


def test_a_camera_scaled_to_nothing_is_refused_by_name(aplanat_bpy, build):
    build().camera.scale = (0.0, 0.0, 0.0)
    with pytest.raises((CameraError, RuntimeError), match="camera 'camera'.*scale of 0"):
        render(aplanat_bpy)


@pytest.mark.parametrize("shape", [(1, 64), (64, 1), (7, 256)])
def test_a_narrow_world_lights_every_direction_as_a_wide_one_of_the_same_colour(
    shape, aplanat_bpy, build
):
    pictures = []
    for height, width in (shape, (32, 64)):
        scene = build()
        _world(height, width)(aplanat_bpy, scene)
        image = scene.world.node_tree.nodes["Environment Texture"].image
        image.pixels.foreach_set(np.tile(np.float32((0.2, 0.4, 0.6, 1.0)), height * width))
        # Looked at from above: the surface faces straight up.
        card = next(x for x in scene.objects if x.name == "card")
        card.location, card.scale = (0.0, 0.0, -3.0), (9.0, 9.0, 9.0)
        card.rotation_euler.x = -np.pi / 2
        scene.camera.rotation_euler.x = 0.0
        pictures.append(combined(aplanat_bpy, samples=8))
    assert pictures[1][13, 24, 2] > 0.1
    # Half floats keep 11 bits.
    np.testing.assert_allclose(*pictures, rtol=3e-3, atol=1e-4)
