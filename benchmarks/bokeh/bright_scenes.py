"""Seven bright scenes: wide surfaces brighter than white, and glints that sampling cannot draw.

Each looks along y at something near in focus, with all else blurred by discs of some pixels.
Radiances are those of a picture exposed for its subject: sunlit ground, snow and white walls lie
above 1.
"""

import math

import bpy
import numpy as np

from addon.cli.render.scene_setup import use_engine

_FOCUS, _F_STOP = 3.0, 0.2
# Where the camera stands above the ground, m.
_EYE = 1.5


def daylight_ground():
    """Make ground of facets in the sun, and stones on it."""
    scene = _scene(sky=0.4)
    _sun(scene, 7.0, 0.7)
    soil = _material("soil", color=(0.62, 0.5, 0.36))
    _heights(scene, "ground", soil, 60.0, 120, 0.12, seed=1)
    rng = np.random.default_rng(1)
    stone = _material("stone", color=(0.7, 0.68, 0.62))
    for _ in range(24):
        x, y = rng.uniform(-4.0, 4.0), rng.uniform(2.0, 18.0)
        _ball(scene, stone, (x, y, 0.1), rng.uniform(0.1, 0.4), 1)
    return scene


def snow():
    """Make snow in the sun with dark trunks."""
    scene = _scene(sky=0.9)
    _sun(scene, 6.0, 0.5)
    _heights(scene, "snow", _material("snow", color=(0.92, 0.93, 0.95)), 80.0, 60, 0.3, seed=2)
    bark = _material("bark", color=(0.05, 0.04, 0.03))
    rng = np.random.default_rng(2)
    for number in range(14):
        y = 3.0 if number == 0 else rng.uniform(5.0, 30.0)
        x = -0.6 if number == 0 else rng.uniform(-0.5, 0.5) * y
        _box(scene, bark, (x, y, 2.0), (0.12, 0.12, 2.5))
    return scene


def white_cyc():
    """Make a white wall that runs into the floor, in the sun, with dark balls before it."""
    scene = _scene(sky=0.6)
    _sun(scene, 5.0, 0.5)
    white = _material("white", color=(0.95, 0.95, 0.95))
    turns = np.linspace(0.0, 0.5 * math.pi, 12)
    bend = [(12.0 + 4.0 * math.sin(t), 4.0 - 4.0 * math.cos(t)) for t in turns]
    profile = [(-4.0, 0.0), *bend, (16.0, 14.0)]
    vertices = [(x, y, z) for y, z in profile for x in (-14.0, 14.0)]
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(profile) - 1)]
    _mesh(scene, "cyc", white, vertices, faces)
    dark = _material("dark", color=(0.06, 0.06, 0.08), roughness=0.4)
    for x, y, radius in ((0.0, 3.0, 0.4), (-1.2, 5.0, 0.6), (1.6, 8.0, 0.9)):
        _ball(scene, dark, (x, y, radius), radius, 3)
    return scene


def bright_window():
    """Make a dark room with an overexposed window of eight panes."""
    scene = _scene(sky=0.05)
    wall = _material("wall", color=(0.4, 0.36, 0.3))
    _box(scene, wall, (0.0, 12.2, 2.0), (8.0, 0.1, 6.0))
    _box(scene, wall, (0.0, 6.0, -0.1), (8.0, 8.0, 0.1))
    pane = _glow("pane", (9.0, 9.5, 10.0))
    for column in range(4):
        for row in range(2):
            _box(scene, pane, (1.1 * column - 1.6, 12.0, 1.2 + 1.5 * row), (0.5, 0.02, 0.68))
    _ball(scene, _material("vase", color=(0.3, 0.1, 0.08)), (0.5, 3.0, 1.1), 0.4, 3)
    return scene


def sequins():
    """Make a cloth of tilted mirrors in the sun."""
    scene = _scene(sky=0.35)
    _sun(scene, 6.0, 0.8)
    rng = np.random.default_rng(5)
    count, angles = 1500, np.arange(6) * math.pi / 3.0
    places = np.stack(
        [rng.uniform(-5.0, 5.0, count), np.full(count, 9.5), rng.uniform(-1.5, 4.5, count)], -1
    )
    tilts = rng.normal(0.0, 0.25, (count, 2))
    rim = 0.06 * np.stack([np.cos(angles), 0.0 * angles, np.sin(angles)], -1)
    vertices = places[:, None] + rim
    vertices[..., 1] += (rim[:, [0, 2]] @ tilts.T).T
    faces = np.arange(count * 6).reshape(count, 6).tolist()
    metal = _material("sequin", color=(0.9, 0.6, 0.3), roughness=0.2, metallic=1.0)
    _mesh(scene, "sequins", metal, vertices.reshape(-1, 3), faces)
    _box(scene, _material("cloth", color=(0.15, 0.02, 0.05)), (0.0, 10.0, 1.5), (8.0, 0.1, 6.0))
    _ball(scene, _material("head", color=(0.5, 0.35, 0.28)), (0.3, 3.0, 1.4), 0.35, 3)
    return scene


