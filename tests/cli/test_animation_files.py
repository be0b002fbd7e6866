"""Files of animations: the same set as Blender's own animation render with Cycles leaves.

The referee is `bpy.ops.render.render(animation=True)` of the same .blend file in a folder of its
own, rendered by Cycles with one sample.
"""

import numpy as np
import pytest

from benchmarks.scenes.small_scene import build_scene
from tests.cli.animation_scenes import (
    add_compositor,
    add_file_output,
    every_second,
    many_nodes,
    multilayer,
    no_compositing,
    nodes_in_groups,
    nodes_only,
    odd_output,
    one_node,
    png_of,
    read_exr,
    two_eyes,
)

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.mark.parametrize(
    "change",
    [
        lambda bpy, scene: None,
        one_node,
        many_nodes,
        nodes_in_groups,
        nodes_only,
        no_compositing,
        every_second,
        multilayer,
        odd_output,
        two_eyes("STEREO_3D"),
        two_eyes("STEREO_3D", "STEREO_3D"),
        two_eyes("MULTIVIEW", "MULTIVIEW", "OPEN_EXR"),
    ],
    ids=[
        *("plain", "one node", "many nodes", "groups", "nodes only", "compositing off"),
        *("frame step", "multilayer", "odd path", "eyes apart", "eyes together", "views in one"),
    ],
)
def test_the_same_set_of_files_as_blenders_animation_render(both, change):
    cycles, ours, answer, folder = both(change)
    assert ours == cycles
    assert {str(folder / path) for path in ours if path.suffix != ".blend"} == set(answer["files"])
    assert answer["warnings"] == []
    assert all(path.stat().st_size > 0 for path in folder.rglob("*") if path.is_file())


def test_a_single_frame_numbers_files_as_blenders_f_does(both):
    _, ours, answer, folder = both(one_node, "--frame", "2")
    assert answer["files"] == [
        str(folder / "frames" / "main_0002.png"),
        str(folder / "files" / "node_0002.exr"),
    ]
    assert {path.name for path in ours} == {"shot.blend", "main_0002.png", "node_0002.exr"}


def test_frame_step_of_the_command_overrules_the_scenes(both):
    *_, answer, folder = both(every_second, "--frames", "1..5", "--frame-step", "3")
    assert [frame["frame"] for frame in answer["frames"]] == [1, 4]
    assert sorted(p.name for p in (folder / "files").iterdir()) == [
        *("node_0001.exr", "node_0004.exr")
    ]


def test_a_node_whose_path_cannot_be_resolved_is_told(aplanat, make_blend, tmp_path):
    def change(bpy, scene):
        tree, layers = add_compositor(bpy, scene)
        add_file_output(tree, layers.outputs["Image"], f"{tmp_path}/", "{nobody}_", "PNG")

    words = ("render", make_blend(change), "-o", tmp_path / "a.png", "--json")
    done = aplanat(*words)
    assert done.code == 0
    (line,) = done.answer["warnings"]
    assert "File Output" in line and "wrote no file" in line
    (tmp_path / "a.png").unlink()
    assert aplanat(*words, "--strict").code == 2
    assert not list(tmp_path.iterdir())


def test_a_node_that_cannot_write_there_is_told_and_the_rest_is_written(
    aplanat, make_blend, tmp_path
):
    (tmp_path / "file").write_text("in the way")

    def change(bpy, scene):
        tree, layers = add_compositor(bpy, scene)
        image = layers.outputs["Image"]
        add_file_output(tree, image, f"{tmp_path}/file/x/", "a_", "PNG")
        add_file_output(tree, image, f"{tmp_path}/there/", "b_", "PNG")

    words = ("render", make_blend(change), "-o", tmp_path / "a.png", "--frame", "1", "--json")
    done = aplanat(*words, "--strict")
    assert done.code == 2 and not (tmp_path / "a.png").exists()
    done = aplanat(*words)
    assert done.code == 0
    (line,) = done.answer["warnings"]
    assert line.startswith("File Output node 'File Output'") and "is no folder" in line
    assert done.answer["files"] == [
        str(tmp_path / "a.png"),
        str(tmp_path / "there" / "b_Image0001.png"),
    ]
    assert (tmp_path / "file").read_text() == "in the way"


