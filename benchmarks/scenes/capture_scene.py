"""A small scene without noise for captures: a slope, and planes that stand on it."""

import math

from .materials import emission

SIZE = (64, 36)


def glowing(bpy, name, color, textured=False):
    """Return a material that is seen as it is, so that few samples are enough."""
    material = emission(bpy, name, color)
    tree = material.node_tree
    if textured:
        places = tree.nodes.new("ShaderNodeTexCoord")
        glow = next(node for node in tree.nodes if node.type == "EMISSION")
        tree.links.new(places.outputs["Generated"], glow.inputs["Color"])
    return material


def add_plane(bpy, name, place, size, tilt=0.0, color=(0.8, 0.4, 0.2), textured=False):
    """Add a glowing square plane and return its object."""
    bpy.ops.mesh.primitive_plane_add(size=size, location=place, rotation=(tilt, 0.0, 0.0))
    bpy.context.object.name = name
    bpy.context.object.data.materials.append(glowing(bpy, name, color, textured))
    return bpy.context.object


def build(bpy, blocks=True):
    """Make the current file a slope from 3 to about 20 m, with planes that stand on it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    render = scene.render
    render.resolution_x, render.resolution_y = SIZE
    render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.data.dof.use_dof = True
    camera.data.dof.focus_distance = 6.0
    scene.world = bpy.data.worlds.new("World")
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.2, 0.6, 1.0)
    add_plane(bpy, "Slope", (0.0, 0.0, -11.0), 40.0, math.radians(-70.0), textured=True)
    if blocks:
        add_plane(bpy, "Near", (-0.6, 0.0, -4.0), 0.8, color=(0.9, 0.1, 0.1))
        add_plane(bpy, "Middle", (0.6, 0.0, -7.0), 1.5, color=(0.1, 0.9, 0.1))
    render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.samples, cycles.use_adaptive_sampling, cycles.use_denoising = 4, False, False
    return scene
