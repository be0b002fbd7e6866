"""A cube and a ball on a floor under one lamp."""

import math

import numpy as np


def shadow_scene(bpy, kind, pixels=64):
    """Return an empty file's scene with a cube, a ball just above it and a floor, all diffuse.

    Parameters
    ----------
    bpy : module
    kind : {'SUN', 'AREA', 'POINT', 'SPOT'}
        Of the lamp; large enough that its shadows are soft over many pixels.
    pixels : int

    Returns
    -------
    bpy.types.Scene
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = pixels
    scene.aplanat.use_shadows = True
    material = diffuse(bpy, 0.8)
    mesh = bpy.ops.mesh
    mesh.primitive_plane_add(size=20)
    bpy.context.object.data.materials.append(material)
    mesh.primitive_cube_add(size=1, location=(0, 0, 0.5), rotation=(0, 0, 0.4))
    bpy.context.object.data.materials.append(material)
    mesh.primitive_uv_sphere_add(radius=0.4, location=(1.2, -0.5, 0.8), segments=32, ring_count=16)
    bpy.context.object.data.materials.append(material)
    bpy.ops.object.shade_smooth()
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = (4, -5, 4)
    camera.rotation_euler = (math.radians(58), 0, math.radians(38))
    camera.data.lens = 60.0
    scene.camera = camera
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", kind))
    for thing in (camera, lamp):
        scene.collection.objects.link(thing)
    light = lamp.data
    if kind == "SUN":
        light.energy, light.angle = 3.0, 0.3
        lamp.rotation_euler = (-0.6, 0.5, 0)
    elif kind == "AREA":
        light.energy, light.size = 100.0, 1.5
        lamp.location, lamp.rotation_euler = (-2, -1, 3), (math.radians(20), math.radians(-35), 0)
    elif kind == "POINT":
        light.energy, light.shadow_soft_size = 150.0, 0.3
        lamp.location = (-1.5, -1, 2.5)
    else:
        light.energy, light.shadow_soft_size, light.spot_size = 300.0, 0.2, 1.2
        light.spot_blend = 0.5
        lamp.location, lamp.rotation_euler = (-1.5, -1, 3.5), (0.1, -0.4, 0)
    return scene


def diffuse(bpy, value):
    """Return a new material of one Diffuse BSDF."""
    material = bpy.data.materials.new("diffuse")
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (value, value, value, 1.0)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs["BSDF"], output.inputs["Surface"])
    return material


def see_through_card(bpy, opacity, location, size=1.0):
    """Add a horizontal card of which so much is opaque everywhere."""
    material = diffuse(bpy, 0.8)
    tree = material.node_tree
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    surface = output.inputs["Surface"].links[0].from_socket
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs["Fac"].default_value = opacity
    clear = tree.nodes.new("ShaderNodeBsdfTransparent")
    tree.links.new(clear.outputs["BSDF"], mix.inputs[1])
    tree.links.new(surface, mix.inputs[2])
    tree.links.new(mix.outputs["Shader"], output.inputs["Surface"])
    bpy.ops.mesh.primitive_plane_add(size=size, location=location)
    bpy.context.object.data.materials.append(material)
    return bpy.context.object


def sky_scene(bpy, kind, pixels=64):
    """Return a room without front, a cube and a ball in it, under a sky alone.

    Parameters
    ----------
    bpy : module
    kind : {'even', 'image'}
        A grey sky, or one that is bright on one side and has a small sun.
    pixels : int

    Returns
    -------
    bpy.types.Scene
    """
    scene = shadow_scene(bpy, "POINT", pixels)
    bpy.data.objects.remove(bpy.data.objects["lamp"])
    material = bpy.data.materials["diffuse"]
    for location, rotation in (
        ((-1.6, 0, 0), (0, math.pi / 2, 0)),
        ((0, 1.6, 0), (math.pi / 2, 0, 0)),
    ):
        bpy.ops.mesh.primitive_plane_add(size=6, location=location, rotation=rotation)
        bpy.context.object.data.materials.append(material)
    bpy.ops.mesh.primitive_plane_add(size=1.5, location=(-0.9, 0.9, 1.4))
    bpy.context.object.data.materials.append(material)
    scene.world = bpy.data.worlds.new("world")
    tree = scene.world.node_tree
    background = next(n for n in tree.nodes if n.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.7, 0.8, 0.9, 1.0)
    if kind == "image":
        height, width = 32, 64
        pixels = np.full((height, width, 4), (0.3, 0.35, 0.5, 1.0), np.float32)
        pixels[: height // 2, :, :3] = 0.1
        pixels[24:26, 40:42, :3] = (60.0, 50.0, 40.0)
        image = bpy.data.images.new("sky", width, height, float_buffer=True)
        image.pixels.foreach_set(pixels.ravel())
        image.update()
        image.pack()
        node = tree.nodes.new("ShaderNodeTexEnvironment")
        node.image = image
        tree.links.new(node.outputs["Color"], background.inputs["Color"])
    return scene
