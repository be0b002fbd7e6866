"""Test charts for chromatic aberration, made in memory: points, a field of points, a wall, bars.

The camera stands at the origin and looks along -z; everything glows, nothing is lit.
"""

import bpy
import numpy as np

from addon.engine.render_engine import ENGINE_ID

from ..scenes.materials import emission

FOCUS = 4.0
# Of the field of points and the bars.
DISTANCE = 5.0


def points(resolution):
    """Return a scene of small squares on black, at many distances round the focus plane."""
    scene, camera = _scene(resolution)
    camera.data.dof.aperture_fstop = 0.7
    rng = np.random.default_rng(11)
    for row in range(4):
        for column in range(7):
            depth = float(1.0 / rng.uniform(1.0 / 18.0, 1.0 / 1.8))
            x = ((column + 0.5) / 7.0 - 0.5) * 0.62 + rng.uniform(-0.02, 0.02)
            y = ((row + 0.5) / 4.0 - 0.5) * 0.34 + rng.uniform(-0.02, 0.02)
            color = (1.0, 1.0, 1.0) if row % 2 else tuple(rng.uniform(0.3, 1.0, 3))
            # About 4 pixels wide wherever it is.
            half = 2.0 * depth * 0.72 / resolution[0]
            _quad((x * depth, y * depth, -depth), (half, half), color, 6.0)
    return scene


def field_of_points(resolution, shift=(0.0, 0.0)):
    """Return a scene of small squares on black in one plane, and their places, without defocus."""
    scene, camera = _scene(resolution)
    camera.data.dof.use_dof = False
    camera.data.shift_x, camera.data.shift_y = shift
    side = max(resolution)
    places = []
    for row in range(5):
        for column in range(7):
            x = ((column + 0.5) / 7.0 - 0.5) * 0.64 + 0.72 * shift[0]
            y = ((row + 0.5) / 5.0 - 0.5) * 0.34 + 0.72 * shift[1]
            place = np.array([x, y, -1.0]) * DISTANCE
            half = 2.5 * DISTANCE * 0.72 / side
            _quad(place, (half, half), (1.0, 1.0, 1.0), 1.0)
            places.append(place)
    return scene, np.array(places)


def wall(resolution):
    """Return a scene of nothing but an evenly bright, white wall out of focus."""
    scene, camera = _scene(resolution)
    camera.data.dof.aperture_fstop = 0.7
    _quad((0.0, 0.0, -9.0), (400.0, 400.0), (0.8, 0.8, 0.8), 1.0)
    return scene


def bars(resolution):
    """Return a scene of upright bars on black, whose fringes run along the picture's rows.

    Returns
    -------
    scene : bpy.types.Scene
    columns : list of (int, int)
        The part of the picture's middle row in which each one's fringe lies.
    """
    scene, camera = _scene(resolution)
    camera.data.dof.aperture_fstop = 2.8
    width = resolution[0]
    columns = []
    for x in (-0.29, -0.16, 0.16, 0.29):
        _quad(
            (x * DISTANCE, 0.0, -DISTANCE),
            (1.5 * DISTANCE * 0.72 / width, 0.1 * DISTANCE),
            (1.0, 1.0, 1.0),
            2.0,
        )
        middle = (x / 0.72 + 0.5) * width
        columns.append((int(middle - 0.085 * width), int(middle + 0.085 * width)))
    return scene, columns


def _scene(resolution):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = ENGINE_ID
    scene.render.resolution_x, scene.render.resolution_y = resolution
    scene.render.resolution_percentage = 100
    scene.render.filter_size = 1.0
    scene.aplanat.pixel_filter = "BOX"
    scene.view_settings.view_transform = "Standard"
    world = bpy.data.worlds.new("Black")
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    scene.world = world
    data = bpy.data.cameras.new("Camera")
    camera = bpy.data.objects.new("Camera", data)
    scene.collection.objects.link(camera)
    scene.camera = camera
    data.lens, data.sensor_width = 50.0, 36.0
    data.clip_start, data.clip_end = 0.1, 1000.0
    data.dof.use_dof = True
    data.dof.focus_distance = FOCUS
    return scene, camera


def _quad(center, half, color, strength):
    x, y = half
    mesh = bpy.data.meshes.new("Quad")
    mesh.from_pydata([(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(emission(bpy, "Glow", color, strength))
    quad = bpy.data.objects.new("Quad", mesh)
    quad.location = center
    bpy.context.scene.collection.objects.link(quad)
