"""What the scripts of the zoo are made of: functions that know nothing but bpy and numpy.

`script.script` copies those that a scene needs into its script, so none may use anything else of
the project. What they take are the parts of a recipe: plain dicts, lists, numbers and texts.
"""

import math

import bpy  # isort: skip - brings the two that follow
import bmesh
import mathutils
import numpy as np


def start(settings):
    """Empty Blender and return its scene with some settings."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    assign(scene, settings)
    return scene


def assign(owner, settings):
    """Set properties by their paths; an image is made, an object is looked up by its name."""
    for path, value in settings.items():
        *way, name = path.split(".")
        target = owner
        for step in way:
            target = getattr(target, step)
        if isinstance(value, dict) and "size" in value:
            value = make_image(value)
        elif isinstance(value, dict):
            value = getattr(bpy.data, value["of"]).get(value["name"])
        setattr(target, name, value)


def make_image(spec):
    """Make an image of random pixels, some of them as bright as asked for."""
    width, height = spec["size"]
    rng = np.random.default_rng(spec.get("seed", 0))
    image = bpy.data.images.new("image", width, height, alpha=True, float_buffer="float" in spec)
    if "space" in spec:
        image.colorspace_settings.name = spec["space"]
    pixels = rng.random((height, width, 4), np.float32)
    if "alpha" not in spec:
        pixels[..., 3] = 1.0
    pixels[rng.random((height, width)) < 0.05, :3] *= spec.get("bright", 1.0)
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def grow(tree, spec, group_input=None):
    """Make a node and all that feeds it; returns the output that the recipe names."""
    if "group_input" in spec:
        return group_input.outputs[0]
    node = tree.nodes.new(spec["node"])
    if "inner" in spec:
        node.node_tree = make_group(spec)
    assign(node, spec.get("set", {}))
    for place, color in spec.get("ramp", []):
        node.color_ramp.elements.new(place).color = color
    for identifier, value in spec.get("inputs", {}).items():
        socket = next((s for s in node.inputs if s.identifier == identifier), None)
        if socket is None:
            continue
        if isinstance(value, dict):
            tree.links.new(grow(tree, value, group_input), socket)
        else:
            socket.default_value = value
    return node.outputs[spec.get("output", 0)]


def make_group(spec):
    """Make a node group with one input, a colour, and one output."""
    tree = bpy.data.node_groups.new("group", "ShaderNodeTree")
    tree.interface.new_socket("In", in_out="INPUT", socket_type="NodeSocketColor")
    tree.interface.new_socket("Out", in_out="OUTPUT", socket_type=spec["socket"])
    entry, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(grow(tree, spec["inner"], entry), end.inputs[0])
    return tree


def fill_tree(tree, output_type, sockets):
    """Replace the nodes of a tree by those that feed an output node."""
    tree.nodes.clear()
    output = tree.nodes.new(output_type)
    for name, spec in sockets.items():
        tree.links.new(grow(tree, spec), output.inputs[name])


def make_material(name, spec):
    """Make a material."""
    material = bpy.data.materials.new(name)
    fill_tree(material.node_tree, "ShaderNodeOutputMaterial", spec.get("tree", {}))
    assign(material, spec.get("set", {}))


def make_world(scene, spec):
    """Give the scene a world."""
    scene.world = bpy.data.worlds.new("World")
    fill_tree(scene.world.node_tree, "ShaderNodeOutputWorld", spec.get("tree", {}))
    assign(scene.world, spec.get("set", {}))


def make_light(scene, number, spec):
    """Add a light."""
    light = bpy.data.lights.new(f"light {number}", spec["type"])
    assign(light, spec.get("set", {}))
    if "tree" in spec:
        fill_tree(light.node_tree, "ShaderNodeOutputLight", spec["tree"])
    obj = bpy.data.objects.new(light.name, light)
    assign(obj, spec.get("object", {}))
    scene.collection.objects.link(obj)


def make_camera(scene, spec):
    """Add the camera."""
    data = bpy.data.cameras.new("Camera")
    obj = bpy.data.objects.new("Camera", data)
    scene.collection.objects.link(obj)
    scene.camera = obj
    obj.rotation_euler = (math.pi / 2, 0.0, 0.0)
    assign(obj, spec.get("object", {}))
    assign(data, spec.get("set", {}))


def make_object(collection, number, spec):
    """Add an object of any kind."""
    name = f"{spec['kind'].lower()} {number}"
    maker = globals()[f"make_{spec['kind'].lower()}"]
    made = maker(name, spec)
    obj = made if isinstance(made, bpy.types.Object) else bpy.data.objects.new(name, made)
    for material in spec.get("materials", []):
        obj.data.materials.append(bpy.data.materials.get(material) if material else None)
    if "slots" in spec and obj.type == "MESH" and obj.data.polygons:
        slots = np.arange(len(obj.data.polygons), dtype=np.int32) % spec["slots"]
        obj.data.polygons.foreach_set("material_index", slots)
    for modifier in spec.get("modifiers", []):
        assign(obj.modifiers.new("modifier", modifier["type"]), modifier.get("set", {}))
    if "particles" in spec:
        add_particles(obj, spec["particles"], number)
    if "points" in spec:
        add_instances(obj, spec["points"])
    assign(obj, spec.get("set", {}))
    for frame, place in spec.get("keys", []):
        obj.location = place
        obj.keyframe_insert("location", frame=frame)
    collection.objects.link(obj)
    return obj


def make_mesh(name, spec):
    """Make a mesh: a shape, or loose corners."""
    mesh = bpy.data.meshes.new(name)
    shape, count = spec.get("shape", "cube"), spec.get("count", 3)
    if shape == "soup":
        corners = np.random.default_rng(count).normal(0.0, 0.5, (3 * count, 3))
        mesh.from_pydata(corners.tolist(), [], np.arange(3 * count).reshape(-1, 3).tolist())
    elif shape == "edges":
        mesh.from_pydata([(i, 0, i * i % 3) for i in range(count)], [(0, 1), (1, 2)], [])
    elif shape == "flat":
        # Faces without an area among one that has one.
        mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0.5, 0, 1), (2, 0, 0)], [], [(0, 1, 2), (0, 1, 3)])
    elif shape != "nothing":
        make_shape(mesh, shape, count)
    corners = len(mesh.loops)
    for layer in spec.get("uvs", []):
        uv = mesh.uv_layers.new(name=layer)
        values = np.random.default_rng(corners).random(2 * corners, np.float32)
        uv.uv.foreach_set("vector", values)
    for layer, kind, domain in spec.get("colors", []):
        colors = mesh.color_attributes.new(layer, kind, domain)
        values = np.random.default_rng(len(layer)).random(4 * len(colors.data), np.float32)
        colors.data.foreach_set("color", values)
    if "smooth" in spec:
        mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    return mesh


def make_shape(mesh, shape, count):
    """Make a mesh one of bmesh's primitives, with UVs."""
    made = bmesh.new()
    made.loops.layers.uv.new("UVMap")
    if shape == "grid":
        bmesh.ops.create_grid(made, x_segments=count, y_segments=count, size=0.5, calc_uvs=True)
        bmesh.ops.rotate(made, verts=made.verts, matrix=quarter_turn())
    elif shape == "sphere":
        bmesh.ops.create_uvsphere(
            made, u_segments=2 * count, v_segments=count, radius=0.5, calc_uvs=True
        )
    elif shape == "ico":
        bmesh.ops.create_icosphere(made, subdivisions=count, radius=0.5, calc_uvs=True)
    elif shape == "ngon":
        bmesh.ops.create_circle(made, cap_ends=True, segments=count, radius=0.5, calc_uvs=True)
        bmesh.ops.rotate(made, verts=made.verts, matrix=quarter_turn())
    elif shape == "monkey":
        bmesh.ops.create_monkey(made, calc_uvs=True)
    else:
        bmesh.ops.create_cube(made, size=1.0, calc_uvs=True)
    made.to_mesh(mesh)
    made.free()


