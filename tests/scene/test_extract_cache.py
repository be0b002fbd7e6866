"""What did not change keeps its identity; what did change is never served from the cache.

The extractor hears of updates as a render engine does. After every step the kept extractor must
know exactly what a new one reads.
"""

import numpy as np
import pytest

from addon.scene.extract import SceneExtractor
from addon.scene.geometry.meshes import same_content
from addon.snapshot.changes import Change, compare_content
from tests import scene_builders as scenes


class Kept:
    """An extractor that lives through changes, checked against a new one at every look."""

    def __init__(self, bpy, extractor):
        self.bpy = bpy
        self.extractor = extractor
        self.content = None

    def look(self):
        """Extract; return the content and what changed since the last look."""
        depsgraph = self.bpy.context.evaluated_depsgraph_get()
        content = self.extractor.extract_content(depsgraph)
        fresh = SceneExtractor().extract_content(depsgraph)
        assert content.instances.world.tolist() == fresh.instances.world.tolist()
        assert len(content.groups) == len(fresh.groups)
        for a, b in zip(content.groups, fresh.groups, strict=True):
            assert (a.first, a.count, a.holdout) == (b.first, b.count, b.holdout)
            assert same_content(content.meshes[a.mesh], fresh.meshes[b.mesh])
            for x, y in zip(a.materials, b.materials, strict=True):
                assert content.materials[x].graph == fresh.materials[y].graph
        change = compare_content(self.content, content)
        self.content = content
        return content, change


@pytest.fixture
def bpy(aplanat_bpy, empty_scene):
    return aplanat_bpy


@pytest.fixture
def kept(bpy):
    with scenes.told_of_updates(bpy, SceneExtractor()) as extractor:
        paint = scenes.emission(bpy, "paint", (1, 0, 0))
        data = scenes.cube(bpy)
        data.materials.append(paint)
        scenes.add(bpy, "cube", data)
        scenes.add(bpy, "twin", data, at=(1, 0))
        scenes.add(bpy, "other", scenes.triangle(bpy), paint, at=(2, 0))
        scenes.look_along_y(bpy, 8.0)
        kept = Kept(bpy, extractor)
        kept.look()
        yield kept


def mesh_of(content, index=0):
    return content.meshes[content.groups[index].mesh]


def test_nothing_new_gives_the_very_same_content(kept):
    before = kept.content
    after, change = kept.look()
    assert after is before
    assert change == Change.NONE


def test_moving_the_camera_gives_the_very_same_content(kept, bpy):
    before = kept.content
    bpy.context.scene.camera.location.x += 1.0
    bpy.context.scene.camera.data.lens = 20.0
    bpy.context.view_layer.update()
    assert not kept.extractor._stale
    assert kept.look()[0] is before


def test_an_update_without_effect_gives_the_very_same_content(kept, bpy):
    before = kept.content
    bpy.data.objects["cube"].update_tag()
    bpy.data.objects["cube"].data.update()
    bpy.context.scene.render.resolution_x = 97
    bpy.context.scene.update_tag()
    bpy.context.view_layer.update()
    assert kept.extractor._stale
    assert kept.look()[0] is before


def test_moving_an_object_replaces_only_the_table(kept, bpy):
    before = kept.content
    bpy.data.objects["twin"].location.z = 3.0
    after, change = kept.look()
    assert change == Change.TRANSFORMS
    assert all(after.meshes[uid] is mesh for uid, mesh in before.meshes.items())


def test_changing_a_material_keeps_the_meshes_and_the_table(kept, bpy):
    before = kept.content
    tree = bpy.data.materials["paint"].node_tree
    tree.nodes["Emission"].inputs["Color"].default_value = (0, 1, 0, 1)
    after, change = kept.look()
    assert change == Change.MATERIALS | Change.GROUPS
    assert after.instances is before.instances
    assert all(after.meshes[uid] is mesh for uid, mesh in before.meshes.items())


def test_editing_a_mesh_replaces_that_mesh_only(kept, bpy):
    before = kept.content
    for x in (2.0, 3.0, 4.0, 5.0):
        # Blender frees the evaluated mesh and, as a rule, puts the next one in its place.
        bpy.data.meshes["cube"].vertices[0].co.x = x
        bpy.data.meshes["cube"].update()
        after, change = kept.look()
        assert change == Change.GEOMETRY | Change.GROUPS
        assert mesh_of(after).positions[:, 0].max() == x
        assert mesh_of(after, 1) is mesh_of(before, 1)


def test_editing_a_mesh_and_back_brings_equal_content_not_stale_content(kept, bpy):
    data = bpy.data.meshes["cube"]
    first = mesh_of(kept.content)
    place = data.vertices[0].co.copy()
    data.vertices[0].co.x = 7.0
    data.update()
    kept.look()
    data.vertices[0].co = place
    data.update()
    after, _ = kept.look()
    assert same_content(mesh_of(after), first)


def test_a_new_material_slot_or_modifier_is_seen(kept, bpy):
    cube = bpy.data.objects["cube"]
    cube.data.materials.append(scenes.emission(bpy, "second", (0, 0, 1)))
    cube.data.polygons[0].material_index = 1
    cube.data.update()
    after, _ = kept.look()
    assert len(mesh_of(after).slots) == 2
    levels = cube.modifiers.new("round", "SUBSURF")
    for level in (1, 2, 0):
        levels.levels = level
        after, _ = kept.look()
        assert len(mesh_of(after).triangles) == 12 * 4**level


