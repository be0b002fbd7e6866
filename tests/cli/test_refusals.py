"""What `aplanat render` refuses: exit code 2, one line that helps, and no file."""

import errno
import os

import pytest


def test_a_scene_that_is_not_there_is_refused(refused, tmp_path):
    line = refused("render", tmp_path / "none.blend", "-o", tmp_path / "a.png")
    assert "none.blend" in line and "does not exist" in line


@pytest.mark.parametrize("content", [b"", b"not a blend file", b"BLENDER-v502" + bytes(100)])
def test_a_file_that_is_no_scene_is_refused(refused, tmp_path, content):
    path = tmp_path / "broken.blend"
    path.write_bytes(content)
    assert "broken.blend" in refused("render", path, "-o", tmp_path / "a.png")


def test_half_a_scene_is_refused(refused, small_blend, tmp_path):
    path = tmp_path / "half.blend"
    path.write_bytes(small_blend.read_bytes()[: small_blend.stat().st_size // 2])
    assert "half.blend" in refused("render", path, "-o", tmp_path / "a.png")


def test_a_folder_in_place_of_a_scene_is_refused(refused, tmp_path):
    assert "does not exist" in refused("render", tmp_path, "-o", tmp_path / "a.png")


def test_a_scene_without_a_camera_is_refused(refused, make_blend, tmp_path):
    def remove(_bpy, scene):
        scene.camera = None

    assert "no camera" in refused("render", make_blend(remove), "-o", tmp_path / "a.png")


@pytest.mark.parametrize("name", ["Nobody", "Near"])
def test_unknown_camera_lists_those_there_are(refused, small_blend, tmp_path, name):
    line = refused("render", small_blend, "-o", tmp_path / "a.png", "--camera", name)
    assert name in line and "'Camera', 'Second'" in line


def test_a_panoramic_camera_is_refused(refused, make_blend, tmp_path):
    def panorama(_bpy, scene):
        scene.camera.data.type = "PANO"

    line = refused("render", make_blend(panorama), "-o", tmp_path / "a.png")
    assert "pano" in line.lower()


def test_an_unknown_focus_object_is_named(refused, small_blend, tmp_path):
    line = refused("render", small_blend, "-o", tmp_path / "a.png", "--focus", "Nothing")
    assert "Nothing" in line


def test_more_pixels_than_memory_are_refused(refused, small_blend, tmp_path):
    words = ("render", small_blend, "-o", tmp_path / "a.png", "--resolution", "65536x65536")
    line = refused(*words)
    assert "65536" in line and ("memory" in line or "pixels a side" in line)


def test_a_picture_that_cannot_be_written_is_refused(refused, small_blend, tmp_path):
    assert "does not exist" in refused("render", small_blend, "-o", tmp_path / "no" / "a.png")
    assert "cannot write" in refused("render", small_blend, "-o", "/proc/a.png")


def test_statistics_that_cannot_be_written_are_refused(refused, small_blend, tmp_path):
    words = ("render", small_blend, "-o", tmp_path / "a.png", "--stats", tmp_path / "no" / "s.json")
    assert "does not exist" in refused(*words)


@pytest.mark.parametrize("option", ["-o", "--stats"])
@pytest.mark.parametrize("where", ["/proc/{}", "{tmp}/no/{}", "{tmp}/folder-{}", "{tmp}/file/{}"])
def test_a_render_that_cannot_be_written_names_path_and_reason(
    option, where, aplanat, small_blend, tmp_path
):
    (tmp_path / "file").write_text("")
    name = "a.png" if option == "-o" else "a.json"
    (tmp_path / f"folder-{name}").mkdir()
    path = where.format(name, tmp=tmp_path)
    before = sorted(tmp_path.rglob("*"))
    output = () if option == "-o" else ("-o", tmp_path / "b.png")
    done = aplanat("render", small_blend, *output, option, path)
    assert done.code == 2 and done.err.count("\n") == 1, done.err
    assert done.err.startswith(f"aplanat: cannot write '{path}': ")
    assert sorted(tmp_path.rglob("*")) == before


def test_a_disk_that_fills_up_is_one_line_and_exit_code_1(
    aplanat, small_blend, tmp_path, monkeypatch
):
    from addon.files import held_files

    def full(_held, _place):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(held_files.shutil, "copyfile", full)
    done = aplanat("render", small_blend, "-o", tmp_path / "a.png", "--samples", "1", "--json")
    assert done.code == 1 and "Traceback" not in done.err
    (error,) = done.answer["errors"]
    assert error["code"] == "unfinished_file"
    assert f"'{tmp_path / 'a.png'}'" in error["message"] and "No space left" in error["message"]
    assert sorted(tmp_path.iterdir()) == []


def test_a_path_that_no_system_can_have_is_refused(refused, tmp_path):
    assert "does not exist" in refused("render", tmp_path / f"{'a' * 300}.blend")


def test_a_scene_that_writes_a_movie_is_refused(refused, make_blend):
    def movie(_bpy, scene):
        scene.render.image_settings.media_type = "VIDEO"

    assert "movie" in refused("render", make_blend(movie))


def test_a_scene_with_all_view_layers_off_is_refused(refused, make_blend, tmp_path):
    def off(_bpy, scene):
        scene.view_layers[0].use = False

    assert "view layer" in refused("render", make_blend(off), "-o", tmp_path / "a.png")


def test_refusal_with_json_is_one_object(aplanat, tmp_path):
    done = aplanat("render", tmp_path / "none.blend", "--json")
    assert done.code == 2
    assert [set(error) for error in done.answer["errors"]] == [{"code", "message"}]
    assert done.answer["warnings"] == []
    done = aplanat("render", "--samples", "0", "--json")
    assert done.code == 2 and done.answer["errors"][0]["code"] == "input"


def test_a_missing_or_unfitting_lens_is_refused(refused, small_blend, make_blend, tmp_path):
    words = ("render", small_blend, "-o", tmp_path / "a.png", "--lens")
    assert "tessar-50mm-f2.8" in refused(*words, "tesar-50mm")
    assert "none.toml" in refused(*words, tmp_path / "none.toml")

    def orthographic(_bpy, scene):
        scene.camera.data.type = "ORTHO"

    flat = make_blend(orthographic)
    line = refused("render", flat, "-o", tmp_path / "a.png", "--lens", "tessar-50mm-f2.8")
    assert "perspective" in line
    line = refused("render", flat, "-o", tmp_path / "a.png", "--lens", "tesar-50mm")
    assert "tessar-50mm-f2.8" in line and "perspective" not in line
