"""Generated texture coordinates are those of Cycles, whatever deforms or makes the mesh."""

import numpy as np
import pytest

from tests.pictures import render_aplanat, render_cycles
from tests.scene_builders import look_along_y
from tests.surface_scenes import Tree


@pytest.fixture
def scene(empty_scene, aplanat_bpy):
    empty_scene.render.resolution_x = empty_scene.render.resolution_y = 32
    look_along_y(aplanat_bpy, 5.0)
    return empty_scene


def cube(bpy):
    bpy.ops.mesh.primitive_cube_add(size=2.0, rotation=(0.5, 0.3, 0.8), scale=(1.0, 0.7, 1.2))
    return bpy.context.object


def monkey(bpy):
    bpy.ops.mesh.primitive_monkey_add()
    return bpy.context.object


def moved_space(bpy):
    """A cube that is subdivided and deformed, in a texture space that is not its box."""
    made = cube(bpy)
    made.data.use_auto_texspace = False
    made.data.texspace_location, made.data.texspace_size = (0.3, -0.2, 0.1), (2.0, 0.0, 1.5)
    subdivided = made.modifiers.new("subdivided", "SUBSURF")
    subdivided.render_levels = 2
    made.modifiers.new("cast", "CAST").factor = 0.8
    return made


def bent(bpy):
    made = monkey(bpy)
    bend = made.modifiers.new("bend", "SIMPLE_DEFORM")
    bend.deform_method, bend.angle = "BEND", 1.5
    return made


def shape_key(bpy):
    made = cube(bpy)
    made.shape_key_add(name="Basis")
    key = made.shape_key_add(name="moved")
    key.data[0].co, key.value = (-3.0, -2.0, 0.0), 0.7
    return made


def array(bpy):
    made = cube(bpy)
    made.scale = (0.3, 0.3, 0.3)
    made.modifiers.new("array", "ARRAY").count = 3
    return made


def geometry_nodes(bpy):
    made = cube(bpy)
    tree = bpy.data.node_groups.new("nodes", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    transform = tree.nodes.new("GeometryNodeTransform")
    transform.inputs["Scale"].default_value = (1.5, 0.5, 0.7)
    tree.links.new(start.outputs[0], transform.inputs[0])
    tree.links.new(transform.outputs[0], end.inputs[0])
    made.modifiers.new("nodes", "NODES").node_group = tree
    return made


def curve(bpy):
    bpy.ops.curve.primitive_bezier_circle_add(radius=1.5, rotation=(1.0, 0.2, 0.0))
    bpy.context.object.data.bevel_depth = 0.4
    return bpy.context.object


@pytest.mark.parametrize(
    "make",
    [cube, moved_space, bent, shape_key, array, geometry_nodes, curve],
    ids=lambda make: make.__name__,
)
def test_generated_coordinates_are_those_of_cycles(make, scene, aplanat_bpy):
    made = make(aplanat_bpy)
    material = aplanat_bpy.data.materials.new("generated")
    material.node_tree.nodes.clear()
    tree = Tree(material.node_tree)
    tree.emission(tree.node("TexCoord").outputs["Generated"])
    made.data.materials.append(material)
    ours, cycles = render_aplanat(scene, 16), render_cycles(scene, 16)
    # Pixels of one surface: where it ends, places within the pixel decide.
    steps = [np.roll(cycles, step, axis) for step in (-1, 1) for axis in (0, 1)]
    inside = np.all([np.abs(step - cycles).max(axis=2) < 0.1 for step in steps], axis=0)
    inside &= cycles[..., 3] == 1.0
    assert inside.sum() > 30
    # Places within a pixel differ between the two: about a tenth of a pixel of 0.08.
    assert np.abs(ours - cycles)[inside].max() < 0.02
    assert not [line for line in warnings_of(aplanat_bpy, scene) if "Texture Coordinate" in line]


def warnings_of(bpy, scene):
    """Return what Aplanat's render of a scene has to tell."""
    from addon.engine.shared_resources import listen

    scene.render.engine = "APLANAT"
    with listen() as heard:
        bpy.ops.render.render(scene=scene.name)
    assert heard.error is None
    return heard.report
