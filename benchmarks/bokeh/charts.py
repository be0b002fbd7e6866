"""Scenes built for `aplanat bench --bokeh`: many highlights, and a half-hidden one."""

import math

import bpy
import numpy as np

from addon.cli.render.scene_setup import use_engine

from ..scenes.materials import emission

# Of the chart of many highlights: between so many metres, focus, and behind bars at a third of it.
_NEAR, _FAR, FOCUS = 8.0, 16.0, 4.0
_BARS = 8
# Of the half-hidden highlight: its depth, and that of what hides half of it.
LAMP_DEPTH, EDGE_DEPTH = 8.0, 4.0


def many_highlights(resolution, number):
    """Make a scene with small bright squares behind vertical bars.

    Parameters
    ----------
    resolution : tuple of 2 int
    number : int
        Of the squares; a pixel and a half a side.

    Returns
    -------
    bpy.types.Scene
    """
    scene, pixel = _scene(resolution, FOCUS, f_stop=0.15)
    rng = np.random.default_rng(6)
    depth = rng.uniform(_NEAR, _FAR, number)
    half = depth * pixel / 2.0 * np.array(resolution)[:, None]
    x, z = rng.uniform(-1.0, 1.0, (2, number)) * half
    side = 0.75 * pixel * depth
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    vertices = np.stack(
        [
            x[:, None] + side[:, None] * corners[:, 0],
            np.broadcast_to(depth[:, None], (number, 4)),
            z[:, None] + side[:, None] * corners[:, 1],
        ],
        axis=-1,
    )
    _mesh(scene, "lamps", vertices, (8.0, 6.8, 5.2))
    at = (np.arange(_BARS) + 0.5) / _BARS * 2.0 - 1.0
    width, tall = 0.25 / _BARS, resolution[1] / resolution[0]
    reach = FOCUS / 3.0 * pixel / 2.0 * resolution[0]
    bars = np.array([[(a + width * u, FOCUS / 3.0 / reach, 2 * tall * v) for u, v in corners]
                     for a in at]) * reach  # fmt: skip
    _mesh(scene, "bars", bars, (0.02, 0.03, 0.02))
    return scene


def half_hidden(resolution):
    """Make a scene with a lamp of which a nearer edge hides one half, through three blades.

    Parameters
    ----------
    resolution : tuple of 2 int

    Returns
    -------
    bpy.types.Scene
        Its camera's focus is to be set.
    """
    scene, pixel = _scene(resolution, LAMP_DEPTH, f_stop=0.05)
    scene.camera.data.dof.aperture_blades = 3
    scene.camera.data.dof.aperture_rotation = 0.3
    angles = 0.4 + np.arange(12) * 2.0 * np.pi / 12
    size = 2.0 * pixel * LAMP_DEPTH
    lamp = np.stack([size * np.cos(angles), 0 * angles + LAMP_DEPTH, size * np.sin(angles)], -1)
    _mesh(scene, "lamp", lamp[None], (60.0, 40.0, 20.0))
    wall = np.array([(-6.0, 12.0, -4.0), (6.0, 12.0, -4.0), (6.0, 12.0, 4.0), (-6.0, 12.0, 4.0)])
    _mesh(scene, "wall", wall[None], (0.05, 0.07, 0.1))
    # Leaning, so that no side of it is parallel to one of the iris.
    edge = np.array([(0.1, 1.0), (-0.1, -1.0), (-3.0, -1.0), (-3.0, 1.0)])
    edge = np.insert(edge, 1, EDGE_DEPTH, axis=1)
    _mesh(scene, "edge", edge[None], (0.1, 0.25, 0.08))
    return scene


def _scene(resolution, focus, f_stop):
    """Return an empty scene with a camera that looks along y, and a pixel's side at 1 m."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    use_engine(scene)
    data = bpy.data.cameras.new("camera")
    data.lens, data.sensor_width = 50.0, 36.0
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, focus, f_stop
    camera = bpy.data.objects.new("camera", data)
    camera.rotation_euler = (math.pi / 2.0, 0.0, 0.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    data.aplanat.bokeh.use = True
    render = scene.render
    render.resolution_x, render.resolution_y = resolution
    render.resolution_percentage = 100
    scene.aplanat.pixel_filter, render.filter_size = "BOX", 1.0
    bpy.context.view_layer.update()
    return scene, data.sensor_width / data.lens / resolution[0]


def _mesh(scene, name, polygons, color):
    """Add polygons, an array of shape (number, corners, 3), that shine in one colour."""
    number, corners = polygons.shape[:2]
    data = bpy.data.meshes.new(name)
    faces = np.arange(number * corners).reshape(number, corners)
    data.from_pydata(polygons.reshape(-1, 3).tolist(), [], faces.tolist())
    data.materials.append(emission(bpy, name, color))
    scene.collection.objects.link(bpy.data.objects.new(name, data))
