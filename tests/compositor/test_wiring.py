"""Setting up a scene's compositing: what the user has stays, and a second run changes nothing."""

import numpy as np
import OpenEXR
import pytest

from addon.compositor.asset_library import (
    add_library,
    bundled_folder,
    known_library,
    write_asset_library,
)
from addon.compositor.node_groups import GROUPS, MIX, is_ours, node_group
from addon.compositor.sprite_image import camera_sprite
from addon.compositor.wiring import wire_picture, wire_render
from tests.pictures import render_picture


@pytest.fixture
def aplanat_scene(scene):
    scene.render.engine = "APLANAT"
    return scene


def described(scene):
    """Nodes and links of a scene's compositing, as text."""
    tree = scene.compositing_node_group
    nodes = sorted((n.name, n.type, tuple(n.location)) for n in tree.nodes)
    links = sorted(
        (k.from_node.name, k.from_socket.name, k.to_node.name, k.to_socket.name) for k in tree.links
    )
    return nodes, links, [item.name for item in tree.interface.items_tree]


def node_of(scene, kind):
    return next(node for node in scene.compositing_node_group.nodes if node.type == kind)


def fed_by(socket):
    return [link.from_node.type for link in socket.links]


def test_a_scene_without_nodes_gets_mix_and_output(aplanat_scene):
    layer = aplanat_scene.view_layers[0]
    assert wire_render(aplanat_scene, layer) == (True, [])
    assert layer.aplanat.use_pass_defocus and layer.aplanat.use_pass_bokeh
    mix = node_of(aplanat_scene, "GROUP")
    assert is_ours(mix.node_tree, MIX)
    assert [link.from_socket.name for link in mix.inputs["Defocus"].links] == ["Defocus"]
    assert [link.from_socket.name for link in mix.inputs["Bokeh"].links] == ["Bokeh"]
    assert fed_by(node_of(aplanat_scene, "GROUP_OUTPUT").inputs[0]) == ["GROUP"]
    before = described(aplanat_scene)
    assert wire_render(aplanat_scene, layer) == (False, [])
    assert described(aplanat_scene) == before


