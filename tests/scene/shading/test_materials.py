"""Node trees become graphs; what did not change keeps its uid; what is not read is reported."""

import numpy as np
import pytest

from addon.scene.shading.materials import DEFAULT_GRAPH, MaterialReader
from addon.snapshot.surface_graph import Constant, Link, attributes_read
from tests.surface_scenes import Tree, image, random_pixels


@pytest.fixture
def bpy(aplanat_bpy):
    aplanat_bpy.ops.wm.read_factory_settings(use_empty=True)
    return aplanat_bpy


def new_material(bpy, name="m"):
    material = bpy.data.materials.new(name)
    material.node_tree.nodes.clear()
    return material, Tree(material.node_tree)


def read(material, reader=None):
    reader = reader or MaterialReader()
    reader.begin()
    return reader.materials[reader.read(material)], reader


def kinds(snapshot):
    return [node.kind for node in snapshot.graph.nodes]


def test_no_material_is_the_default_grey_diffuse_surface(bpy):
    snapshot, _ = read(None)
    assert snapshot.graph is DEFAULT_GRAPH


def test_a_material_without_surface_reflects_nothing(bpy):
    material, _ = new_material(bpy)
    snapshot, reader = read(material)
    assert snapshot.graph.nodes == () and snapshot.graph.surface is None
    assert reader.report == []


def test_reroutes_muted_nodes_and_nested_groups_are_seen_through(bpy):
    inner = bpy.data.node_groups.new("inner", "ShaderNodeTree")
    inner.interface.new_socket("Tint", in_out="INPUT", socket_type="NodeSocketColor")
    inner.interface.new_socket("Light", in_out="OUTPUT", socket_type="NodeSocketShader")
    source, sink = inner.nodes.new("NodeGroupInput"), inner.nodes.new("NodeGroupOutput")
    glow = inner.nodes.new("ShaderNodeEmission")
    inner.links.new(source.outputs["Tint"], glow.inputs["Color"])
    inner.links.new(glow.outputs[0], sink.inputs["Light"])
    outer = bpy.data.node_groups.new("outer", "ShaderNodeTree")
    outer.interface.new_socket("Paint", in_out="INPUT", socket_type="NodeSocketColor")
    outer.interface.new_socket("Result", in_out="OUTPUT", socket_type="NodeSocketShader")
    source, sink = outer.nodes.new("NodeGroupInput"), outer.nodes.new("NodeGroupOutput")
    nested = outer.nodes.new("ShaderNodeGroup")
    nested.node_tree = inner
    outer.links.new(source.outputs["Paint"], nested.inputs["Tint"])
    outer.links.new(nested.outputs["Light"], sink.inputs["Result"])
    material, tree = new_material(bpy)
    rgb = tree.node("RGB")
    rgb.outputs[0].default_value = (0.1, 0.2, 0.3, 1.0)
    gamma = tree.node("Gamma", {"Color": rgb.outputs[0]})
    gamma.mute = True
    reroute = tree.tree.nodes.new("NodeReroute")
    tree.tree.links.new(gamma.outputs[0], reroute.inputs[0])
    group = tree.tree.nodes.new("ShaderNodeGroup")
    group.node_tree = outer
    tree.tree.links.new(reroute.outputs[0], group.inputs["Paint"])
    tree.surface(group.outputs["Result"])
    snapshot, reader = read(material)
    assert kinds(snapshot) == ["emission"]
    assert snapshot.graph.nodes[0].input("Color").value == pytest.approx((0.1, 0.2, 0.3))
    assert reader.report == []


def test_a_node_that_is_not_read_gives_its_sockets_value_and_one_line(bpy):
    material, tree = new_material(bpy)
    unread = tree.node("ShaderToRGB")
    glow = tree.emission((0.2, 0.4, 0.6))
    tree.tree.links.new(unread.outputs["Color"], glow.inputs["Color"])
    snapshot, reader = read(material)
    assert snapshot.graph.nodes[0].input("Color").value == pytest.approx((0.2, 0.4, 0.6))
    assert reader.report == [
        "material 'm': node 'Shader to RGB' is not read; its socket's value is used"
    ]