def test_a_material_that_needs_normals_brings_them_and_keeps_what_it_can(kept, bpy):
    assert "normal" not in mesh_of(kept.content).attributes
    tree = bpy.data.materials["paint"].node_tree
    shiny = tree.nodes.new("ShaderNodeBsdfDiffuse")
    output = next(n for n in tree.nodes if n.type == "OUTPUT_MATERIAL")
    tree.links.new(shiny.outputs[0], output.inputs["Surface"])
    after, _ = kept.look()
    assert "normal" in mesh_of(after).attributes


def test_a_deleted_and_added_object_never_shows_the_old_mesh(kept, bpy):
    for size in (0.5, 1.0, 1.5, 2.0):
        bpy.data.objects.remove(bpy.data.objects["other"])
        bpy.data.meshes.remove(bpy.data.meshes["triangle"])
        scenes.add(bpy, "other", scenes.cube(bpy, "triangle", size))
        after, change = kept.look()
        assert Change.GEOMETRY in change
        assert any(m.positions.max() == size / 2 for m in after.meshes.values())


def test_hiding_and_changing_and_showing(kept, bpy):
    other = bpy.data.objects["other"]
    other.hide_viewport = True
    after, change = kept.look()
    assert len(after.groups) == 1
    other.data.vertices[0].co.x = -5.0
    other.data.update()
    kept.look()
    other.hide_viewport = False
    after, _ = kept.look()
    assert mesh_of(after, 1).positions.min() == -5.0


@pytest.mark.parametrize(
    "switch",
    [
        lambda obj: setattr(obj, "is_holdout", True),
        lambda obj: setattr(obj, "visible_camera", False),
        lambda obj: obj.hide_set(True),
    ],
)
def test_visibility_and_holdout_are_seen(kept, bpy, switch):
    switch(bpy.data.objects["other"])
    _, change = kept.look()
    assert Change.GROUPS in change
    assert Change.TRANSFORMS not in change or len(kept.content.groups) == 1


def test_collections_of_the_view_layer_are_seen(kept, bpy):
    folder, layer = scenes.collection(bpy, "folder")
    bpy.context.scene.collection.objects.unlink(bpy.data.objects["other"])
    folder.objects.link(bpy.data.objects["other"])
    kept.look()
    for flag in ("holdout", "indirect_only", "exclude"):
        layer = bpy.context.view_layer.layer_collection.children["folder"]
        setattr(layer, flag, True)
        _, change = kept.look()
        assert Change.GROUPS in change
        setattr(bpy.context.view_layer.layer_collection.children["folder"], flag, False)
        kept.look()


def test_animated_frames_have_their_own_shape(kept, bpy):
    obj = bpy.data.objects["other"]
    obj.shape_key_add(name="rest")
    key = obj.shape_key_add(name="moved")
    key.data[0].co.x = -8.0
    for frame, value in ((1, 0.0), (9, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    curve = bpy.data.actions[-1].layers[0].strips[0].channelbags[0].fcurves[0]
    for point in curve.keyframe_points:
        point.interpolation = "LINEAR"
    still = mesh_of(kept.look()[0])
    for frame in (1, 5, 9, 5, 1):
        bpy.context.scene.frame_set(frame)
        after, _ = kept.look()
        expected = -0.4 + (frame - 1) / 8 * (-8.0 + 0.4)
        assert np.isclose(mesh_of(after, 1).positions[:, 0].min(), expected, atol=1e-5)
        assert mesh_of(after) is still


def test_undo_and_redo_show_the_mesh_of_that_step(kept, bpy):
    bpy.context.preferences.edit.use_global_undo = True
    bpy.ops.ed.undo_push(message="start")
    for x in (2.0, 3.0):
        bpy.data.meshes["cube"].vertices[0].co.x = x
        bpy.data.meshes["cube"].update()
        kept.look()
        bpy.ops.ed.undo_push(message=f"moved to {x}")
    for operator, x in (("undo", 2.0), ("redo", 3.0), ("undo", 2.0), ("undo", 0.3)):
        getattr(bpy.ops.ed, operator)()
        after, _ = kept.look()
        assert mesh_of(after).positions[:, 0].max() == np.float32(x)


def test_instances_of_geometry_nodes_follow_their_object(kept, bpy):
    paint = bpy.data.materials["paint"]
    points = scenes.instancer(bpy, None, paint, [(0, 0, 0), (1, 0, 0)])
    ball = next(
        n for n in points.modifiers[0].node_group.nodes if n.type == "MESH_PRIMITIVE_ICO_SPHERE"
    )
    kept.look()
    for radius in (0.5, 0.75, 1.0):
        ball.inputs["Radius"].default_value = radius
        after, change = kept.look()
        assert Change.GEOMETRY in change
        assert any(np.isclose(m.positions.max(), radius, atol=1e-3) for m in after.meshes.values())
    before = kept.content
    points.location.x = 4.0
    after, change = kept.look()
    assert change == Change.TRANSFORMS
    assert after.meshes.keys() == before.meshes.keys()
    bpy.data.meshes["on points"].vertices[0].co.z = 2.0
    bpy.data.meshes["on points"].update()
    after, _ = kept.look()
    # The balls were made anew, equal ones: nothing to upload.
    assert after.meshes.keys() == before.meshes.keys()


def test_an_extraction_that_failed_does_not_poison_the_next(kept, bpy, monkeypatch):
    from addon.errors import InputError

    def fail(*_):
        raise InputError("no")

    data = bpy.data.meshes["cube"]
    scenes.set_coordinate(data, 0, 0.2)
    data.update()
    with monkeypatch.context() as broken:
        broken.setattr("addon.scene.extract.read_mesh", fail)
        for _ in range(2):
            with pytest.raises(InputError):
                kept.extractor.extract_content(bpy.context.evaluated_depsgraph_get())
    kept.look()
