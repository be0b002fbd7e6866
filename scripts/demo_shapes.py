"""Shapes and materials that the demo scene is made of."""

import math

import bpy
import numpy as np

# isort: split
# Modules of Blender, there once bpy is imported.
import bmesh
from mathutils import Matrix


def material(name, color, roughness=0.5, metallic=0.0, alpha=1.0, glow=0.0):
    """Make a Principled material with constant inputs."""
    made = bpy.data.materials.new(name)
    node = made.node_tree.nodes["Principled BSDF"]
    node.inputs["Base Color"].default_value = (*color, 1.0)
    node.inputs["Roughness"].default_value = roughness
    node.inputs["Metallic"].default_value = metallic
    node.inputs["Alpha"].default_value = alpha
    node.inputs["Emission Color"].default_value = (*color, 1.0)
    node.inputs["Emission Strength"].default_value = glow
    return made


def emission(name, color, strength):
    """Make an Emission material."""
    made = bpy.data.materials.new(name)
    tree = made.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    node = tree.nodes.new("ShaderNodeEmission")
    node.inputs["Color"].default_value = (*color, 1.0)
    node.inputs["Strength"].default_value = strength
    tree.links.new(node.outputs["Emission"], output.inputs["Surface"])
    return made


def add(name, mesh, surface, matrix=None, smooth=True, collection=None):
    """Link a mesh, made by a `bmesh` operation or at hand, as an object."""
    if isinstance(mesh, bmesh.types.BMesh):
        data = bpy.data.meshes.new(name)
        mesh.to_mesh(data)
        mesh.free()
        data.shade_smooth() if smooth else data.shade_flat()
        data.materials.append(surface)
        mesh = data
    made = bpy.data.objects.new(name, mesh)
    made.matrix_world = matrix or Matrix()
    (collection or bpy.context.scene.collection).objects.link(made)
    return made


def box(size, bevel=0.0):
    """Return a box, its edges rounded."""
    mesh = bmesh.new()
    bmesh.ops.create_cube(mesh, size=1.0, matrix=Matrix.Diagonal((*size, 1.0)))
    if bevel:
        bmesh.ops.bevel(
            mesh, geom=mesh.edges, offset=bevel, segments=3, profile=0.5, affect="EDGES"
        )
    return mesh


def sphere(radius, segments=32):
    """Return a sphere of longitude and latitude."""
    mesh = bmesh.new()
    bmesh.ops.create_uvsphere(mesh, u_segments=segments, v_segments=segments // 2, radius=radius)
    return mesh


def lathe(profile, steps=64):
    """Turn (radius, height) points about the z axis."""
    mesh = bmesh.new()
    points = [mesh.verts.new((radius, 0.0, height)) for radius, height in profile]
    edges = [mesh.edges.new(pair) for pair in zip(points, points[1:], strict=False)]
    bmesh.ops.spin(
        mesh,
        geom=[*points, *edges],
        cent=(0, 0, 0),
        axis=(0, 0, 1),
        angle=math.tau,
        steps=steps,
        use_merge=True,
        use_normal_flip=True,
    )
    bmesh.ops.remove_doubles(mesh, verts=mesh.verts, dist=1e-6)
    bmesh.ops.recalc_face_normals(mesh, faces=mesh.faces)
    return mesh


def paint(made, colors):
    """Give each vertex a colour, computed from its place in the object."""
    mesh = made.data
    places = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.attributes["position"].data.foreach_get("vector", places)
    layer = mesh.color_attributes.new("Paint", "FLOAT_COLOR", "POINT")
    values = np.ones((len(mesh.vertices), 4), np.float32)
    values[:, :3] = colors(places.reshape(-1, 3))
    layer.data.foreach_set("color", values.ravel())