def test_what_a_principled_surface_leaves_out_is_reported(bpy):
    material, tree = new_material(bpy)
    tree.surface(tree.node("BsdfPrincipled", {"Thin Film Thickness": 500.0}).outputs[0])
    _, reader = read(material)
    assert reader.report == [
        "material 'm': thin film thickness of node 'Principled BSDF' is not drawn"
    ]


def test_only_what_is_lit_reads_normals_and_an_unlinked_image_the_active_uv(bpy):
    material, tree = new_material(bpy)
    texture = tree.node("TexImage", image=image(bpy, "i", random_pixels(0)))
    glow = tree.emission(texture.outputs["Color"])
    assert attributes_read(read(material)[0].graph) == {"uv:"}
    paint = tree.node("VertexColor", layer_name="Paint")
    surface = tree.node("BsdfDiffuse", {"Color": paint.outputs["Color"]})
    tree.surface(surface.outputs[0])
    assert attributes_read(read(material)[0].graph) == {"normal", "color:Paint"}
    assert glow.type == "EMISSION"


def test_alpha_of_exactly_one_leaves_no_alpha_in_the_shape(bpy):
    material, tree = new_material(bpy)
    node = tree.node("BsdfPrincipled")
    tree.surface(node.outputs[0])
    opaque, _ = read(material)
    assert "Alpha" not in dict(opaque.graph.nodes[0].inputs)
    node.inputs["Alpha"].default_value = 0.5
    half, _ = read(material)
    assert half.graph.nodes[0].input("Alpha") == Constant((0.5,))


def test_a_mix_with_a_constant_end_is_the_shader_at_that_end(bpy):
    material, tree = new_material(bpy)
    parts = {"Shader": tree.node("BsdfTransparent").outputs[0]}
    parts["Shader_001"] = tree.node("Emission").outputs[0]
    tree.surface(tree.node("MixShader", {"Fac": 1.0, **parts}).outputs[0])
    snapshot, _ = read(material)
    assert kinds(snapshot) == ["emission"]
    assert snapshot.graph.surface == Link(0, "Emission")


def test_a_material_that_did_not_change_keeps_its_uid_and_one_that_did_does_not(bpy):
    material, tree = new_material(bpy)
    glow = tree.emission((1.0, 0.0, 0.0))
    first, reader = read(material)
    again, _ = read(material, reader)
    assert again is first
    glow.inputs["Strength"].default_value = 2.0
    changed, _ = read(material, reader)
    assert changed.uid != first.uid


def test_a_painted_image_is_read_again_and_an_equal_one_keeps_its_uid(bpy):
    material, tree = new_material(bpy)
    picture = image(bpy, "i", random_pixels(0))
    tree.emission(tree.node("TexImage", image=picture).outputs["Color"])
    first, reader = read(material)
    uid = next(iter(reader.images))
    picture.pixels.foreach_set(np.full(6 * 5 * 4, 0.5, np.float32))
    changed, _ = read(material, reader)
    assert uid not in reader.images and changed.uid != first.uid
    # Still unsaved: it is read again and found equal.
    again, _ = read(material, reader)
    assert again is changed


