"""A small scene with everything that the passes tell, and reading the passes of a render."""

import math
import tempfile
from pathlib import Path

import numpy as np

from benchmarks.scenes.materials import emission


def _mesh_object(bpy, scene, name, make, material, smooth=False):
    import bmesh

    mesh = bpy.data.meshes.new(name)
    shape = bmesh.new()
    make(bmesh.ops, shape)
    for face in shape.faces:
        face.smooth = smooth
    shape.to_mesh(mesh)
    shape.free()
    mesh.materials.append(material)
    thing = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(thing)
    return thing


def build_scene(scene, f_stop=0.15):
    """Fill an empty scene: a tilted cube, a smooth ball behind it, a cone in front, out of focus.

    Returns
    -------
    dict of str to bpy.types.Object
        ``Cube``, ``Ball``, ``Near``, ``Camera``.
    """
    import bpy

    cube = _mesh_object(
        bpy,
        scene,
        "Cube",
        lambda ops, m: ops.create_cube(m, size=1.2),
        emission(bpy, "red", (1.0, 0.1, 0.05)),
    )
    cube.location = (-0.9, 0.0, 0.2)
    cube.rotation_euler = (0.3, 0.2, 0.6)
    ball = _mesh_object(
        bpy,
        scene,
        "Ball",
        lambda ops, m: ops.create_uvsphere(m, u_segments=32, v_segments=16, radius=0.7),
        emission(bpy, "green", (0.1, 0.8, 0.2)),
        smooth=True,
    )
    ball.location = (0.9, 1.5, 0.1)
    # Mirrored and squeezed: normals must survive both.
    ball.scale = (-1.0, 0.7, 1.1)
    near = _mesh_object(
        bpy,
        scene,
        "Near",
        lambda ops, m: ops.create_cone(m, segments=12, radius1=0.25, radius2=0.0, depth=0.6),
        emission(bpy, "blue", (0.1, 0.2, 1.0)),
    )
    near.location = (0.35, -2.2, -0.1)
    data = bpy.data.cameras.new("Camera")
    camera = bpy.data.objects.new("Camera", data)
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.location = (0.2, -5.0, 0.6)
    camera.rotation_euler = (math.radians(85.0), 0.05, 0.03)
    data.dof.use_dof = True
    data.dof.focus_distance = 5.0
    data.dof.aperture_fstop = f_stop
    return {"Cube": cube, "Ball": ball, "Near": near, "Camera": camera}


def use_passes(layer, *names):
    """Switch on Blender's passes, such as ``"z"`` or ``"cryptomatte_object"``."""
    for name in names:
        setattr(layer, f"use_pass_{name}", True)


def write_passes(scene, path):
    """Render a scene with its engine to a multilayer EXR."""
    import bpy

    scene.render.filepath = str(path)
    scene.render.use_file_extension = False
    settings = scene.render.image_settings
    settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    bpy.ops.render.render(write_still=True, scene=scene.name)


def read_passes(path):
    """Read a multilayer EXR that Blender wrote.

    Returns
    -------
    passes : dict of str to ndarray of shape (height, width, channels)
        By ``"Layer.Pass"``, top row first.
    header : dict of str to object
        Of all parts together.
    """
    import OpenEXR

    passes, header = {}, {}
    with OpenEXR.File(str(path), separate_channels=True) as file:
        for part in file.parts:
            header = dict(part.header) | header
            channels = {}
            for name, channel in part.channels.items():
                owner, letter = name.rsplit(".", 1)
                pixels = np.array(channel.pixels, np.float32)
                channels.setdefault(owner, {})[letter.upper()] = pixels
            for owner, values in channels.items():
                order = "RGBA" if "R" in values else "XYZW"
                letters = sorted(values, key=order.find)
                passes[owner] = np.stack([values[letter] for letter in letters], axis=-1)
    return passes, header


def render_passes(scene):
    """Render a scene with its engine and return what `read_passes` reads."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "passes.exr"
        write_passes(scene, path)
        return read_passes(path)


def render_passes_cycles(scene, samples):
    """The same with Cycles: one-pixel box filter, nothing denoised."""
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    cycles.max_bounces = 0
    cycles.transparent_max_bounces = 8
    return render_passes(scene)


def render_passes_aplanat(scene, samples):
    """The same with Aplanat."""
    scene.render.engine = "APLANAT"
    scene.aplanat.method = "REFERENCE"
    scene.aplanat.render_samples = samples
    scene.aplanat.pixel_filter = "BOX"
    scene.render.filter_size = 1.0
    return render_passes(scene)


def away_from_edges(identifiers, radius=1):
    """Return the pixels whose whole neighbourhood shows the same thing.

    Parameters
    ----------
    identifiers : ndarray of shape (height, width)
    radius : int

    Returns
    -------
    ndarray of shape (height, width)
        bool.
    """
    same = np.ones(identifiers.shape, bool)
    padded = np.pad(identifiers, radius, mode="edge")
    height, width = identifiers.shape
    for dy in range(2 * radius + 1):
        for dx in range(2 * radius + 1):
            same &= padded[dy : dy + height, dx : dx + width] == identifiers
    return same
