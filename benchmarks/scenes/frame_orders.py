"""The frames of one animated scene, rendered in any order: what each pass of each frame hashes to.

As a program it is a process of its own: `python frame_orders.py SCENE.blend --frames 3,2,1` prints
one JSON object, frame to hash. Where the environment sets APLANAT_CACHE, nothing is known from
before but what lies there.
"""

import argparse
import hashlib
import json
import math
import sys
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
SIZE = (96, 54)
# Far above the number from which collapses are kept on disk.
_SPHERE = (256, 128)


def build(bpy, lens=""):
    """Make the current file an animation of all that a process keeps something of.

    A sphere that shape keys deform, one that is subdivided and waved, a still one, a textured board
    with colours, moving copies, lamps that make discs, and a camera that pulls focus.

    Parameters
    ----------
    bpy : module
    lens : str
        Id of a real lens; empty for a thin one.

    Returns
    -------
    bpy.types.Scene
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 24
    render = scene.render
    render.engine = "APLANAT"
    render.resolution_x, render.resolution_y = SIZE
    render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    _settings(scene)
    _lamps(bpy, scene)
    for name, place, modify in (
        ("shaped", (-1.6, 7.0, 0.3), _shape_keys),
        ("waved", (1.6, 8.0, 0.3), _waved_and_smoothed),
        ("still", (0.0, 9.0, 1.2), None),
    ):
        bpy.ops.mesh.primitive_uv_sphere_add(
            segments=_SPHERE[0] // (8 if modify is _waved_and_smoothed else 1),
            ring_count=_SPHERE[1] // (8 if modify is _waved_and_smoothed else 1),
            location=place,
        )
        thing = bpy.context.object
        thing.name = name
        thing.data.shade_smooth()
        thing.data.materials.append(_painted(bpy, name, thing.data))
        if modify:
            modify(thing)
        thing.keyframe_insert("location", frame=1)
        thing.location.x += 0.5
        thing.keyframe_insert("location", frame=24)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.rotation_euler.x = math.radians(90)
    data = camera.data
    data.lens = 35.0
    data.dof.use_dof, data.dof.aperture_fstop = True, 0.25
    data.aplanat.lens = lens
    if lens:
        data.aplanat.bokeh.vignetting = "LENS"
    # A real lens opens less far.
    for frame, distance in ((1, 0.5), (24, 0.7)) if lens else ((1, 3.0), (24, 4.5)):
        data.dof.focus_distance = distance
        data.dof.keyframe_insert("focus_distance", frame=frame)
    return scene


def _settings(scene):
    settings = scene.aplanat
    settings.method, settings.use_target_error = "ADAPTIVE", False
    settings.render_samples, settings.subsamples = 6, 2
    settings.use_levels, settings.level_bias = True, -1.0
    # Of the tests' machine.
    settings.least_triangles = 64
    layer = scene.view_layers[0]
    layer.use_pass_z = layer.use_pass_vector = layer.use_pass_cryptomatte_object = True
    layer.use_pass_normal = True


def _lamps(bpy, scene):
    material = bpy.data.materials.new("lamp")
    tree = material.node_tree
    tree.nodes.clear()
    glow = tree.nodes.new("ShaderNodeEmission")
    glow.inputs["Strength"].default_value = 40.0
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(glow.outputs[0], output.inputs["Surface"])
    for i in range(5):
        bpy.ops.mesh.primitive_ico_sphere_add(
            subdivisions=2, radius=0.05, location=(1.4 * (i - 2), 5.0 + 0.5 * i, -1.3)
        )
        bpy.context.object.data.materials.append(material)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.rotation_euler = (0.6, 0.3, 0.0)
    scene.collection.objects.link(sun)


def _painted(bpy, name, mesh):
    """Return a lit surface of an image, with a glow of vertex colours."""
    size = 32
    image = bpy.data.images.new(name, size, size)
    image.pixels = [
        value
        for y in range(size)
        for x in range(size)
        for value in ((x // 4 + y // 4) % 2, x / size, y / size, 1.0)
    ]
    image.pack()
    colors = mesh.color_attributes.new("paint", "FLOAT_COLOR", "POINT")
    number = np.arange(len(mesh.vertices))
    waves = 0.5 + 0.5 * np.stack([np.sin(0.1 * number), np.cos(0.07 * number)])
    paint = np.stack([waves[0], np.full(len(number), 0.7), waves[1], np.ones(len(number))], axis=1)
    colors.data.foreach_set("color", np.float32(paint).ravel())
    material = bpy.data.materials.new(name)
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    glow = tree.nodes.new("ShaderNodeEmission")
    both = tree.nodes.new("ShaderNodeMixShader")
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    color = tree.nodes.new("ShaderNodeVertexColor")
    color.layer_name = "paint"
    tree.links.new(texture.outputs["Color"], diffuse.inputs["Color"])
    tree.links.new(color.outputs["Color"], glow.inputs["Color"])
    tree.links.new(diffuse.outputs[0], both.inputs[1])
    tree.links.new(glow.outputs[0], both.inputs[2])
    tree.links.new(both.outputs[0], output.inputs["Surface"])
    return material


def _shape_keys(thing):
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name="long")
    points = np.empty(3 * len(key.data), np.float32)
    key.data.foreach_get("co", points)
    points = points.reshape(-1, 3)
    points[:, 2] *= 1.6
    points[:, 0] += 0.3 * np.sin(3.0 * points[:, 2])
    key.data.foreach_set("co", points.ravel())
    for frame, value in ((1, 0.1), (24, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)


def _waved_and_smoothed(thing):
    wave = thing.modifiers.new("wave", "WAVE")
    wave.height, wave.width, wave.time_offset = 0.3, 1.0, -20.0
    smooth = thing.modifiers.new("smooth", "SUBSURF")
    smooth.levels = smooth.render_levels = 2


def render(bpy, frames, persistent=False):
    """Render frames of the open file, in the given order.

    Parameters
    ----------
    bpy : module
    frames : iterable of int
    persistent : bool
        Blender's Persistent Data.

    Returns
    -------
    hashes : dict of int to str
        By frame, of all passes of all view layers.
    work : dict of str to int
        Levels of detail that were simplified and that came by known collapses.
    """
    from addon.engine.shared_resources import listen

    scene = bpy.context.scene
    scene.render.use_persistent_data = persistent
    hashes, work = {}, {"decimations": 0, "replays": 0}
    for frame in frames:
        scene.frame_set(frame)
        with listen(keep_pictures=True) as heard:
            bpy.ops.render.render()
        if heard.error:
            raise heard.error
        digest = hashlib.sha256()
        for layer in heard.layers:
            for name, picture in layer.passes.items():
                digest.update(f"{layer.layer} {name} {picture.pixels.shape}".encode())
                digest.update(picture.pixels.tobytes())
        hashes[frame] = digest.hexdigest()
        for name in work:
            work[name] += getattr(heard.statistics, name)
    return hashes, work


def main():
    """Render what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("blend")
    parser.add_argument("--frames", required=True, help="numbers, parted by commas, in that order")
    parser.add_argument("--persistent", action="store_true")
    parser.add_argument("--repository", default=str(REPOSITORY))
    arguments = parser.parse_args()
    sys.path.insert(0, arguments.repository)
    import bpy

    import addon

    addon.register()
    bpy.ops.wm.open_mainfile(filepath=arguments.blend)
    frames = [int(number) for number in arguments.frames.split(",")]
    hashes, work = render(bpy, frames, arguments.persistent)
    print(json.dumps({"hashes": hashes, "work": work}))


if __name__ == "__main__":
    main()