def test_a_chain_of_the_users_is_fed_by_the_mix(aplanat_bpy, aplanat_scene):
    tree = aplanat_bpy.data.node_groups.new("Mine", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    tree.interface.new_socket("Mask", in_out="OUTPUT", socket_type="NodeSocketFloat")
    source = tree.nodes.new("CompositorNodeRLayers")
    glare, viewer = tree.nodes.new("CompositorNodeGlare"), tree.nodes.new("CompositorNodeViewer")
    output = tree.nodes.new("NodeGroupOutput")
    for pair in (
        (source.outputs["Image"], glare.inputs["Image"]),
        (source.outputs["Image"], viewer.inputs[0]),
        (glare.outputs["Image"], output.inputs[0]),
        (source.outputs["Alpha"], output.inputs[1]),
    ):
        tree.links.new(*pair)
    aplanat_scene.compositing_node_group = tree
    assert wire_render(aplanat_scene, aplanat_scene.view_layers[0]) == (True, [])
    assert aplanat_scene.compositing_node_group == tree and len(tree.nodes) == 5
    assert fed_by(glare.inputs["Image"]) == fed_by(viewer.inputs[0]) == ["GROUP"]
    assert fed_by(output.inputs[0]) == ["GLARE"] and fed_by(output.inputs[1]) == ["R_LAYERS"]
    mix = node_of(aplanat_scene, "GROUP")
    mix.inputs["Bokeh Exposure"].default_value = 1.5
    tree.links.remove(mix.inputs["Bokeh"].links[0])
    # The link that is missing is made; nothing else changes.
    assert wire_render(aplanat_scene, aplanat_scene.view_layers[0]) == (True, [])
    assert len(tree.nodes) == 5 and fed_by(mix.inputs["Bokeh"]) == ["R_LAYERS"]
    assert mix.inputs["Bokeh Exposure"].default_value == 1.5


def test_what_the_user_has_put_to_the_output_stays_and_is_told(aplanat_bpy, aplanat_scene):
    tree = aplanat_bpy.data.node_groups.new("Mine", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    color, output = tree.nodes.new("CompositorNodeRGB"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(color.outputs[0], output.inputs[0])
    aplanat_scene.compositing_node_group = tree
    _, notes = wire_render(aplanat_scene, aplanat_scene.view_layers[0])
    assert fed_by(output.inputs[0]) == ["RGB"]
    assert len(notes) == 1 and "not linked to the Group Output" in notes[0]


def test_with_another_engine_the_whole_picture_is_the_base(scene):
    assert wire_render(scene, scene.view_layers[0]) == (True, [])
    mix = node_of(scene, "GROUP")
    assert [link.from_socket.name for link in mix.inputs["Defocus"].links] == ["Image"]
    assert not mix.inputs["Bokeh"].is_linked


@pytest.mark.parametrize(
    ("before", "after", "defocus", "bokeh"),
    [
        ("CYCLES", "APLANAT", ["Defocus"], ["Bokeh"]),
        ("APLANAT", "CYCLES", ["Image"], []),
    ],
)
def test_another_engine_is_wired_anew(scene, before, after, defocus, bokeh):
    scene.render.engine = before
    wire_render(scene, scene.view_layers[0])
    scene.render.engine = after
    assert wire_render(scene, scene.view_layers[0]) == (True, [])
    mix = node_of(scene, "GROUP")
    assert [link.from_socket.name for link in mix.inputs["Defocus"].links] == defocus
    assert [link.from_socket.name for link in mix.inputs["Bokeh"].links] == bokeh
    assert wire_render(scene, scene.view_layers[0]) == (False, [])


def test_a_picture_takes_the_place_of_the_render(scene, noise, tmp_path):
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    pixels = {"RGBA": np.ascontiguousarray(noise[::-1])}
    OpenEXR.File(header, pixels).write(str(tmp_path / "a.exr"))
    path = str(tmp_path / "a.exr")
    assert wire_picture(scene, path) == (True, [])
    before = described(scene)
    assert wire_picture(scene, path) == (False, [])
    assert described(scene) == before
    found = render_picture(scene)[::-1]
    assert np.array_equal(found, noise)
    with pytest.raises(RuntimeError):
        wire_picture(scene, str(tmp_path / "none.exr"))


def test_a_sequence_shows_the_file_of_each_frame(aplanat_bpy, scene, tmp_path):
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    for frame in (5, 6, 7):
        pixels = np.full((32, 48, 4), 0.1 * frame, np.float32)
        OpenEXR.File(dict(header), {"RGBA": pixels}).write(str(tmp_path / f"a_{frame:04d}.exr"))
    scene.frame_start, scene.frame_end = 5, 7
    scene.aplanat.refocus.output = str(tmp_path / "a_####.exr")
    assert aplanat_bpy.ops.scene.aplanat_wire_compositor(source="REFOCUSED") == {"FINISHED"}
    before = described(scene)
    assert aplanat_bpy.ops.scene.aplanat_wire_compositor(source="REFOCUSED") == {"FINISHED"}
    assert described(scene) == before
    for frame in (5, 7, 6):
        scene.frame_set(frame)
        assert np.allclose(render_picture(scene), 0.1 * frame, rtol=1e-6), frame
    scene.frame_set(1)


def test_operators_wire_draw_and_can_be_undone(aplanat_bpy, aplanat_scene):
    bpy, operators = aplanat_bpy, aplanat_bpy.ops
    assert operators.scene.aplanat_wire_compositor() == {"FINISHED"}
    assert node_of(aplanat_scene, "GROUP")
    with pytest.raises(RuntimeError, match="there is no picture"):
        operators.scene.aplanat_wire_compositor(source="REFOCUSED")
    data = aplanat_scene.camera.data
    data.dof.use_dof, data.dof.focus_distance = True, 3.0
    data.dof.aperture_blades, data.dof.aperture_rotation = 5, 0.3
    words = {"size": 48, "field": (0.5, 0.5)}
    assert operators.image.aplanat_bokeh_image(**words) == {"FINISHED"}
    image = bpy.data.images["Bokeh of Camera"]
    behind = np.array(image.pixels[:]).reshape(48, 48, 4)
    assert image.is_float and image.packed_file and behind.max() == 1.0
    assert not behind[0].any() and not behind[:, -1].any() and (behind[24, 24] > 0.9).all()
    assert operators.image.aplanat_bokeh_image(side="FRONT", **words) == {"FINISHED"}
    # The same image, drawn anew: in front of the focus the opening is turned by half a turn.
    assert [i.name for i in bpy.data.images if i.get("aplanat_sprite")] == ["Bokeh of Camera"]
    front = np.array(image.pixels[:]).reshape(48, 48, 4)
    assert np.abs(front - behind[::-1, ::-1]).max() < 0.02 < np.abs(front - behind).max()
    for operator in (operators.scene.aplanat_wire_compositor, operators.image.aplanat_bokeh_image):
        kind = bpy.types.Operator.bl_rna_get_subclass_py(operator.idname())
        assert "UNDO" in kind.bl_options


def test_the_sprite_of_a_real_lens_is_traced(aplanat_bpy, aplanat_scene):
    data = aplanat_scene.camera.data
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 3.0, 2.0
    data.aplanat.lens = "double-gauss-50mm-f2"
    data.aplanat.bokeh.vignetting = "LENS"
    depsgraph = aplanat_bpy.context.evaluated_depsgraph_get()

    def made(field, behind=True):
        light = camera_sprite(depsgraph, aplanat_scene.camera, field, behind, 48)
        assert light.shape == (48, 48) and light.max() == 1.0 and light.min() == 0.0
        assert not light[0].any() and not light[:, 0].any()
        return light

    middle, corner = made((0.0, 0.0)), made((1.0, 1.0))
    # Of revolution on the axis; a cat's eye in the corner, turned with the point.
    assert np.abs(middle - middle[::-1]).max() < 0.05
    assert np.abs(corner - corner[::-1]).mean() > 0.05
    assert np.abs(made((-1.0, 1.0)) - corner[:, ::-1]).mean() < 0.02
    assert np.abs(made((1.0, 1.0), behind=False) - corner).mean() > 0.05


def test_group_nodes_are_added_in_the_compositor_only(aplanat_bpy, aplanat_scene):
    assert not aplanat_bpy.ops.node.aplanat_add_group.poll()
    assert not aplanat_bpy.ops.node.aplanat_add_bokeh_sprite.poll()
    assert node_group(MIX).bl_idname == "CompositorNodeTree"


def test_the_asset_library_has_all_groups_and_is_added_once(aplanat_bpy, empty_scene, tmp_path):
    bpy, before = aplanat_bpy, set(aplanat_bpy.data.node_groups)
    write_asset_library(tmp_path / "library")
    assert set(bpy.data.node_groups) == before
    (blend,) = (tmp_path / "library").glob("*.blend")
    catalogs = (tmp_path / "library" / "blender_assets.cats.txt").read_text()
    with bpy.data.libraries.load(str(blend), assets_only=True) as (there, wanted):
        assert sorted(there.node_groups) == sorted(GROUPS)
        wanted.node_groups = list(there.node_groups)
    for tree in wanted.node_groups:
        assert f"{tree.asset_data.catalog_id}:Compositing/Camera & Lens Effects:" in catalogs
        # An appended group is ours: no second one is made.
        assert is_ours(tree, tree.name) and tree.asset_data.description
        assert node_group(tree.name) == tree
        assert tuple(tree.preview.image_size) == (128, 128)
        assert 0.0 < np.mean(tree.preview.image_pixels_float) < 1.0
    folder = (tmp_path / "library").resolve()
    libraries = bpy.context.preferences.filepaths.asset_libraries
    count = len(libraries)
    assert add_library(folder) and not add_library(folder) and len(libraries) == count + 1
    libraries.remove(known_library(folder))
    # A checkout has none that could be added.
    assert bundled_folder() is None and not bpy.ops.preferences.aplanat_add_asset_library.poll()