def test_nodes_write_what_the_engine_made(aplanat, make_blend, tmp_path):
    def change(bpy, scene):
        # The sockets of Render Layers are the engine's.
        scene.render.engine = "APLANAT"
        layer = scene.view_layers[0]
        layer.use_pass_z = layer.aplanat.use_pass_coc = True
        scene.render.compositor_precision = "FULL"
        tree, layers = add_compositor(bpy, scene)
        node = add_file_output(
            tree, layers.outputs["Image"], f"{tmp_path}/", "node_", items=("Image",)
        )
        node.format.color_depth = "32"
        for kind, name in (("FLOAT", "Depth"), ("FLOAT", "CoC")):
            node.file_output_items.new(kind, name)
            tree.links.new(layers.outputs[name], node.inputs[name])

    done = aplanat("render", make_blend(change), "-o", tmp_path / "own.exr")
    assert done.code == 0, done.err
    (node,) = tmp_path.glob("node_*.exr")
    theirs = {key: value for (_, key), value in read_exr(node)[0].items()}
    own = {key: value for (_, key), value in read_exr(tmp_path / "own.exr")[0].items()}
    for name, channel in (("Depth", "Z"), ("CoC", "X")):
        (found,) = [value for key, value in theirs.items() if key.split(".")[0] == name]
        np.testing.assert_array_equal(found, own[f"ViewLayer.{name}.{channel}"])
    for letter in "RGBA":
        np.testing.assert_array_equal(
            theirs[f"Image.{letter}"], own[f"ViewLayer.Combined.{letter}"]
        )
        np.testing.assert_array_equal(
            own[f"Composite.Combined.{letter}"], theirs[f"Image.{letter}"]
        )


def test_a_border_without_crop_is_written_as_blender_writes_it(aplanat, aplanat_bpy, tmp_path):
    files = {}
    for engine in ("CYCLES", "APLANAT"):
        bpy = aplanat_bpy
        scene = build_scene(bpy)
        render, layer = scene.render, scene.view_layers[0]
        layer.use_pass_z = layer.use_pass_vector = layer.use_pass_normal = True
        render.use_border = True
        render.border_min_x, render.border_max_x = 0.25, 0.75
        render.border_min_y, render.border_max_y = 0.0, 0.5
        render.pixel_aspect_x, render.pixel_aspect_y = 3.0, 2.0
        render.engine, scene.cycles.samples = engine, 1
        scene.cycles.use_denoising = False
        path = tmp_path / f"{engine}.exr"
        if engine == "CYCLES":
            settings = render.image_settings
            settings.media_type = "MULTI_LAYER_IMAGE"
            settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
            render.filepath = str(path)
            bpy.ops.render.render(write_still=True)
        else:
            blend = tmp_path / "shot.blend"
            bpy.ops.wm.save_as_mainfile(filepath=str(blend), copy=True)
            assert aplanat("render", blend, "-o", path).code == 0
        files[engine] = read_exr(path)
    (ours, our_headers), (theirs, their_headers) = files["APLANAT"], files["CYCLES"]
    outside = np.ones((32, 48), bool)
    outside[16:, 12:36] = False
    values = {"Combined": 0.0, "Depth": 1e10, "Vector": 1e4, "Normal": 0.0}
    for (part, name), picture in ours.items():
        expected = np.float32(values[part.partition(".")[2]])
        np.testing.assert_array_equal(picture[outside], expected)
        np.testing.assert_array_equal(picture[outside], theirs[part, name][outside])
    for part, header in our_headers.items():
        for key in ("pixelAspectRatio", "dataWindow", "displayWindow", "colorInteropID"):
            np.testing.assert_equal(header[key], their_headers[part][key])
        assert header["pixelAspectRatio"] == 1.5


@pytest.mark.parametrize("depth", ["16", "32"])
def test_cryptomatte_is_data_at_any_depth(aplanat, make_blend, tmp_path, depth):
    def change(_bpy, scene):
        scene.view_layers[0].use_pass_cryptomatte_object = True
        settings = scene.render.image_settings
        settings.media_type = "MULTI_LAYER_IMAGE"
        settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", depth
        scene.render.filepath = f"{tmp_path}/scene_"

    blend = make_blend(change)
    assert aplanat("render", blend).code == 0
    assert aplanat("render", blend, "-o", tmp_path / "own.exr").code == 0
    (scene_file,) = tmp_path.glob("scene_*.exr")
    part = "ViewLayer.CryptoObject00"
    (ours, headers), (theirs, _) = read_exr(tmp_path / "own.exr"), read_exr(scene_file)
    assert headers[part]["colorInteropID"] == "data"
    assert theirs["ViewLayer.Combined", "ViewLayer.Combined.R"].dtype == f"float{depth}"
    for letter in "rgba":
        key = (part, f"{part}.{letter}")
        assert ours[key].dtype == theirs[key].dtype == np.float32
        # Bits: an id may be any float.
        np.testing.assert_array_equal(ours[key].view(np.uint32), theirs[key].view(np.uint32))
    assert np.abs(ours[part, f"{part}.r"]).max() > 0.0


