"""Which copies of meshes are drawn, what they are called, and what is only reported."""

import numpy as np
import pytest

from addon.scene.extract import SceneExtractor
from addon.snapshot.cryptomatte import cryptomatte_id
from tests import scene_builders as scenes


@pytest.fixture
def bpy(aplanat_bpy, empty_scene):
    return aplanat_bpy


def extract(bpy, passes=("Combined",), shadows=False):
    return SceneExtractor().extract_content(bpy.context.evaluated_depsgraph_get(), passes, shadows)


def test_objects_and_instances_of_one_mesh_share_its_snapshot(bpy):
    data = scenes.cube(bpy)
    paint = scenes.emission(bpy, "paint", (1, 0, 0))
    data.materials.append(paint)
    for i in range(3):
        scenes.add(bpy, f"cube {i}", data, at=(i, 0))
    folder = bpy.data.collections.new("folder")
    scenes.add(bpy, "inside", data, collection=folder)
    empty = scenes.add(bpy, "empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", folder
    content = extract(bpy)
    (mesh,) = content.meshes.values()
    (group,) = content.groups
    assert (group.mesh, group.first, group.count) == (mesh.uid, 0, 4)
    assert content.instances.world.shape == (4, 4, 4)
    assert sorted(content.instances.world[:, 0, 3]) == [0, 0, 1, 2]


def test_random_numbers_of_instances_are_shares(bpy):
    """Object Info > Random is from 0 to 1; Blender shows its 32 bits as a signed number."""
    folder = bpy.data.collections.new("folder")
    scenes.add(bpy, "inside", scenes.cube(bpy), collection=folder)
    for i in range(16):
        empty = scenes.add(bpy, f"empty {i}", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", folder
    shares = extract(bpy).instances.looks[:, 4]
    assert len(shares) == 16
    assert shares.min() >= 0.0 and shares.max() <= 1.0
    assert shares.max() - shares.min() > 0.5


def test_copies_with_other_materials_or_holdout_are_other_groups_of_the_same_mesh(bpy):
    data = scenes.cube(bpy)
    data.materials.append(scenes.emission(bpy, "a", (1, 0, 0)))
    scenes.add(bpy, "plain", data)
    painted = scenes.add(bpy, "painted", data)
    painted.material_slots[0].link = "OBJECT"
    painted.material_slots[0].material = scenes.emission(bpy, "b", (0, 1, 0))
    scenes.add(bpy, "cut", data).is_holdout = True
    content = extract(bpy)
    assert len(content.meshes) == 1
    names = {content.materials[g.materials[0]].name: g.holdout for g in content.groups}
    assert len(content.groups) == 3
    assert names == {"a": True, "b": False}


def test_materials_are_listed_up_to_the_last_used_slot_and_unused_ones_not_read(bpy):
    data = scenes.cube(bpy)
    for i in range(4):
        data.materials.append(scenes.emission(bpy, f"slot {i}", (i / 4, 0, 0)))
    data.polygons[0].material_index = 2
    scenes.add(bpy, "cube", data)
    content = extract(bpy)
    (group,) = content.groups
    assert len(group.materials) == 3
    assert {m.name for m in content.materials.values()} == {"slot 0", "slot 2"}
    assert content.materials[group.materials[0]].name == "slot 0"
    assert content.materials[group.materials[2]].name == "slot 2"


def test_instances_carry_the_name_that_cycles_hashes(bpy):
    source = scenes.add(bpy, "source", scenes.cube(bpy))
    source.hide_render = source.hide_viewport = True
    folder = bpy.data.collections.new("folder")
    scenes.add(bpy, "inside", scenes.triangle(bpy), collection=folder)
    empty = scenes.add(bpy, "empty", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", folder
    paint = scenes.emission(bpy, "paint", (1, 1, 1))
    scenes.instancer(bpy, None, paint, [(0, 0, 0)], "made")
    scenes.instancer(bpy, source, paint, [(0, 0, 0), (1, 0, 0)], "placed")
    content = extract(bpy, ("Combined", "CryptoObject00"))
    assert sorted(content.instances.names) == ["inside", "made", "source", "source"]
    expected = [np.float32(cryptomatte_id(name)) for name in content.instances.names]
    assert content.instances.cryptomatte_id.tolist() == expected
    assert extract(bpy).instances.names == ()


def test_what_cannot_be_drawn_is_listed_once_by_name_and_kind(bpy):
    volume = bpy.data.volumes.new("smoke")
    scenes.add(bpy, "smoke", volume)
    cloud = bpy.data.pointclouds.new("empty cloud")
    scenes.add(bpy, "no points", cloud)
    hairy = scenes.add(bpy, "hairy", scenes.cube(bpy))
    hairy.modifiers.new("hair", "PARTICLE_SYSTEM").particle_system.settings.type = "HAIR"
    catcher = scenes.add(bpy, "catcher", scenes.cube(bpy))
    catcher.is_shadow_catcher = True
    folder = bpy.data.collections.new("folder")
    scenes.add(bpy, "fog", bpy.data.volumes.new("fog"), collection=folder)
    for i in range(3):
        empty = scenes.add(bpy, f"empty {i}", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", folder
    for kind, data in (
        ("armature", bpy.data.armatures.new("a")),
        ("lattice", bpy.data.lattices.new("l")),
        ("speaker", bpy.data.speakers.new("s")),
        ("wire", bpy.data.curves.new("w", "CURVE")),
    ):
        scenes.add(bpy, kind, data)
    report = extract(bpy).report
    assert len(report) == 4
    assert any("'smoke'" in line and "volume" in line for line in report)
    assert any("'fog'" in line and "3 copies" in line for line in report)
    assert any("'hairy'" in line and "hair" in line for line in report)
    assert any("'catcher'" in line and "shadow catcher" in line for line in report)


def test_what_only_throws_shadows_is_read_where_there_are_shadows(bpy):
    """Without them it would cost its mesh and its buffers for nothing."""
    scenes.add(bpy, "seen", scenes.cube(bpy))
    hidden = scenes.add(bpy, "hidden", scenes.cube(bpy, "other"))
    hidden.visible_camera = False
    content = extract(bpy)
    assert content.unseen is None and len(content.meshes) == 1
    content = extract(bpy, shadows=True)
    assert len(content.unseen.meshes) == len(content.meshes) == 1
    hidden.visible_shadow = False
    assert extract(bpy, shadows=True).unseen is None


def test_hidden_things_that_cannot_be_drawn_are_not_listed(bpy):
    smoke = scenes.add(bpy, "smoke", bpy.data.volumes.new("smoke"))
    smoke.visible_camera = False
    assert extract(bpy).report == ()


def test_an_object_whose_transform_is_not_finite_is_left_out_and_named(bpy):
    scenes.add(bpy, "fine", scenes.cube(bpy))
    scenes.add(bpy, "lost", scenes.triangle(bpy)).location.x = float("nan")
    content = extract(bpy)
    assert len(content.instances.world) == len(content.groups) == 1
    assert content.meshes[content.groups[0].mesh].name == "cube"
    (line,) = content.report
    assert line.startswith("object 'lost': its transform")


def test_a_mesh_that_is_not_finite_names_object_and_mesh(bpy):
    data = scenes.cube(bpy, "torn")
    scenes.set_coordinate(data, 3, float("inf"))
    scenes.add(bpy, "thing", data)
    (line,) = extract(bpy).report
    assert line.startswith("object 'thing': 1 vertices of mesh 'torn'")


def test_lights_beyond_what_the_device_holds_are_told(bpy, monkeypatch):
    monkeypatch.setattr("addon.scene.geometry.instances.MAX_LIGHTS", 1)
    for name in ("first", "second"):
        lamp = bpy.data.lights.new(name, "POINT")
        lamp.energy = 1.0
        scenes.add(bpy, name, lamp)
    content = extract(bpy)
    assert len(content.lights) == 1
    (line,) = content.report
    assert "'second'" in line and "does not shine" in line


def test_an_object_in_edit_mode_is_drawn_with_its_edits(bpy):
    import bmesh

    obj = scenes.add(bpy, "edited", scenes.cube(bpy))
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        (mesh,) = extract(bpy).meshes.values()
        assert len(mesh.triangles) == 12
        edit = bmesh.from_edit_mesh(obj.data)
        edit.verts.ensure_lookup_table()
        edit.verts[0].co.x = -9.0
        bmesh.update_edit_mesh(obj.data)
        (mesh,) = extract(bpy).meshes.values()
        assert mesh.positions[:, 0].min() == -9.0
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")


def test_holdouts_need_no_attributes_and_the_normal_pass_needs_normals(bpy):
    scenes.add(bpy, "cut", scenes.cube(bpy)).is_holdout = True
    (mesh,) = extract(bpy).meshes.values()
    assert mesh.attributes == {}
    (mesh,) = extract(bpy, ("Combined", "Normal")).meshes.values()
    assert set(mesh.attributes) == {"normal"}


def test_an_empty_scene_is_empty_content(bpy):
    scenes.add(bpy, "nothing", scenes.mesh(bpy, "nothing", [], []))
    content = extract(bpy)
    assert content.groups == ()
    assert content.meshes == {}
    assert extract(bpy).instances.world.shape[1:] == (4, 4)


def test_a_mesh_that_ends_in_subdivision_has_all_its_elements(bpy):
    # The viewport's evaluation, where Blender may leave them to the graphics device.
    obj = scenes.add(bpy, "round", scenes.cube(bpy))
    obj.modifiers.new("round", "SUBSURF").levels = 2
    assert bpy.context.evaluated_depsgraph_get().mode == "VIEWPORT"
    (mesh,) = extract(bpy).meshes.values()
    assert len(mesh.triangles) == 12 * 4**2


def test_simplify_limits_subdivision(bpy):
    obj = scenes.add(bpy, "round", scenes.cube(bpy))
    obj.modifiers.new("round", "SUBSURF").levels = 3
    bpy.context.scene.render.use_simplify = True
    bpy.context.scene.render.simplify_subdivision = 1
    (mesh,) = extract(bpy).meshes.values()
    assert len(mesh.triangles) == 12 * 4


def test_a_3d_view_shows_the_kinds_of_objects_it_is_set_to(aplanat_bpy):
    bpy = aplanat_bpy
    # The default scene, with its screens.
    bpy.ops.wm.read_factory_settings()
    areas = [area for screen in bpy.data.screens for area in screen.areas]
    space = next(area.spaces.active for area in areas if area.type == "VIEW_3D")
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert len(SceneExtractor(space).extract_content(depsgraph).groups) == 1
    space.show_object_viewport_mesh = False
    assert SceneExtractor(space).extract_content(depsgraph).groups == ()
    assert len(SceneExtractor().extract_content(depsgraph).groups) == 1


def test_linked_objects_are_drawn(bpy, tmp_path):
    library = tmp_path / "library.blend"
    data = scenes.cube(bpy, "linked cube")
    obj = bpy.data.objects.new("linked", data)
    data.materials.append(scenes.emission(bpy, "linked paint", (0, 1, 0)))
    bpy.data.libraries.write(str(library), {obj})
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects = ["linked"]
    for linked in wanted.objects:
        bpy.context.scene.collection.objects.link(linked)
    scenes.add(bpy, "linked cube", scenes.triangle(bpy, "linked cube"))
    content = extract(bpy)
    assert sorted(len(mesh.triangles) for mesh in content.meshes.values()) == [1, 12]
    assert {m.name for m in content.materials.values()} == {"linked paint", ""}
