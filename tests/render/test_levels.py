"""Levels of detail in pictures: toys with textures and vertex colours, against full detail.

The right picture is that of the same method, samples and raster without levels of detail.
"""

import math

import numpy as np
import pytest

from addon.engine.drawing import group_levels
from addon.engine.shared_resources import listen
from addon.levels import choosing
from tests.pictures import energy_ratio, save_side_by_side, srgb
from tests.surface_scenes import Tree

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

WIDTH, HEIGHT = 128, 72
SAMPLES = 96
FOCUS = 5.0


def toy(parts, seed):
    """A bumpy body with an arm: vertices, triangles, UVs of its corners."""
    u, v = np.meshgrid(np.linspace(0, 1, 2 * parts + 1), np.linspace(0, 1, parts + 1))
    angle, tilt = 2.0 * np.pi * u, np.pi * v
    p = np.stack(
        [np.sin(tilt) * np.cos(angle), np.sin(tilt) * np.sin(angle), np.cos(tilt)], axis=-1
    )
    rng = np.random.default_rng(seed)
    arm = rng.normal(size=3)
    arm /= np.linalg.norm(arm)
    size = 0.8 + 0.6 * np.exp(-25.0 * (1.0 - p @ arm))
    size += 0.015 * np.sin(40.0 * p[..., 0]) * np.sin(40.0 * p[..., 1])
    p = p * size[..., None]
    # One place at the meridian where the texture begins and ends, and at each pole.
    column = np.arange(2 * parts + 1) % (2 * parts)
    number = np.arange(parts + 1)[:, None] * (2 * parts) + column
    number[0], number[-1] = number[0, 0], number[-1, 0]
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    uv = np.stack([u, 1.0 - v], axis=-1)
    e, f, g, h = uv[:-1, :-1], uv[1:, :-1], uv[1:, 1:], uv[:-1, 1:]
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    corner = np.concatenate([np.stack([e, f, g], -2), np.stack([e, g, h], -2)]).reshape(-1, 3, 2)
    proper = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2])
    proper &= faces[:, 2] != faces[:, 0]
    faces, corner = faces[proper], corner[proper]
    used, index = np.unique(faces, return_inverse=True)
    return p[:, :-1].reshape(-1, 3)[used], index.reshape(-1, 3), corner


