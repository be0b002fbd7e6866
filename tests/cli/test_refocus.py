"""`aplanat refocus`: captured files to pictures, and what it refuses."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

from addon.cli.refocus.lens_source import LensSource
from addon.layers.layer_file import save_layers
from tests.engine.test_refocus import stack
from tests.layers.test_layer_file import rewritten

__all__ = ["stack"]


@pytest.fixture
def captured(stack, tmp_path):
    for frame in (1, 2, 5):
        save_layers(tmp_path / f"layers_{frame:04d}.exr", stack)
    return tmp_path / "layers_####.exr"


def test_every_captured_frame_becomes_a_picture(aplanat, captured, tmp_path):
    done = aplanat(
        *("refocus", captured, "-o", tmp_path / "out_####.exr", "--focus", "2", "--samples", "16"),
        "--json",
    )
    assert done.code == 0, done.err
    assert [told["frame"] for told in done.answer["frames"]] == [1, 2, 5]
    pictures = []
    for file in done.answer["files"]:
        with OpenEXR.File(file) as found:
            pictures.append(np.array(found.channels()["RGBA"].pixels))
    assert pictures[0].shape == (32, 48, 4)
    assert pictures[0].tobytes() == pictures[2].tobytes()
    assert done.answer["frames"][0]["focus_distance_m"] == 2.0


def test_a_png_and_chosen_frames(aplanat, captured, tmp_path):
    done = aplanat(
        *("refocus", captured, "-o", tmp_path / "out_##.png", "--frames", "1..2"),
        *("--samples", "4", "--fstop", "2", "--blades", "5"),
    )
    assert done.code == 0, done.err
    assert sorted(p.name for p in tmp_path.glob("out_*")) == ["out_01.png", "out_02.png"]


@pytest.fixture(scope="module")
def shot(aplanat_bpy, tmp_path_factory):
    """A scene whose focus moves, with a real lens, fringes, and an iris of five blades."""
    bpy = aplanat_bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    data = camera.data
    for frame, distance in ((1, 2.0), (5, 6.0)):
        data.dof.focus_distance = distance
        data.dof.keyframe_insert("focus_distance", frame=frame)
    for curve in data.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    data.dof.aperture_fstop, data.dof.aperture_blades = 1.4, 5
    data.aplanat.lens = "double-gauss-50mm-f2"
    data.aplanat.chromatic.use = True
    path = tmp_path_factory.mktemp("shot") / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


def test_a_scene_says_frame_by_frame_what_the_lens_is(aplanat, captured, shot, tmp_path):
    words = ("refocus", captured, "-o", tmp_path / "out_####.exr", "--samples", "4", "--json")
    done = aplanat(*words, "--scene", shot, "--camera", "Camera")
    assert done.code == 0, done.err
    frames = done.answer["frames"]
    assert [told["focus_distance_m"] for told in frames] == [2.0, 3.0, 6.0]
    assert {(t["lens"], t["bokeh"], t["chromatic"]) for t in frames} == {
        ("double-gauss-50mm-f2", True, True)
    }
    # No wider than the lens opens.
    assert frames[0]["fstop"] == pytest.approx(2.0, rel=0.05)
    changed = ("--focus", "4", "--fstop", "8", "--no-bokeh", "--no-chromatic", "--frames", "5..5")
    done = aplanat(*words, "--scene", shot, *changed)
    assert done.code == 0, done.err
    (told,) = done.answer["frames"]
    assert (told["focus_distance_m"], told["fstop"]) == (4.0, 8.0)
    assert (told["bokeh"], told["chromatic"]) == (False, False)


def test_without_a_scene_the_lens_is_the_captured_one(aplanat, aplanat_bpy, stack, tmp_path):
    from addon.scene.camera.lens_record import record_lens

    data = aplanat_bpy.data.cameras.new("Camera")
    data.aplanat.lens, data.aplanat.bokeh.threshold = "double-gauss-50mm-f2", 7.0
    data.aplanat.chromatic.use, data.aplanat.chromatic.axial = True, 2.5
    camera = replace(stack.camera, lens_settings=record_lens(data))
    save_layers(tmp_path / "a.exr", replace(stack, camera=camera))
    words = ("refocus", tmp_path / "a.exr", "-o", tmp_path / "b.exr", "--samples", "4", "--json")
    blocks = len(aplanat_bpy.data.cameras), len(aplanat_bpy.data.node_groups)
    done = aplanat(*words)
    assert done.code == 0, done.err
    (told,) = done.answer["frames"]
    assert (told["lens"], told["bokeh"], told["chromatic"]) == ("double-gauss-50mm-f2", True, True)
    # With all digits, though Blender's own properties have fewer.
    assert told["focus_distance_m"] == stack.camera.focus_distance
    assert blocks == (len(aplanat_bpy.data.cameras), len(aplanat_bpy.data.node_groups))
    assert aplanat(*words, "--lens", "petzval-51mm-f1.4").answer["frames"][0]["lens"] == (
        "petzval-51mm-f1.4"
    )


def test_the_captured_lens_is_the_one_that_was_recorded_whatever_the_library_has(
    aplanat, aplanat_bpy, stack, tmp_path
):
    from addon.engine.shared_resources import shelf
    from addon.lens_io.recorded_lens import text_of
    from addon.scene.camera.lens_record import record_lens

    data = aplanat_bpy.data.cameras.new("Camera")
    data.aplanat.lens = "tessar-50mm-f2.8"
    told = record_lens(data)
    other = text_of(shelf(), "petzval-51mm-f1.4")
    words = ("refocus", tmp_path / "a.exr", "-o", tmp_path / "b.exr", "--samples", "1", "--json")
    # On a machine without it, and on one where its name is another lens'.
    for lens, text, warned in (
        ("tessar-50mm-f2.8", told["lens_file"], 0),
        ("of-another-machine", other, 0),
        ("tessar-50mm-f2.8", other, 1),
        ("tessar-50mm-f2.8", "no lens", 1),
    ):
        settings = {**told, "lens": lens, "lens_file": text}
        camera = replace(stack.camera, lens_settings=settings)
        save_layers(tmp_path / "a.exr", replace(stack, camera=camera))
        done = aplanat(*words)
        assert done.code == 0, done.err
        lines = [line for line in done.answer["warnings"] if "recorded" in line]
        assert len(lines) == warned, lines
        (frame,) = done.answer["frames"]
        # As far as the lens opens.
        assert frame["lens"] == lens
        wide = 1.4 if text == other else 2.8
        assert frame["fstop"] == pytest.approx(max(wide, stack.camera.f_stop), rel=0.05)


def test_a_lens_file_that_is_edited_meanwhile_stays_what_it_was(
    aplanat, captured, tmp_path, monkeypatch
):
    profiles = Path(__file__).resolve().parents[2] / "lens_profiles"
    own = tmp_path / "edited.toml"
    own.write_bytes((profiles / "tessar-50mm-f2.8.toml").read_bytes())
    read = LensSource.settings

    def read_then_edit(*arguments):
        found = read(*arguments)
        own.write_bytes((profiles / "petzval-51mm-f1.4.toml").read_bytes())
        return found

    monkeypatch.setattr(LensSource, "settings", read_then_edit)
    words = ("refocus", captured, "-o", tmp_path / "out_####.exr", "--samples", "4", "--json")
    done = aplanat(*words, "--lens", own, "--fstop", "1")
    assert done.code == 0, done.err
    assert len({told["fstop"] for told in done.answer["frames"]}) == 1
    assert {told["lens"] for told in done.answer["frames"]} == {"edited"}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["none_####.exr", "-o", "x_####.exr"], "whatever its number"),
        (["none.exr", "-o", "x.exr"], "does not exist"),
        (["layers_####.exr", "-o", "x.exr"], "need ####"),
        (["layers_####.exr", "-o", "x_####.exr", "--frames", "1..4"], "layers_0003.exr"),
        (["layers_0001.exr", "-o", "x.exr", "--frames", "1..4"], "has no ####"),
        (["layers_####.exr", "-o", "layers_####.exr"], "is a captured file"),
        (["layers_0001.exr", "-o", "linked.exr"], "is a captured file"),
        (["layers_0001.exr", "-o", "x.exr", "--stats", "layers_0001.exr"], "is a captured file"),
        (["layers_0001.exr", "-o", "x.exr", "--blades", "2"], "0 (round) or 3"),
        (["layers_0001.exr", "-o", "x.exr", "--focus", "0"], "greater than 0"),
        (["foreign.exr", "-o", "x.exr"], "foreign.exr"),
        (["foreign.exr", "-o", "x.exr", "--depth-range", "3,1"], "NEAR"),
        (["broken.exr", "-o", "x.exr"], "broken.exr"),
        (["layers_0001.exr", "-o", "x.exr", "--lens", "no-such-lens"], "no-such-lens"),
        (["layers_0001.exr", "-o", "x.exr", "--camera", "Camera"], "--scene"),
        (["layers_0001.exr", "-o", "x.exr", "--scene", "none.blend"], "none.blend"),
        (["layers_0001.exr", "-o", "x.exr", "--scene", "broken.exr"], ".blend"),
        (["layers_0001.exr", "-o", "x.exr", "--scene", "shot.blend", "--camera", "A"], "'Camera'"),
    ],
)
def test_what_cannot_be_is_one_line(aplanat, captured, shot, tmp_path, words, told):
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    pixels = np.zeros((4, 4, 4), np.float32)
    OpenEXR.File(header, {"RGBA": pixels}).write(str(tmp_path / "foreign.exr"))
    whole = (tmp_path / "layers_0001.exr").read_bytes()
    (tmp_path / "broken.exr").write_bytes(whole[: len(whole) // 2])
    words = [tmp_path / word if word.endswith((".exr", ".blend")) else word for word in words]
    words = [shot if word == tmp_path / "shot.blend" else word for word in words]
    (tmp_path / "linked.exr").symlink_to(tmp_path / "layers_0001.exr")
    before = set(tmp_path.iterdir())
    done = aplanat("refocus", *words)
    assert done.code == 2, done
    assert (tmp_path / "layers_0001.exr").read_bytes() == whole
    assert told in done.err and done.err.count("\n") == 1, done.err
    assert before == set(tmp_path.iterdir())


def test_a_picture_with_a_depth_pass_is_one_layer(aplanat, tmp_path):
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    pixels = np.full((24, 32, 4), 0.5, np.float32)
    depth = np.full((24, 32), 4.0, np.float32)
    OpenEXR.File(header, {"RGBA": pixels, "Depth.Z": depth}).write(str(tmp_path / "a.exr"))
    words = ("refocus", tmp_path / "a.exr", "-o", tmp_path / "b.exr", "--samples", "4")
    done = aplanat(*words, "--json")
    assert done.code == 0, done.err
    assert any("one layer does not know" in line for line in done.answer["warnings"])
    with OpenEXR.File(str(tmp_path / "b.exr")) as found:
        assert np.allclose(found.channels()["RGBA"].pixels[..., :3], 0.5, atol=2e-3)
    assert aplanat(*words, "--strict").code == 2


def test_an_opaque_picture_has_no_holes_where_near_things_are_blurred(aplanat, tmp_path):
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    pixels = np.full((54, 96, 4), (0.2, 0.4, 0.1, 1.0), np.float32)
    depth = np.full((54, 96), 12.0, np.float32)
    # A post, whose blur is wider than itself.
    pixels[:, 44:52, :3], depth[:, 44:52] = (0.6, 0.1, 0.1), 2.0
    OpenEXR.File(header, {"RGBA": pixels, "Depth.Z": depth}).write(str(tmp_path / "a.exr"))
    words = ("--samples", "32", "--focus", "12", "--fstop", "0.2", "--focal-length", "45")
    done = aplanat("refocus", tmp_path / "a.exr", "-o", tmp_path / "b.exr", *words)
    assert done.code == 0, done.err
    with OpenEXR.File(str(tmp_path / "b.exr")) as found:
        picture = np.array(found.channels()["RGBA"].pixels)
    assert picture[..., 3] == pytest.approx(1.0, abs=1e-3)
    # Between both colours everywhere: nothing is darker, and far from the post nothing changes.
    low, high = np.array([0.2, 0.1, 0.1]), np.array([0.6, 0.4, 0.1])
    assert (picture[..., :3] > low - 2e-3).all() and (picture[..., :3] < high + 2e-3).all()
    assert picture[:, :8, :3] == pytest.approx(pixels[:, :8, :3], abs=2e-3)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda number, _h, _c: number != 1, "lacks layer 1"),
        (lambda _n, _h, channels: channels.pop("Z") is not None, "lacks channel 'Z'"),
        (lambda _n, _h, channels: channels["Z"].fill(np.nan), "no numbers"),
        (lambda number, header, _c: header.update(stack="{") if number == 0 else None, "damaged"),
    ],
    ids=["layer", "channel", "NaN", "header"],
)
def test_a_damaged_frame_is_one_line_with_its_number(aplanat, captured, tmp_path, change, told):
    rewritten(tmp_path / "layers_0002.exr", change)
    done = aplanat("refocus", captured, "-o", tmp_path / "out_####.exr", "--samples", "1")
    assert done.code == 2, done
    line = done.err.splitlines()[-1]
    assert line.startswith("aplanat: ") and told in line and "layers_0002.exr" in line, done.err
    # What was finished before stays, whole; nothing half-written is beside it.
    assert [path.name for path in tmp_path.glob("out_*")] == ["out_0001.exr"]
    assert not list(tmp_path.glob(".*"))


def test_foreign_depths_that_are_no_numbers(aplanat, tmp_path):
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    pixels = np.full((24, 32, 4), 0.5, np.float32)
    depth = np.full((24, 32), 4.0, np.float32)
    depth[3:9, 5:11], depth[10:12] = np.nan, np.inf
    OpenEXR.File(dict(header), {"RGBA": pixels, "Depth.Z": depth}).write(str(tmp_path / "a.exr"))
    words = ("-o", tmp_path / "b.exr", "--samples", "4", "--fstop", "0.5")
    done = aplanat("refocus", tmp_path / "a.exr", *words, "--json")
    assert done.code == 0, done.err
    assert any("36 pixels have a depth that is no number" in w for w in done.answer["warnings"])
    with OpenEXR.File(str(tmp_path / "b.exr")) as found:
        assert np.isfinite(found.channels()["RGBA"].pixels).all()
    depth[:] = np.nan
    OpenEXR.File(dict(header), {"RGBA": pixels, "Depth.Z": depth}).write(str(tmp_path / "c.exr"))
    done = aplanat("refocus", tmp_path / "c.exr", "-o", tmp_path / "d.exr")
    assert done.code == 2 and done.err.count("\n") == 1, done.err
    assert "no depth that is a finite number" in done.err and not (tmp_path / "d.exr").exists()
