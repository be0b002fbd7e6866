"""`aplanat render` in this process: its files and its answers."""

import json
import os
from pathlib import Path

import imageio.v3 as iio
import numpy as np
import OpenEXR
import pytest

from addon.cli.render import render_command
from addon.cli.render.scene_setup import apply_frame
from addon.files.frame_path import frame_path
from tests.lens_io.importers.foreign_texts import ZEMAX


def exr_channels(path):
    """Return every channel of every part, by name, top row first."""
    channels = {}
    with OpenEXR.File(str(path), separate_channels=True) as file:
        for part in file.parts:
            channels |= {name: np.array(c.pixels) for name, c in part.channels.items()}
    return channels


def exr_header(path):
    with OpenEXR.File(str(path)) as file:
        return dict(file.parts[0].header)


def combined(path, layer="ViewLayer"):
    channels = exr_channels(path)
    return np.stack([channels[f"{layer}.Combined.{letter}"] for letter in "RGBA"], axis=-1)


def srgb(linear):
    x = np.clip(linear, 0.0, 1.0)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def test_two_files_of_one_render_show_the_same_picture(aplanat, small_blend, tmp_path):
    exr, png = tmp_path / "a.exr", tmp_path / "a.png"
    done = aplanat("render", small_blend, "-o", exr, "-o", png)
    assert done.code == 0, done
    picture = combined(exr)
    assert picture.shape == (32, 48, 4)
    shown = iio.imread(png)
    assert shown.shape == (32, 48, 3)
    # 8 bits and Blender's dithering of one step.
    np.testing.assert_allclose(shown / 255, srgb(picture[..., :3]), atol=2.0 / 255)
    assert sorted(os.listdir(tmp_path)) == ["a.exr", "a.png"]


def test_emission_keeps_its_value(aplanat, small_blend, tmp_path):
    assert aplanat("render", small_blend, "-o", tmp_path / "a.exr").code == 0
    middle = combined(tmp_path / "a.exr")[16, 24]
    np.testing.assert_allclose(middle, (0.9, 0.4, 0.1, 1.0), atol=1e-6)


def test_exr_is_float_and_named_as_blenders(aplanat, make_blend, tmp_path):
    def ask_for_passes(_bpy, scene):
        layer = scene.view_layers[0]
        layer.use_pass_z = layer.use_pass_normal = True
        layer.use_pass_cryptomatte_object = True
        layer.aplanat.use_pass_coc = True
        scene.view_layers.new("Second")

    path = tmp_path / "a.exr"
    assert aplanat("render", make_blend(ask_for_passes), "-o", path).code == 0
    channels = exr_channels(path)
    assert all(c.dtype == np.float32 for c in channels.values())
    for name in (
        *("ViewLayer.Combined.R", "ViewLayer.Depth.Z", "ViewLayer.Normal.X", "ViewLayer.CoC.X"),
        *("ViewLayer.CryptoObject00.r", "Second.Combined.A"),
    ):
        assert name in channels, sorted(channels)
    header = exr_header(path)
    assert "BlenderMultiChannel" in header
    manifests = [v for k, v in header.items() if k.endswith("/manifest")]
    assert any("Near" in json.loads(text) for text in manifests)


def test_blender_reads_the_exr_as_layers(aplanat, aplanat_bpy, small_blend, tmp_path):
    path = tmp_path / "a.exr"
    assert aplanat("render", small_blend, "-o", path).code == 0
    image = aplanat_bpy.data.images.load(str(path))
    assert image.source == "FILE"
    with pytest.raises(RuntimeError):
        image.update()  # makes Blender look into the file, which has no single picture
    assert image.type == "MULTILAYER"


def test_png_has_alpha_where_the_film_is_transparent(aplanat, make_blend, tmp_path):
    def clear_film(bpy, scene):
        scene.render.film_transparent = True
        bpy.data.objects.remove(scene.objects["Far"])

    path = tmp_path / "a.png"
    assert aplanat("render", make_blend(clear_film), "-o", path, "--no-bokeh").code == 0
    picture = iio.imread(path)
    assert picture.shape == (32, 48, 4)
    assert picture[16, 24, 3] == 255 and picture[0, 0, 3] == 0


