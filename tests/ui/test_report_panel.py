"""Render > Report: what the last pictures lack, where that counts, and what its button does."""

from types import SimpleNamespace

import pytest

from addon.engine.report import failure, subject_of
from addon.engine.shared_resources import resources

from .panel_drawing import draw


@pytest.fixture
def scene(empty_scene):
    empty_scene.render.engine = "APLANAT"
    return empty_scene


@pytest.fixture
def things(scene, aplanat_bpy):
    """Three objects: one that renders leave out, and one whose material has an image in a group."""
    bpy = aplanat_bpy
    made = {}
    for name in ("Rug", "Hidden", "it's"):
        mesh = bpy.data.meshes.new(name)
        made[name] = bpy.data.objects.new(name, mesh)
        scene.collection.objects.link(made[name])
    made["Hidden"].hide_render = True
    inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
    inner.nodes.new("ShaderNodeTexImage").image = bpy.data.images.new("Wool", 4, 4)
    material = bpy.data.materials.new("Knitted")
    material.node_tree.nodes.new("ShaderNodeGroup").node_tree = inner
    for filling in (bpy.data.materials.new("Plain"), material):
        made["Rug"].data.materials.append(filling)
    return made


def lack(scene, where, *warnings, **more):
    with resources().open_session() as session:
        session.note_findings(scene, where, warnings, **more)


def shown(scene):
    from addon.ui.panels.report_panel import APLANAT_RENDER_PT_report

    region, system = SimpleNamespace(width=400), SimpleNamespace(ui_scale=1.0)
    context = SimpleNamespace(
        engine="APLANAT",
        scene=scene,
        region=region,
        preferences=SimpleNamespace(system=system),
    )
    return draw(APLANAT_RENDER_PT_report, context)


@pytest.mark.parametrize(
    ("line", "subject"),
    [
        ("object 'Rug': hair curves cannot be drawn; left out (3 copies)", ("object", "Rug")),
        ("object 'it's': left out", ("object", "it's")),
        ("image 'a.png' (//a.png) cannot be read; drawn in magenta", ("image", "a.png")),
        ("view layer 'Far': passes are left out", ("view layer", "Far")),
        ("library '//x.blend' cannot be read", ("", "")),
    ],
)
def test_a_warning_begins_with_its_data_block(line, subject):
    assert subject_of(line) == subject


@pytest.mark.parametrize("name", ["It's 'a' (hair) curve: x", "a': b", "a' [b.blend]", "a' (b"])
def test_names_may_have_quotes(scene, things, name):
    things["Rug"].name = name
    lack(scene, "viewport", f"object '{name}': attribute 'k' of mesh 'm': is (too) odd (3 copies)")
    (button,) = shown(scene).operators
    assert (button.kind, button.name) == ("object", name)


def test_a_linked_object_is_told_from_its_namesake(scene, things, aplanat_bpy, tmp_path):
    from addon.ui.panels.report_panel import BOTH, VIEWPORT, findings_of

    bpy, own = aplanat_bpy, things["Rug"]
    curves = bpy.data.hair_curves.new("Hair")
    curves.add_curves([4])
    hair = bpy.data.objects.new("Hair", curves)
    scene.collection.objects.link(hair)
    bpy.data.libraries.write(str(tmp_path / "rugs.blend"), {hair, own})
    with bpy.data.libraries.load(str(tmp_path / "rugs.blend"), link=True) as (_, wanted):
        wanted.objects = ["Rug", "Hair"]
    for linked in wanted.objects:
        scene.collection.objects.link(linked)
    linked = wanted.objects[0]
    own.hide_render = True
    lines = [f"object '{obj.name_full}': is odd" for obj in (own, linked)]
    lack(scene, "viewport", *lines)
    assert dict(findings_of(scene)) == dict(zip(lines, (VIEWPORT, BOTH), strict=True))
    for button, obj in zip(shown(scene).operators, (own, linked), strict=True):
        bpy.ops.object.aplanat_select_reported(kind=button.kind, name=button.name)
        assert bpy.context.selected_objects == [obj]
    # So the warnings name them.
    with resources().open_session() as session:
        extractor = session.extractor()
        found = extractor.extract_content(bpy.context.evaluated_depsgraph_get())
    told = [line.split(":")[0] for line in found.report if "hair" in line]
    assert told == ["object 'Hair'", "object 'Hair [rugs.blend]'"]