def test_each_frame_of_a_sequence_is_an_image_of_its_own(bpy, tmp_path):
    for frame in (1, 2):
        made = bpy.data.images.new("frame", 2, 2)
        made.pixels.foreach_set(np.tile(np.float32([0.2 * frame, 0, 0, 1]), 4))
        made.filepath_raw = str(tmp_path / f"frame_{frame:03d}.png")
        made.file_format = "PNG"
        made.save()
    material, tree = new_material(bpy)
    sequence = bpy.data.images.load(str(tmp_path / "frame_001.png"))
    sequence.source = "SEQUENCE"
    node = tree.node("TexImage", image=sequence)
    node.image_user.frame_duration = 2
    node.image_user.frame_start = 1
    node.image_user.use_auto_refresh = True
    tree.emission(node.outputs["Color"])
    data = bpy.data.meshes.new("mesh")
    data.materials.append(material)
    bpy.context.collection.objects.link(bpy.data.objects.new("object", data))
    reader = MaterialReader()
    reds = []
    for frame in (1, 2):
        bpy.context.scene.frame_set(frame)
        evaluated = material.evaluated_get(bpy.context.evaluated_depsgraph_get())
        read(evaluated, reader)
        reds.append(int(next(iter(reader.images.values())).pixels[0, 0, 0]))
    # 0.2 and 0.4 of 255, sRGB encoded when an 8-bit image is written.
    assert reds[0] < reds[1]


def test_an_image_without_pixels_is_magenta_and_reported(bpy):
    material, tree = new_material(bpy)
    missing = bpy.data.images.new("gone", 1, 1)
    missing.source = "FILE"
    missing.filepath = "//gone.png"
    tree.emission(tree.node("TexImage", image=missing).outputs["Color"])
    snapshot, reader = read(material)
    assert snapshot.graph.nodes[0].input("Color") == Constant((1.0, 0.0, 1.0))
    assert reader.report == ["image 'gone' (//gone.png) cannot be read; drawn in magenta"]


def test_images_behind_a_mix_are_read_and_those_behind_an_unknown_node_are_told(bpy):
    material, tree = new_material(bpy, "Wall")
    first = tree.node("TexImage", image=image(bpy, "a", random_pixels(0)))
    second = tree.node("TexImage", image=image(bpy, "b", random_pixels(1)))
    mix = tree.node("Mix", data_type="RGBA")
    by_name = {socket.identifier: socket for socket in (*mix.inputs, *mix.outputs)}
    tree.tree.links.new(first.outputs["Color"], by_name["A_Color"])
    tree.tree.links.new(second.outputs["Color"], by_name["B_Color"])
    glow = tree.emission(by_name["Result_Color"])
    snapshot, reader = read(material)
    assert kinds(snapshot).count("image_texture") == 2 and "mix_color" in kinds(snapshot)
    assert reader.report == []
    unread = tree.node("ShaderToRGB")
    tree.tree.links.new(unread.outputs[0], glow.inputs["Color"])
    _, reader = read(material)
    assert reader.report == [
        "material 'Wall': node 'Shader to RGB' is not read; its socket's value is used"
    ]


def test_more_ramps_than_the_constants_hold_are_told(bpy):
    material, tree = new_material(bpy)
    value = tree.node("VertexColor").outputs[0]
    for _ in range(20):
        value = tree.node("ValToRGB", {"Fac": value}).outputs[0]
    tree.emission(value)
    snapshot, reader = read(material)
    rows = sum(len(node.table) for node in snapshot.graph.nodes)
    assert rows <= 3584
    assert reader.report == [
        "material 'm': node 'Color Ramp' is not read; its socket's value is used"
    ]


def test_dragging_a_ramps_color_changes_constants_and_not_the_code(bpy):
    from addon.passes.nodes.surface_code import generate

    material, tree = new_material(bpy)
    ramp = tree.node("ValToRGB")
    tree.emission(ramp.outputs[0])
    before = generate(read(material)[0].graph, ())
    ramp.color_ramp.elements[0].color = (1.0, 0.0, 0.0, 1.0)
    after = generate(read(material)[0].graph, ())
    assert before.source == after.source
    assert before.constants != after.constants


