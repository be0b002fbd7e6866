"""Objects of every kind for small test scenes; colours are unlit, so that only coverage counts."""

from contextlib import contextmanager

import numpy as np

from benchmarks.scenes.materials import emission

__all__ = ["emission"]


def mesh(bpy, name, vertices, faces):
    data = bpy.data.meshes.new(name)
    data.from_pydata(vertices, [], faces)
    return data


def set_coordinate(data, vertex, value):
    """Set y of a vertex as an importer does: Blender clamps what is set one by one."""
    positions = np.empty(3 * len(data.vertices), np.float32)
    data.attributes["position"].data.foreach_get("vector", positions)
    positions[3 * vertex + 1] = value
    data.attributes["position"].data.foreach_set("vector", positions)


@contextmanager
def told_of_updates(bpy, extractor):
    """Tell an extractor of updates when an engine is told: before Blender forgets them."""

    def tell(_scene, depsgraph):
        extractor.note_updates(depsgraph)

    occasions = (bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post)
    for handlers in occasions:
        handlers.append(tell)
    try:
        yield extractor
    finally:
        for handlers in occasions:
            handlers.remove(tell)


def triangle(bpy, name="triangle"):
    """A triangle without symmetry in the xz plane: mirrored or turned ones look different."""
    return mesh(bpy, name, [(-0.4, 0, -0.4), (0.4, 0, -0.4), (-0.4, 0, 0.5)], [(0, 1, 2)])


def cube(bpy, name="cube", size=0.6):
    h = size / 2
    corners = [(x, y, z) for x in (-h, h) for y in (-h, h) for z in (-h, h)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return mesh(bpy, name, corners, faces)


def add(bpy, name, data, material=None, at=(0.0, 0.0), collection=None):
    """Put an object into the scene, at x and z; the camera looks along +y."""
    if material is not None:
        data.materials.append(material)
    obj = bpy.data.objects.new(name, data)
    obj.location = (at[0], 0.0, at[1])
    (collection or bpy.context.scene.collection).objects.link(obj)
    return obj


def look_along_y(bpy, width):
    """An orthographic camera that sees `width` units around the origin, from the -y side."""
    data = bpy.data.cameras.new("camera")
    data.type = "ORTHO"
    data.ortho_scale = width
    data.dof.use_dof = False
    camera = bpy.data.objects.new("camera", data)
    camera.location = (0.0, -20.0, 0.0)
    camera.rotation_euler = (np.pi / 2, 0.0, 0.0)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    return camera


def collection(bpy, name):
    """A collection of the scene; returns it and its entry in the view layer."""
    new = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(new)
    return new, bpy.context.view_layer.layer_collection.children[name]


def instancer(bpy, source, material, realized_points, name="on points"):
    """Geometry nodes that put copies of an object's or an ico sphere's mesh on given points."""
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    nodes, links = tree.nodes, tree.links
    start, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    copies = nodes.new("GeometryNodeInstanceOnPoints")
    links.new(start.outputs[0], copies.inputs["Points"])
    if source is None:
        ball = nodes.new("GeometryNodeMeshIcoSphere")
        ball.inputs["Radius"].default_value = 0.3
        paint = nodes.new("GeometryNodeSetMaterial")
        paint.inputs["Material"].default_value = material
        links.new(ball.outputs["Mesh"], paint.inputs["Geometry"])
        links.new(paint.outputs["Geometry"], copies.inputs["Instance"])
    else:
        info = nodes.new("GeometryNodeObjectInfo")
        info.inputs["Object"].default_value = source
        info.inputs["As Instance"].default_value = True
        links.new(info.outputs["Geometry"], copies.inputs["Instance"])
    links.new(copies.outputs["Instances"], end.inputs[0])
    points = add(bpy, name, mesh(bpy, name, realized_points, []))
    points.modifiers.new("nodes", "NODES").node_group = tree
    return points