def quarter_turn():
    """Return the rotation that turns what lies flat towards the camera."""
    return mathutils.Matrix.Rotation(math.pi / 2, 3, "X")


def make_curve(name, spec):
    """Make a curve of some splines."""
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    for kind, points in spec.get("splines", []):
        spline = curve.splines.new(kind)
        places = spline.bezier_points if kind == "BEZIER" else spline.points
        places.add(len(points) - 1)
        for place, at in zip(places, points, strict=True):
            place.co = at if kind == "BEZIER" else (*at, 1.0)
            if kind == "BEZIER":
                place.handle_left_type = place.handle_right_type = "AUTO"
    assign(curve, spec.get("data", {}))
    return curve


def make_text(name, spec):
    """Make a text."""
    text = bpy.data.curves.new(name, "FONT")
    assign(text, spec.get("data", {}))
    return text


def make_metaball(name, spec):
    """Make a metaball of some elements."""
    ball = bpy.data.metaballs.new(name)
    for place, radius in spec.get("elements", []):
        element = ball.elements.new()
        element.co, element.radius = place, radius
    assign(ball, spec.get("data", {}))
    return ball


def make_surface(name, spec):
    """Make a NURBS surface by Blender's own operator."""
    getattr(bpy.ops.surface, spec.get("primitive", "primitive_nurbs_surface_sphere_add"))(
        radius=0.5
    )
    obj = bpy.context.object
    for collection in list(obj.users_collection):
        collection.objects.unlink(obj)
    return obj