def invert(bpy, scene):
    """Give the scene a compositor that turns red into 1 - red."""
    tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    layers = tree.nodes.new("CompositorNodeRLayers")
    node = tree.nodes.new("CompositorNodeInvert")
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(layers.outputs["Image"], node.inputs["Color"])
    tree.links.new(node.outputs["Color"], output.inputs["Image"])
    scene.compositing_node_group = tree


def test_compositor_is_in_the_png_and_beside_the_layers(aplanat, make_blend, tmp_path):
    exr, png = tmp_path / "a.exr", tmp_path / "a.png"
    done = aplanat("render", make_blend(invert), "-o", exr, "-o", png)
    assert done.code == 0, done
    plain, composite = combined(exr), combined(exr, "Composite")
    np.testing.assert_allclose(plain[16, 24, :3], (0.9, 0.4, 0.1), atol=1e-6)
    # The compositor works in half precision by default.
    np.testing.assert_allclose(composite[16, 24, :3], (0.1, 0.6, 0.9), atol=2e-3)
    shown = iio.imread(png)[16, 24, :3] / 255
    np.testing.assert_allclose(shown, srgb(composite[16, 24, :3]), atol=2.0 / 255)


def test_border_without_crop_stays_in_its_place(aplanat, make_blend, tmp_path):
    def border(_bpy, scene):
        render = scene.render
        render.use_border = True
        render.border_min_x, render.border_max_x = 0.25, 0.75
        render.border_min_y, render.border_max_y = 0.0, 0.5

    path = tmp_path / "a.exr"
    assert aplanat("render", make_blend(border), "-o", path).code == 0
    picture = combined(path)
    assert picture.shape == (32, 48, 4)
    # The border's y counts from the bottom; rows of the file from the top.
    assert (picture[:16] == 0).all() and (picture[:, :12] == 0).all()
    assert (picture[16:, 12:36, 3] == 1).all()


def test_frame_numbers_fill_the_pattern(aplanat, small_blend, tmp_path):
    done = aplanat("render", small_blend, "-o", tmp_path / "f_###.png", "--frames", "-1..1")
    assert done.code == 0, done
    assert sorted(os.listdir(tmp_path)) == ["f_-001.png", "f_000.png", "f_001.png"]


@pytest.mark.parametrize(
    ("name", "frame", "expected"),
    [
        ("a_####.png", 7, "a_0007.png"),
        ("a_##_###.png", 7, "a_##_007.png"),
        ("a_#.png", 1234, "a_1234.png"),
        ("a.png", 3, "a.png"),
    ],
)
def test_last_run_of_hashes_becomes_the_number(name, frame, expected):
    assert frame_path(Path(name), frame) == Path(expected)


def test_without_output_the_scene_decides(aplanat, make_blend, tmp_path):
    def set_output(_bpy, scene):
        scene.render.filepath = str(tmp_path / "new" / "shot_")
        scene.render.image_settings.media_type = "IMAGE"
        scene.render.image_settings.file_format = "TIFF"

    done = aplanat("render", make_blend(set_output), "--frames", "3..4")
    assert done.code == 0, done
    assert sorted(os.listdir(tmp_path / "new")) == ["shot_0003.tif", "shot_0004.tif"]


def test_existing_frames_stay_where_the_scene_says_so(aplanat, make_blend, tmp_path):
    def set_output(_bpy, scene):
        scene.render.filepath = str(tmp_path / "shot_")
        scene.render.use_overwrite = False

    (tmp_path / "shot_0003.png").write_text("mine")
    done = aplanat("render", make_blend(set_output), "--frames", "3..4", "--json")
    assert done.code == 0, done
    assert (tmp_path / "shot_0003.png").read_text() == "mine"
    assert [frame["frame"] for frame in done.answer["frames"]] == [4]
    done = aplanat("render", make_blend(set_output), "--frames", "3..4", "--json")
    assert (done.code, done.answer["frames"], done.answer["files"]) == (0, [], [])


def test_sequencer_is_left_out_and_told(aplanat, make_blend, tmp_path):
    def add_strip(_bpy, scene):
        editor = scene.sequence_editor_create()
        editor.strips.new_effect("Color", "COLOR", channel=1, frame_start=1, length=10)
        scene.render.use_sequencer = True

    path = tmp_path / "a.exr"
    done = aplanat("render", make_blend(add_strip), "-o", path, "--json")
    assert done.code == 0, done
    assert any("sequencer" in line for line in done.answer["warnings"])
    np.testing.assert_allclose(combined(path)[16, 24, :3], (0.9, 0.4, 0.1), atol=1e-6)


