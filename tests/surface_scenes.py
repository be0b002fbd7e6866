"""A card that fills the picture, seen square on, for comparing surfaces pixel by pixel; spheres."""

import math

import numpy as np

from tests.pictures import render_aplanat, render_cycles

# One sample of ours lies in the pixel's middle; Cycles' lie within this width around it, in pixels.
TINY_FILTER = 0.01


def card_scene(bpy, pixels=48, uv=((0.0, 0.0), (1.0, 1.0))):
    """An empty scene, a parallel camera and a card of 2 x 2 m whose UVs run between two corners."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = pixels
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 2.0
    camera.location = (0.0, 0.0, 3.0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    mesh = bpy.data.meshes.new("card")
    mesh.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)])
    add_uv(mesh, "UVMap", uv)
    card = bpy.data.objects.new("card", mesh)
    scene.collection.objects.link(card)
    material = bpy.data.materials.new("card")
    mesh.materials.append(material)
    material.node_tree.nodes.clear()
    return scene, card, Tree(material.node_tree)


def add_uv(mesh, name, uv):
    """Add a UV map that runs over the card between two corners."""
    (u0, v0), (u1, v1) = uv
    layer = mesh.uv_layers.new(name=name)
    layer.uv.foreach_set("vector", np.array([u0, v0, u1, v0, u1, v1, u0, v1], np.float32))


class Tree:
    """Builds a node tree."""

    def __init__(self, tree, output="ShaderNodeOutputMaterial"):
        self.tree = tree
        self.output = tree.nodes.new(output)

    def node(self, kind, inputs=(), **settings):
        """Add a node; an input is a value, or a socket to link."""
        node = self.tree.nodes.new(f"ShaderNode{kind}")
        for name, value in settings.items():
            setattr(node, name, value)
        for name, value in dict(inputs).items():
            socket = next(s for s in node.inputs if name in {s.identifier, s.name})
            if hasattr(value, "is_output"):
                self.tree.links.new(value, socket)
            elif isinstance(value, tuple) and socket.type == "RGBA":
                socket.default_value = (*value, 1.0)[:4]
            else:
                socket.default_value = value
        return node

    def surface(self, socket):
        """Make a socket the surface."""
        self.tree.links.new(socket, self.output.inputs["Surface"])

    def emission(self, color=(1.0, 1.0, 1.0), strength=1.0):
        """Make an Emission the surface and return it."""
        node = self.node("Emission", {"Color": color, "Strength": strength})
        self.surface(node.outputs[0])
        return node


def image(bpy, name, pixels, is_float=False, color_space=None, alpha_mode="STRAIGHT"):
    """Make an image from an array of shape (height, width, 4), bottom row first."""
    height, width = pixels.shape[:2]
    made = bpy.data.images.new(name, width, height, alpha=True, float_buffer=is_float)
    if color_space is not None:
        made.colorspace_settings.name = color_space
    made.alpha_mode = alpha_mode
    made.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).reshape(-1))
    made.update()
    made.pack()
    return made


def random_pixels(seed, height=5, width=6, alpha=False):
    """Return random pixels; opaque unless asked for alpha."""
    pixels = np.random.default_rng(seed).random((height, width, 4)).astype(np.float32)
    if not alpha:
        pixels[..., 3] = 1.0
    return pixels


def both(scene, cycles_samples=16, bounces=0):
    """Render the middles of the pixels with Aplanat and Cycles."""
    ours = render_aplanat(scene, 1)
    cycles = render_cycles(scene, cycles_samples, "BLACKMAN_HARRIS", TINY_FILTER, bounces=bounces)
    return ours, cycles


def sphere_scene(bpy, shaders, pixels=48):
    """Smooth spheres in a row along x, one a shader (node, inputs), seen along +y.

    They light and mirror nothing of each other.
    """
    bpy.ops.wm.read_factory_settings(use_empty=True)
    shaders = list(shaders)
    count = max(len(shaders), 1)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = count * pixels, pixels
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = (0.0, -12.0, 0.0)
    camera.rotation_euler = (math.pi / 2, 0.0, 0.0)
    camera.data.sensor_fit = "HORIZONTAL"
    camera.data.lens = 36.0 * 12.0 / (2.2 * count)
    scene.collection.objects.link(camera)
    scene.camera = camera
    for i, (kind, inputs) in enumerate(shaders):
        mesh = bpy.data.meshes.new(kind)
        bmesh_sphere(mesh)
        mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
        material = bpy.data.materials.new(kind)
        material.node_tree.nodes.clear()
        tree = Tree(material.node_tree)
        tree.surface(tree.node(kind, inputs).outputs[0])
        mesh.materials.append(material)
        ball = bpy.data.objects.new(kind, mesh)
        ball.location.x = 2.2 * (i - (count - 1) / 2)
        ball.visible_diffuse = ball.visible_glossy = False
        scene.collection.objects.link(ball)
    return scene


def bmesh_sphere(mesh):
    """Fill a mesh with a fine sphere of radius 1."""
    import bmesh

    form = bmesh.new()
    bmesh.ops.create_uvsphere(form, u_segments=96, v_segments=48, radius=1.0)
    form.to_mesh(mesh)
    form.free()


def add_light(bpy, kind, place, **settings):
    """Add a light without shadow that shines at the origin."""
    from mathutils import Vector

    light = bpy.data.lights.new(kind, kind)
    light.use_shadow = False
    for name, value in settings.items():
        setattr(light, name, value)
    obj = bpy.data.objects.new(kind, light)
    obj.location = place
    obj.rotation_euler = (-Vector(place)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(obj)
    return obj


def world_image(bpy, path, rotation=0.0):
    """Surround the scene with an image turned about z, or with white where there is no path."""
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.node_tree.nodes.clear()
    tree = Tree(world.node_tree, "ShaderNodeOutputWorld")
    color = (1.0, 1.0, 1.0)
    if path is not None:
        place = tree.node("TexCoord").outputs["Generated"]
        mapping = tree.node("Mapping", {"Vector": place, "Rotation": (0.0, 0.0, rotation)})
        made = bpy.data.images.load(str(path))
        color = tree.node("TexEnvironment", {"Vector": mapping.outputs[0]}, image=made).outputs[0]
    tree.surface(tree.node("Background", {"Color": color}).outputs[0])
    return world