def make_hair(name, spec):
    """Make hair curves."""
    hair = bpy.data.hair_curves.new(name)
    if spec.get("count"):
        hair.add_curves([4] * spec["count"])
        places = np.random.default_rng(1).normal(0.0, 0.4, 12 * spec["count"])
        hair.position_data.foreach_set("vector", places.astype(np.float32))
    return hair


def make_pointcloud(name, spec):
    """Make a point cloud."""
    cloud = bpy.data.pointclouds.new(name)
    if spec.get("count"):
        cloud.resize(spec["count"])
        places = np.random.default_rng(1).normal(0.0, 0.4, 3 * spec["count"]).astype(np.float32)
        cloud.attributes["position"].data.foreach_set("vector", places)
    return cloud


def make_volume(name, spec):
    """Make a volume without a file."""
    return bpy.data.volumes.new(name)


def make_pencil(name, spec):
    """Make a grease pencil with some strokes."""
    pencil = bpy.data.grease_pencils.new(name)
    if spec.get("count"):
        drawing = pencil.layers.new("layer").frames.new(1).drawing
        drawing.add_strokes([5] * spec["count"])
        for i, stroke in enumerate(drawing.strokes):
            for j, point in enumerate(stroke.points):
                point.position = (0.2 * j - 0.4, 0.0, 0.2 * i)
                point.radius = 0.05
    return pencil


def make_other(name, spec):
    """Make an object that has nothing to be drawn."""
    makers = {
        "ARMATURE": bpy.data.armatures.new,
        "LATTICE": bpy.data.lattices.new,
        "SPEAKER": bpy.data.speakers.new,
        "LIGHT_PROBE": lambda name: bpy.data.lightprobes.new(name, "SPHERE"),
        "CAMERA": bpy.data.cameras.new,
    }
    maker = makers.get(spec.get("type"))
    return maker(name) if maker else None


def make_instance(name, spec):
    """Make an empty that shows a collection of its own."""
    collection = bpy.data.collections.new(name)
    for number, inner in enumerate(spec.get("objects", [])):
        make_object(collection, f"{number} in {name}", inner)
    empty = bpy.data.objects.new(name, None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    return empty


def add_particles(obj, spec, number):
    """Let an object emit particles that look like another one, or hair."""
    obj.modifiers.new("particles", "PARTICLE_SYSTEM")
    settings = obj.particle_systems[0].settings
    assign(settings, spec.get("set", {}))
    if "shown" in spec:
        collection = bpy.data.collections.new(f"particles {number}")
        settings.instance_object = make_object(collection, f"of {number}", spec["shown"])


def add_instances(obj, spec):
    """Put spheres on the vertices of an object by geometry nodes."""
    tree = bpy.data.node_groups.new("on points", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    nodes, link = tree.nodes, tree.links.new
    entry, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    copies = nodes.new("GeometryNodeInstanceOnPoints")
    ball = nodes.new("GeometryNodeMeshIcoSphere")
    ball.inputs["Radius"].default_value = spec.get("radius", 0.1)
    ball.inputs["Subdivisions"].default_value = spec.get("subdivisions", 1)
    paint = nodes.new("GeometryNodeSetMaterial")
    paint.inputs["Material"].default_value = bpy.data.materials.get(spec.get("material", ""))
    link(entry.outputs[0], copies.inputs["Points"])
    link(ball.outputs["Mesh"], paint.inputs["Geometry"])
    link(paint.outputs["Geometry"], copies.inputs["Instance"])
    source = copies
    if "realize" in spec:
        source = nodes.new("GeometryNodeRealizeInstances")
        link(copies.outputs[0], source.inputs[0])
    link(source.outputs[0], end.inputs[0])
    obj.modifiers.new("nodes", "NODES").node_group = tree


def make_collection(scene, name):
    """Add a collection to the scene."""
    collection = bpy.data.collections.new(name)
    scene.collection.children.link(collection)
    return collection


def make_layer(scene, number, spec):
    """Set up a view layer; the first one is there already."""
    layer = scene.view_layers[0] if number == 0 else scene.view_layers.new(f"layer {number}")
    assign(layer, spec.get("set", {}))
    for name, switches in spec.get("collections", {}).items():
        entry = layer.layer_collection.children.get(name)
        if entry is not None:
            assign(entry, switches)


def finish(scene, settings):
    """Set what refers to things that have to be there first, and have Blender evaluate all."""
    assign(scene, settings)
    bpy.context.view_layer.update()
