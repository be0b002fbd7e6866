"""A picture file that was cut off anywhere is found out; OpenEXR and Blender are the writers."""

import random

import numpy as np
import OpenEXR
import pytest

from addon.files.whole_picture import is_whole_picture


def exr(path, compression, parts):
    pixels = np.random.default_rng(1).random((40, 24, 4), np.float32)
    made = [
        OpenEXR.Part(
            {"type": OpenEXR.scanlineimage, "compression": compression, "comments": "c" * 900},
            {"RGBA": pixels},
            f"part{number}",
        )
        for number in range(parts)
    ]
    OpenEXR.File(made).write(str(path))


@pytest.mark.parametrize("parts", [1, 3])
@pytest.mark.parametrize("codec", ["NO", "RLE", "ZIPS", "ZIP", "PIZ", "DWAB"])
def test_an_exr_file_is_whole_only_with_its_last_byte(codec, parts, tmp_path):
    exr(tmp_path / "a.exr", getattr(OpenEXR, f"{codec}_COMPRESSION"), parts)
    check(tmp_path / "a.exr")


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "OPEN_EXR"])
def test_blenders_own_file_is_whole_only_with_its_last_byte(
    kind, aplanat_bpy, empty_scene, tmp_path
):
    bpy, scene = aplanat_bpy, empty_scene
    scene.render.image_settings.file_format = kind
    image = bpy.data.images.new("noise", 40, 24, float_buffer=True)
    image.pixels.foreach_set(np.random.default_rng(1).random(40 * 24 * 4, np.float32))
    image.save_render(str(tmp_path / "a"), scene=scene)
    check(tmp_path / "a")


def check(path):
    """Cut a whole file at many places."""
    whole = path.read_bytes()
    assert is_whole_picture(path)
    cut = path.with_name("cut")
    places = random.Random(1).sample(range(len(whole)), 40)
    for place in [0, 3, 8, len(whole) - 1, len(whole) // 2, *places]:
        cut.write_bytes(whole[:place])
        if place > 8 or not place:
            assert not is_whole_picture(cut), place


def test_no_file_is_not_whole_and_other_formats_are_not_judged(tmp_path):
    assert not is_whole_picture(tmp_path / "none")
    (tmp_path / "empty").touch()
    assert not is_whole_picture(tmp_path / "empty")
    (tmp_path / "other.tif").write_bytes(b"II*\x00")
    assert is_whole_picture(tmp_path / "other.tif")
