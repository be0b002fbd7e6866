"""That the digest of a scene tells what an engine is given."""

import numpy as np
import pytest

from benchmarks.zoo.blenders_part import digest


def cube(bpy):
    mesh = bpy.data.meshes.new("cube")
    corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
    mesh.from_pydata(corners, [], [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4)])
    mesh.uv_layers.new(name="UVMap")
    mesh.color_attributes.new("Col", "FLOAT_COLOR", "POINT")
    return mesh


def nudge(items, name, width):
    values = np.zeros(len(items) * width, np.float32)
    items.foreach_get(name, values)
    values[5] = np.nextafter(values[5], np.float32(2.0))
    items.foreach_set(name, values)


CHANGES = {
    "nothing": lambda mesh: None,
    "a vertex": lambda mesh: nudge(mesh.vertices, "co", 3),
    "a UV": lambda mesh: nudge(mesh.uv_layers[0].uv, "vector", 2),
    "a colour": lambda mesh: nudge(mesh.color_attributes[0].data, "color", 4),
    "normals": lambda mesh: mesh.polygons.foreach_set("use_smooth", np.ones(3, bool)),
}


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_of_the_last_bit_changes_the_digest(aplanat_bpy, empty_scene, change):
    mesh = cube(aplanat_bpy)
    mesh.polygons.foreach_set("use_smooth", np.zeros(3, bool))
    empty_scene.collection.objects.link(aplanat_bpy.data.objects.new("cube", mesh))
    before = digest(aplanat_bpy.context.evaluated_depsgraph_get())
    CHANGES[change](mesh)
    mesh.update()
    after = digest(aplanat_bpy.context.evaluated_depsgraph_get())
    assert (after == before) == (change == "nothing")