def test_the_button_finds_what_geometry_nodes_assign(scene, things, aplanat_bpy):
    bpy, holder = aplanat_bpy, things["Hidden"]
    tree = bpy.data.node_groups.new("Made", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    nodes = [tree.nodes.new(f"GeometryNode{name}") for name in ("MeshCube", "SetMaterial")]
    nodes[1].inputs["Material"].default_value = bpy.data.materials.new("By nodes")
    tree.links.new(nodes[0].outputs["Mesh"], nodes[1].inputs["Geometry"])
    last = tree.nodes.new("NodeGroupOutput")
    tree.links.new(nodes[1].outputs[0], last.inputs[0])
    holder.modifiers.new("Made", "NODES").node_group = tree
    for spread in (False, True):
        if spread:
            # Only as an instance.
            instance = tree.nodes.new("GeometryNodeInstanceOnPoints")
            points = tree.nodes.new("GeometryNodePoints")
            tree.links.new(points.outputs[0], instance.inputs["Points"])
            tree.links.new(nodes[1].outputs[0], instance.inputs["Instance"])
            tree.links.new(instance.outputs[0], last.inputs[0])
        bpy.ops.object.select_all(action="DESELECT")
        done = bpy.ops.object.aplanat_select_reported(kind="material", name="By nodes")
        assert done == {"FINISHED"}
        assert bpy.context.selected_objects == [holder] == [bpy.context.object]


def test_each_line_says_where_it_counts(scene, things, aplanat_bpy):
    from addon.ui.panels.report_panel import BOTH, RENDER, VIEWPORT, findings_of

    both, in_view, in_render = (
        "object 'Rug': is flat",
        "object 'Hidden': is flat",
        "scene 'Scene': motion blur is not drawn",
    )
    lack(scene, "viewport", both, in_view)
    lack(scene, "render", in_render)
    assert dict(findings_of(scene)) == {both: BOTH, in_view: VIEWPORT, in_render: RENDER}
    # In a collection that renders leave out, too.
    inner = aplanat_bpy.data.collections.new("Props")
    scene.collection.children.link(inner)
    scene.collection.objects.unlink(things["Rug"])
    inner.objects.link(things["Rug"])
    assert dict(findings_of(scene))[both] == BOTH
    inner.hide_render = True
    assert dict(findings_of(scene))[both] == VIEWPORT
    # What the last render told, counts for it.
    lack(scene, "render", both)
    assert dict(findings_of(scene))[both] == BOTH


def test_a_failure_stands_first_and_says_what_failed(scene, things):
    from addon.ui.panels.report_panel import findings_of

    lack(scene, "viewport", "object 'Rug': is flat", error=failure(KeyError("pupil\n table")))
    first = findings_of(scene)[0][0]
    assert first == "Aplanat failed (KeyError: 'pupil\\n table'); the console tells where"
    drawn = " ".join(shown(scene).labels)
    assert "KeyError" in drawn and "Rug" in drawn


def test_levels_that_are_made_and_a_scene_without_faults_are_told(scene):
    lack(scene, "viewport", levels=0.25)
    assert "F12 waits for them" in " ".join(shown(scene).labels)
    lack(scene, "viewport")
    assert "Everything is drawn as it is set." in " ".join(shown(scene).labels)


@pytest.mark.parametrize(
    ("kind", "name"), [("object", "Rug"), ("material", "Knitted"), ("image", "Wool")]
)
def test_the_button_selects_what_shows_it(scene, things, aplanat_bpy, kind, name):
    bpy = aplanat_bpy
    lack(scene, "viewport", f"{kind} '{name}': is odd")
    (button,) = shown(scene).operators
    assert (button.kind, button.name) == (kind, name)
    things["Hidden"].select_set(True)
    done = bpy.ops.object.aplanat_select_reported(kind=button.kind, name=button.name)
    assert done == {"FINISHED"}
    assert bpy.context.selected_objects == [things["Rug"]] == [bpy.context.object]
    if kind != "object":
        assert things["Rug"].active_material.name == "Knitted"
    assert bpy.ops.object.aplanat_select_reported(kind="object", name="gone") == {"CANCELLED"}


def test_news_are_told_once(scene):
    notes = resources().notes
    notes.take_news()
    lack(scene, "viewport", "object 'Rug': is flat")
    assert notes.take_news() and not notes.take_news()
    lack(scene, "viewport", "object 'Rug': is flat")
    assert not notes.take_news()


def test_a_final_render_leaves_its_warnings_and_its_failure(camera, scene, aplanat_bpy):
    bpy = aplanat_bpy
    scene.render.resolution_x, scene.render.resolution_y = 16, 8
    scene.aplanat.method, scene.aplanat.render_samples = "REFERENCE", 1
    scene.render.use_motion_blur = True
    bpy.ops.render.render()
    found = resources().notes.of(scene).render
    assert not found.error and any("motion blur" in line for line in found.warnings)
    camera.type = "PANO"
    with pytest.raises(RuntimeError, match="panoramic"):
        bpy.ops.render.render()
    assert "panoramic" in resources().notes.of(scene).render.error