def test_blenders_cryptomatte_node_picks_an_object(aplanat, make_blend, tmp_path):
    def change(bpy, scene):
        scene.view_layers[0].use_pass_cryptomatte_object = True
        scene.render.compositor_precision = "FULL"
        scene.camera.data.dof.use_dof = False
        tree, _ = add_compositor(bpy, scene)
        node = tree.nodes.new("CompositorNodeCryptomatteV2")
        node.source, node.scene, node.layer_name = "RENDER", scene, "ViewLayer.CryptoObject"
        node.matte_id = "Near"
        file = tree.nodes.new("CompositorNodeOutputFile")
        file.directory, file.file_name = f"{tmp_path}/", "matte_"
        file.format.color_depth = "32"
        file.file_output_items.new("FLOAT", "Matte")
        tree.links.new(node.outputs["Matte"], file.inputs[0])

    assert aplanat("render", make_blend(change), "-o", tmp_path / "a.png").code == 0
    (path,) = tmp_path.glob("matte_*.exr")
    (matte,) = read_exr(path)[0].values()
    # The square of side 1 at 4 m, 50 mm on a sensor of 36: 16.7 of 48 pixels.
    assert matte[16, 24] == 1.0 and matte[2, 2] == 0.0
    assert matte.sum() == pytest.approx((50 / 36 * 48 / 4) ** 2, rel=0.05)


def test_views_of_named_files_are_apart_or_together_as_the_scene_says(
    aplanat, make_blend, tmp_path
):
    words = ("--samples", "2", "--json")
    for stereo, pngs in (
        ("INDIVIDUAL", {"a_L.png": (32, 48), "a_R.png": (32, 48)}),
        ("STEREO_3D", {"a.png": (32, 96)}),
    ):
        blend = make_blend(two_eyes("STEREO_3D", stereo))
        folder = tmp_path / stereo
        folder.mkdir()
        done = aplanat("render", blend, "-o", folder / "a.exr", "-o", folder / "a.png", *words)
        assert done.code == 0, done.err
        assert png_of(folder) == pngs
        exrs = sorted(path.name for path in folder.glob("*.exr"))
        assert exrs == (["a_L.exr", "a_R.exr"] if stereo == "INDIVIDUAL" else ["a.exr"])
        told = {path for path in done.answer["files"] if "node_" not in path}
        assert told == {str(folder / name) for name in [*pngs, *exrs]}
    channels, headers = read_exr(tmp_path / "STEREO_3D" / "a.exr")
    assert {name: header["view"] for name, header in headers.items()} == {
        f"{part}.Combined-{view}": view
        for part in ("Composite", "ViewLayer")
        for view in ("left", "right")
    }
    left, right = (
        channels[f"ViewLayer.Combined-{view}", "ViewLayer.Combined.B"] for view in ("left", "right")
    )
    assert left.any() and right.any() and (left != right).any()
    for view in ("left", "right"):
        np.testing.assert_allclose(
            channels[f"Composite.Combined-{view}", "Composite.Combined.B"],
            channels[f"ViewLayer.Combined-{view}", "ViewLayer.Combined.B"],
            # The compositor works in half precision by default.
            atol=1e-3,
        )


def test_the_same_command_twice_writes_the_same_bytes(aplanat, small_blend, tmp_path):
    names = ("a.exr", "a.png")
    outputs = [word for name in names for word in ("-o", tmp_path / name)]
    written = []
    for _ in range(2):
        assert aplanat("render", small_blend, *outputs).code == 0
        written.append([(tmp_path / name).read_bytes() for name in names])
    assert written[0] == written[1]


def test_grease_pencil_that_blender_draws_is_in_the_exr(aplanat, make_blend, tmp_path):
    def change(bpy, scene):
        bpy.ops.object.grease_pencil_add(type="STROKE", location=(0, 0, -4))
        bpy.context.object.rotation_euler = (np.pi / 2, 0, 0)

    path = tmp_path / "a.exr"
    done = aplanat("render", make_blend(change), "-o", path, "--json")
    assert done.answer["warnings"] == []
    channels, _ = read_exr(path)
    # The stroke is black and nearly covers a pixel; the planes behind it have 0.1 and more.
    assert channels["ViewLayer.Combined", "ViewLayer.Combined.B"].min() < 0.05


def test_files_of_a_frame_are_forgotten_with_the_folder_that_held_them(
    aplanat, small_blend, tmp_path, monkeypatch
):
    import tempfile

    held = tmp_path / "held"
    held.mkdir()
    with monkeypatch.context() as patch:
        patch.setattr(tempfile, "tempdir", str(held))
        assert aplanat("render", small_blend, "-o", tmp_path / "a.png").code == 0
    assert not list(held.glob("aplanat-*"))