def chequered(bpy):
    image = bpy.data.images.new("chequered", 64, 64, alpha=False)
    y, x = np.mgrid[:64, :64]
    pixels = np.ones((64, 64, 4), np.float32)
    pixels[..., :3] = np.where(((x // 8 + y // 8) % 2)[..., None], (0.9, 0.8, 0.2), (0.1, 0.1, 0.5))
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    return image


def put(bpy, name, place, size, turn, look, image=None, seed=0, parts=36):
    positions, faces, uv = toy(parts, seed)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(positions, [], faces)
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", np.float32(uv).ravel())
    stripes = (np.sin(14.0 * positions[:, 2:]) > 0.0) * np.array([[0.9, 0.5, 0.1]])
    colors = np.ones((len(positions), 4), np.float32)
    colors[:, :3] = 0.03 + stripes
    colors[:, :3] += 3.0 * np.exp(-20.0 * (1.0 - positions @ (-0.4, -0.7, 0.6)))[:, None]
    mesh.color_attributes.new("Col", "FLOAT_COLOR", "POINT").data.foreach_set(
        "color", colors.ravel()
    )
    material = bpy.data.materials.new(name)
    material.node_tree.nodes.clear()
    tree = Tree(material.node_tree)
    if image is None:
        color = tree.node("VertexColor", layer_name="Col").outputs["Color"]
    else:
        color = tree.node("TexImage", image=image).outputs["Color"]
    if look == "flat":
        tree.emission(color)
    else:
        shader = tree.node("BsdfPrincipled")
        material.node_tree.links.new(color, shader.inputs["Base Color"])
        output = tree.node("OutputMaterial")
        material.node_tree.links.new(shader.outputs["BSDF"], output.inputs["Surface"])
    mesh.materials.append(material)
    made = bpy.data.objects.new(name, mesh)
    made.location, made.scale = place, (size, size, size)
    made.rotation_euler = (0.3, 0.0, turn)
    bpy.context.scene.collection.objects.link(made)


@pytest.fixture(params=["flat", "lit"])
def toys(request, empty_scene, aplanat_bpy):
    """Toys before and behind the focus, every other one with a texture."""
    bpy, look, scene = aplanat_bpy, request.param, empty_scene
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    world = bpy.data.worlds.new("grey")
    scene.world = world
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.22, 0.25, 1.0)
    if look == "lit":
        sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
        sun.data.energy, sun.rotation_euler = 2.5, (0.7, 0.2, 0.5)
        scene.collection.objects.link(sun)
    image = chequered(bpy)
    places = [(-0.5, 2.2, 0.1), (0.6, 2.5, -0.25), (0.0, 5.0, 0.4)]
    places += [(1.6 * k - 3.2, 11.0 + k, 1.2 * (k % 2) - 0.7) for k in range(5)]
    for k, place in enumerate(places):
        size = 0.07 * place[1] ** 1.1
        put(bpy, f"toy {k}", place, size, 1.3 * k, look, image if k % 2 else None, k)
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    camera.rotation_euler = (math.pi / 2, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, FOCUS, 0.15
    return scene


def render(scene, use_levels=True):
    import bpy

    scene.render.engine = "APLANAT"
    own = scene.aplanat
    own.method, own.use_target_error = "ADAPTIVE", False
    own.render_samples, own.subsamples = SAMPLES, 0
    own.pixel_filter, scene.render.filter_size = "BOX", 1.0
    own.use_levels = use_levels
    with listen(keep_pictures=True) as heard:
        bpy.ops.render.render(scene=scene.name)
    assert heard.error is None
    picture = heard.layers[0].passes["Combined"].pixels[::-1].copy()
    return picture, heard.statistics


def psnr(test, right):
    return -10.0 * math.log10(np.square(srgb(test[..., :3]) - srgb(right[..., :3])).mean())


def test_levels_as_chosen_leave_the_picture_as_it_is(toys, tmp_path):
    right, _ = render(toys, use_levels=False)
    picture, work = render(toys)
    save_side_by_side(tmp_path / "levels_full_difference.png", picture, right)
    # Otherwise nothing is compared.
    assert work.triangles_submitted < 0.7 * work.triangles_full_detail
    assert energy_ratio(picture, right) == pytest.approx(1.0, abs=0.003), tmp_path
    assert psnr(picture, right) >= 42.0, tmp_path


@pytest.mark.parametrize("level", [1, 2, 3])
def test_levels_that_are_forced_keep_the_light(toys, monkeypatch, tmp_path, level):
    # Highlights are found in full detail, and the choice that is forced here is what keeps meshes
    # fine whose samples would lose other light than the discs get.
    toys.camera.data.aplanat.bokeh.use = False
    right, _ = render(toys, use_levels=False)

    def forced(seen, _triangles, _plan, _bias=0.0):
        return np.full(len(seen.radius), float(level))

    for module in (choosing, group_levels):
        monkeypatch.setattr(module, "choose_levels", forced)
        monkeypatch.setattr(module, "allowed_levels", lambda chosen, _wanted: chosen)
    picture, work = render(toys)
    save_side_by_side(tmp_path / "forced_full_difference.png", picture, right)
    assert work.triangles_submitted < 1.3 * 0.5**level * work.triangles_full_detail
    for channel in range(3):
        one, other = picture[..., channel : channel + 1], right[..., channel : channel + 1]
        assert energy_ratio(one, other) == pytest.approx(1.0, abs=0.01), tmp_path


@pytest.mark.parametrize("toys", ["flat"], indirect=True)
def test_slopes_through_a_ramp_keep_the_light(toys, tmp_path):
    # The mean of what a ramp makes of the normals is not what it makes of their mean.
    import bpy

    for obj in [obj for obj in toys.objects if obj.type == "MESH"]:
        obj.data.materials.clear()
        material = bpy.data.materials.new("slope")
        obj.data.materials.append(material)
        material.node_tree.nodes.clear()
        tree = Tree(material.node_tree)
        normal = tree.node("NewGeometry").outputs["Normal"]
        across = tree.node("SeparateXYZ", {"Vector": normal}).outputs["Z"]
        ramp = tree.node("ValToRGB", {"Fac": across})
        ramp.color_ramp.elements[0].position = 0.45
        ramp.color_ramp.elements[1].position = 0.5
        tree.emission(ramp.outputs["Color"])
    toys.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    right, _ = render(toys, use_levels=False)
    picture, _ = render(toys)
    save_side_by_side(tmp_path / "slopes_full_difference.png", picture, right)
    assert energy_ratio(picture, right) == pytest.approx(1.0, abs=0.003), tmp_path