def test_markers_choose_the_camera_and_the_option_overrules_them(aplanat, make_blend, tmp_path):
    def bind(_bpy, scene):
        scene.timeline_markers.new("first", frame=1).camera = scene.objects["Second"]
        scene.timeline_markers.new("then", frame=2).camera = scene.objects["Camera"]
        scene.camera = None

    words = ("render", make_blend(bind), "-o", tmp_path / "a_#.png", "--frames", "1..2", "--json")
    done = aplanat(*words, "--fstop", "3")
    assert done.code == 0, done
    used = [frame["settings"] for frame in done.answer["frames"]]
    assert [(one["camera"], one["fstop"]) for one in used] == [("Second", 3), ("Camera", 3)]
    used = [f["settings"] for f in aplanat(*words, "--camera", "Camera").answer["frames"]]
    assert [one["camera"] for one in used] == ["Camera", "Camera"]


def test_options_are_in_force_and_told(aplanat, small_blend, tmp_path):
    stats = tmp_path / "s.json"
    done = aplanat(
        *("render", small_blend, "-o", tmp_path / "a.png", "--resolution", "20x10"),
        *("--samples", "3", "--seed", "5", "--filter", "box", "--filter-size", "1.25"),
        *("--camera", "Second", "--fstop", "2", "--focus", "Far", "--frame", "9"),
        *("--method", "reference", "--no-bokeh", "--no-chromatic", "--stats", stats, "--json"),
        *("--distortion", "-0.1", "--breathing", "--exposure", "lens"),
    )
    assert done.code == 0, done
    assert iio.imread(tmp_path / "a.png").shape == (10, 20, 3)
    told = json.loads(stats.read_text())
    assert told == done.answer
    settings = told["settings"]
    assert settings["resolution"] == [20, 10]
    assert (settings["samples"], settings["seed"]) == (3, 5)
    assert (settings["filter"], settings["filter_size_px"]) == ("box", 1.25)
    assert (settings["camera"], settings["fstop"], settings["focus_object"]) == ("Second", 2, "Far")
    assert settings["no_bokeh"] and settings["no_chromatic"]
    assert settings["chromatic"] is None
    assert settings["breathing"] > 1.0
    # The camera has a thin lens.
    assert settings["lens_exposure"] is None
    assert settings["distortion"] == {"source": "division", "terms": [pytest.approx(-0.1)]}
    assert told["frames"][0]["frame"] == 9


def test_statistics_count_the_work(aplanat, small_blend, tmp_path):
    done = aplanat("render", small_blend, "-o", tmp_path / "a.png", "--json", "--samples", "6")
    told = done.answer
    assert told["lens_samples"] == 6
    # Two planes of two triangles.
    assert told["triangles_submitted"] == told["triangles_full_detail"] == 6 * 4
    assert told["draw_calls"] >= 6
    assert told["sprites_drawn"] == told["sprites_copied"] == told["highlights_found"] == 0
    assert set(told["highlights_culled"]) == {"size", "occlusion", "cone"}
    assert {"extract", "upload", "plan", "draw", "read_back", "write", "total"} <= set(
        told["seconds"]
    )
    assert sum(v for k, v in told["seconds"].items() if k != "total") <= told["seconds"]["total"]
    assert told["peak_memory_bytes"] > 1e7
    assert told["gpu"]
    assert told["files"] == [str(tmp_path / "a.png")]


def test_same_command_twice_gives_the_same_bits(aplanat, small_blend, tmp_path):
    for name in ("a.exr", "b.exr"):
        assert aplanat("render", small_blend, "-o", tmp_path / name).code == 0
    np.testing.assert_array_equal(combined(tmp_path / "a.exr"), combined(tmp_path / "b.exr"))


def test_animated_focus_yields_to_the_option(aplanat, make_blend, tmp_path):
    def animate(_bpy, scene):
        dof = scene.camera.data.dof
        for frame, distance in ((1, 2.0), (10, 6.0)):
            dof.focus_distance = distance
            dof.keyframe_insert("focus_distance", frame=frame)

    done = aplanat(
        *("render", make_blend(animate), "-o", tmp_path / "a.png", "--frame", "5"),
        *("--focus", "3.5", "--json"),
    )
    assert done.code == 0, done
    assert done.answer["settings"]["focus_distance_m"] == 3.5