def test_a_material_keeps_its_shader_whatever_its_numbers(bpy):
    """200 materials of 20 shapes of trees have 20 shaders; sliders and colours compile nothing."""
    from addon.passes.nodes.surface_code import generate

    sources = set()
    for number in range(200):
        material, tree = new_material(bpy)
        color = tree.node("TexCoord").outputs["Generated"]
        for step in range(number % 20):
            inputs = {"Vector": color, "Scale": 1.0 + number, "Detail": 0.1 * step}
            color = tree.node("TexNoise", inputs).outputs["Color"]
        inputs = {"Base Color": color, "Roughness": number / 200, "Metallic": 0.3}
        tree.surface(tree.node("BsdfPrincipled", inputs).outputs[0])
        code = generate(read(material)[0].graph, ("normal", "generated"))
        sources.add((code.source, len(code.constants), code.features))
    assert len(sources) == 20


def emission_of(material):
    snapshot, reader = read(material)
    assert reader.report == []
    return snapshot.graph.nodes[snapshot.graph.surface.node]


def test_a_reroute_that_nothing_feeds_keeps_the_sockets_value(bpy):
    material, tree = new_material(bpy)
    glow = tree.emission((0.2, 0.4, 0.6), 7.0)
    dangling = tree.tree.nodes.new("NodeReroute")
    tree.tree.links.new(dangling.outputs[0], glow.inputs["Strength"])
    assert emission_of(material).input("Strength").value == (7.0,)


def test_groups_in_groups_and_muted_nodes_are_seen_through(bpy):
    inner = bpy.data.node_groups.new("inner", "ShaderNodeTree")
    inner.interface.new_socket("Number", in_out="INPUT", socket_type="NodeSocketFloat")
    inner.interface.new_socket("Number", in_out="OUTPUT", socket_type="NodeSocketFloat")
    start, end = (inner.nodes.new(f"NodeGroup{end}") for end in ("Input", "Output"))
    muted = inner.nodes.new("ShaderNodeMath")
    muted.mute = True
    inner.links.new(start.outputs[0], muted.inputs[0])
    inner.links.new(muted.outputs[0], end.inputs[0])
    outer = inner.copy()
    outer.nodes.clear()
    start, end = (outer.nodes.new(f"NodeGroup{end}") for end in ("Input", "Output"))
    group = outer.nodes.new("ShaderNodeGroup")
    group.node_tree = inner
    outer.links.new(start.outputs[0], group.inputs[0])
    outer.links.new(group.outputs[0], end.inputs[0])
    material, tree = new_material(bpy)
    used = tree.node("Group", node_tree=outer)
    used.inputs[0].default_value = 0.3
    tree.emission((1.0, 1.0, 1.0), used.outputs[0])
    assert emission_of(material).input("Strength").value == pytest.approx((0.3,))


def test_vectors_that_blender_computes_are_read(bpy):
    """It puts nodes of other trees in their place."""
    material, tree = new_material(bpy)
    made = tree.node("CombineXYZ", {"X": 0.2, "Y": 0.4, "Z": 0.6})
    turned = tree.node("VectorMath", {"Vector": made.outputs[0], "Vector_001": (1.0, 1.0, 1.0)})
    varying = tree.node("TexCoord").outputs["UV"]
    noise = tree.node("TexNoise", {"Vector": turned.outputs[0], "Scale": varying})
    tree.emission(noise.outputs["Color"])
    snapshot, reader = read(material)
    place = next(n for n in snapshot.graph.nodes if n.kind == "noise").input("Vector")
    assert reader.report == []
    assert place.value == pytest.approx((1.2, 1.4, 1.6))


def test_a_menu_chooses_what_is_drawn(bpy):
    material, tree = new_material(bpy)
    switch = tree.tree.nodes.new("GeometryNodeMenuSwitch")
    switch.data_type = "FLOAT"
    numbers = [socket for socket in switch.inputs if socket.type == "VALUE"]
    for socket, value in zip(numbers, (0.25, 0.75), strict=False):
        socket.default_value = value
    switch.inputs[0].default_value = switch.enum_items[1].name
    tree.emission((1.0, 1.0, 1.0), switch.outputs[0])
    assert emission_of(material).input("Strength").value == (0.75,)