def water_glitter():
    """Make waves before a low sun."""
    scene = _scene(sky=0.5)
    _sun(scene, 4.0, -1.2)
    water = _material("water", color=(0.02, 0.06, 0.08), roughness=0.12)
    _heights(scene, "water", water, 60.0, 220, 0.1, seed=6, smooth=True)
    _box(scene, _material("post", color=(0.2, 0.12, 0.06)), (0.4, 3.0, 0.5), (0.08, 0.08, 1.2))
    return scene


def sunlit_street():
    """Make a street in the sun: white houses, windows, cars of metal."""
    scene = _scene(sky=0.6)
    _sun(scene, 6.0, 0.9)
    road = _material("road", color=(0.3, 0.3, 0.32))
    _box(scene, road, (0.0, 20.0, -0.1), (20.0, 30.0, 0.1))
    glass = _material("glass", color=(0.05, 0.07, 0.1), roughness=0.1)
    rng = np.random.default_rng(7)
    for number in range(10):
        side, y = (-1.0, 1.0)[number % 2], 6.0 + 5.0 * (number // 2)
        paint = _material("house", color=tuple(rng.uniform(0.5, 0.95, 3)))
        _box(scene, paint, (4.5 * side, y, 2.0), (1.5, 2.3, rng.uniform(2.0, 4.0)))
        for window in range(4):
            place = (2.98 * side, y - 1.5 + window, 1.5 + 1.2 * (window % 2))
            _box(scene, glass, place, (0.03, 0.3, 0.45))
    for number in range(8):
        paint = _material(
            "car", color=tuple(rng.uniform(0.1, 0.9, 3)), roughness=0.15, metallic=1.0
        )
        place = ((-1.8, 1.8)[number % 2], 3.0 + 2.6 * number, 0.5)
        _ball(scene, paint, place, 0.5, 3)
    return scene


SCENES = {
    build.__name__.replace("_", "-"): build
    for build in (
        daylight_ground,
        snow,
        white_cyc,
        bright_window,
        sequins,
        water_glitter,
        sunlit_street,
    )
}


def _scene(sky):
    """Return an empty scene with a camera that looks along y, under an even sky."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    use_engine(scene)
    world = bpy.data.worlds.new("sky")
    background = next(n for n in world.node_tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.8 * sky, 0.9 * sky, sky, 1.0)
    scene.world = world
    data = bpy.data.cameras.new("camera")
    data.lens, data.clip_start = 50.0, 0.1
    data.dof.use_dof, data.dof.focus_distance = True, _FOCUS
    data.dof.aperture_fstop = _F_STOP
    camera = bpy.data.objects.new("camera", data)
    camera.location, camera.rotation_euler = (0.0, 0.0, _EYE), (0.5 * math.pi, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_percentage = 100
    return scene


def _sun(scene, strength, tilt):
    """Add a sun; a negative `tilt` puts it before the camera, a positive one behind."""
    light = bpy.data.lights.new("sun", "SUN")
    light.energy, light.angle = strength, 0.009
    item = bpy.data.objects.new("sun", light)
    item.rotation_euler = (tilt, 0.0, 0.4)
    scene.collection.objects.link(item)


def _material(name, color, roughness=0.9, metallic=0.0):
    material = bpy.data.materials.new(name)
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Metallic"].default_value = metallic
    return material


def _glow(name, color):
    material = _material(name, (0.0, 0.0, 0.0))
    shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
    strength = max(color)
    shader.inputs["Emission Color"].default_value = (*(c / strength for c in color), 1.0)
    shader.inputs["Emission Strength"].default_value = strength
    return material


def _mesh(scene, name, material, vertices, faces, smooth=False):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(map(float, v)) for v in vertices], [], faces)
    mesh.materials.append(material)
    mesh.polygons.foreach_set("use_smooth", np.full(len(mesh.polygons), smooth))
    scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def _heights(scene, name, material, side, cells, height, seed, smooth=False):
    """Add ground of random heights, `side` m wide from just before the camera on."""
    rng = np.random.default_rng(seed)
    row = np.linspace(-0.5 * side, 0.5 * side, cells + 1)
    x, y = np.meshgrid(row, row + 0.5 * side - 2.0)
    z = rng.uniform(-height, height, x.shape)
    vertices = np.stack([x, y, z], -1).reshape(-1, 3)
    at = np.arange(cells * (cells + 1)).reshape(cells, cells + 1)[:, :-1].ravel()
    faces = np.stack([at, at + 1, at + cells + 2, at + cells + 1], -1).tolist()
    _mesh(scene, name, material, vertices, faces, smooth)


def _box(scene, material, middle, half):
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    _mesh(scene, "box", material, np.array(middle) + signs * np.array(half), faces)


def _ball(scene, material, middle, radius, subdivisions):
    import bmesh

    mesh = bpy.data.meshes.new("ball")
    made = bmesh.new()
    bmesh.ops.create_icosphere(made, subdivisions=subdivisions, radius=radius)
    made.to_mesh(mesh)
    made.free()
    mesh.materials.append(material)
    mesh.polygons.foreach_set("use_smooth", np.full(len(mesh.polygons), subdivisions > 2))
    item = bpy.data.objects.new("ball", mesh)
    item.location = middle
    scene.collection.objects.link(item)