def test_file_is_never_changed(aplanat, small_blend, tmp_path):
    before = small_blend.read_bytes(), small_blend.stat().st_mtime_ns
    assert aplanat("render", small_blend, "-o", tmp_path / "a.png", "--fstop", "9").code == 0
    assert (small_blend.read_bytes(), small_blend.stat().st_mtime_ns) == before


def test_missing_image_is_magenta_and_reported(aplanat, make_blend, tmp_path):
    def lose_image(bpy, scene):
        material = scene.objects["Near"].data.materials[0]
        tree = material.node_tree
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = bpy.data.images.new("Lost", 4, 4)
        node.image.source = "FILE"
        node.image.filepath = str(tmp_path / "not-there.png")
        emission = next(n for n in tree.nodes if n.type == "EMISSION")
        tree.links.new(node.outputs["Color"], emission.inputs["Color"])

    done = aplanat("render", make_blend(lose_image), "-o", tmp_path / "a.exr", "--json")
    assert done.code == 0, done
    assert any("Lost" in line or "not-there" in line for line in done.answer["warnings"])
    assert "warning" in done.err
    np.testing.assert_allclose(combined(tmp_path / "a.exr")[16, 24, :3], (1.0, 0.0, 1.0), atol=1e-3)


def test_lens_of_the_library_is_used_and_told(aplanat, small_blend, tmp_path):
    words = ("render", small_blend, "-o", tmp_path / "a.png", "--samples", "2", "--json")
    assert aplanat(*words).answer["settings"]["lens"] is None
    done = aplanat(*words, "--lens", "tessar-50mm-f2.8", "--fstop", "0.5")
    assert done.code == 0, done.err
    settings = done.answer["settings"]
    assert settings["lens"] == "tessar-50mm-f2.8"
    # A lens opens no wider than it can, and leaves the framing alone.
    assert settings["fstop"] == 2.8
    (line,) = done.answer["warnings"]
    assert "asks for f/0.5" in line and "no wider than f/2.8" in line
    assert settings["focal_length_mm"] == 50.0


def test_lens_may_be_a_file(aplanat, small_blend, tmp_path):
    shipped = Path(__file__).resolve().parents[2] / "lens_profiles/zoom-36-69mm-f3.5.toml"
    own = tmp_path / "mine.toml"
    own.write_bytes(shipped.read_bytes())
    done = aplanat(
        *("render", small_blend, "-o", tmp_path / "a.png", "--samples", "2", "--json"),
        *("--lens", own),
    )
    assert done.code == 0, done.err
    assert done.answer["settings"]["lens"] == "mine"
    assert done.answer["settings"]["zoom_position"] == "36 mm"


def test_a_lens_file_that_is_edited_meanwhile_stays_what_it_was(
    aplanat, small_blend, tmp_path, monkeypatch
):
    profiles = Path(__file__).resolve().parents[2] / "lens_profiles"
    own = tmp_path / "edited-while-rendered.toml"
    own.write_bytes((profiles / "tessar-50mm-f2.8.toml").read_bytes())

    def apply_then_edit(*arguments):
        apply_frame(*arguments)
        own.write_bytes((profiles / "petzval-51mm-f1.4.toml").read_bytes())

    monkeypatch.setattr(render_command, "apply_frame", apply_then_edit)
    words = ("render", small_blend, "-o", tmp_path / "a_####.exr", "--frames", "1..2")
    done = aplanat(*words, "--samples", "2", "--fstop", "1.4", "--lens", own, "--json")
    assert done.code == 0, done.err
    # Each lens has its own largest opening, of which is told.
    assert {frame["settings"]["fstop"] for frame in done.answer["frames"]} == {2.8}
    first, second = (combined(tmp_path / f"a_000{number}.exr") for number in (1, 2))
    np.testing.assert_array_equal(first, second)


def test_lens_may_be_a_file_in_a_foreign_format(aplanat, small_blend, tmp_path):
    own = tmp_path / "singlet.zmx"
    own.write_text(ZEMAX, encoding="utf-8")
    done = aplanat(
        *("render", small_blend, "-o", tmp_path / "a.png", "--samples", "2", "--json"),
        *("--lens", own),
    )
    assert done.code == 0, done.err
    assert done.answer["settings"]["lens"] == "singlet"
