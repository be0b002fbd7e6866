"""Chromatic aberration through the command line: pictures, passes, statistics, switching it off."""

import json

import numpy as np


def chromatic(bpy, scene):
    """Turn strong chromatic aberration on, with its Fringe pass; the switch itself is animated."""
    for camera in bpy.data.cameras:
        settings = camera.aplanat.chromatic
        settings.use = True
        settings.mode = "RGB"
        settings.axial, settings.lateral = 4.0, 3.0
        settings.keyframe_insert("use", frame=1)
    for layer in scene.view_layers:
        layer.aplanat.use_pass_fringe = True


def read_channels(path):
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: c.pixels for part in file.parts for name, c in part.channels.items()}


def fringe(path):
    channels = read_channels(path)
    found = [pixels for name, pixels in channels.items() if ".Fringe." in name]
    assert len(found) == 3
    return np.stack(found)


def test_chromatic_aberration_is_rendered_told_and_left_out(aplanat, make_blend, tmp_path):
    scene = make_blend(chromatic)
    words = ("render", scene, "--samples", "9", "--resolution", "48x32", "--json")
    stats = tmp_path / "s.json"
    done = aplanat(*words, "-o", tmp_path / "on.exr", "--stats", stats)
    assert done.code == 0, done
    told = json.loads(stats.read_text())["settings"]["chromatic"]
    assert told["mode"] == "rgb"
    assert told["axial"] == 4.0 and told["lateral_per_um"] > 0.0
    assert told["wavelengths_nm"] == [650.0, 510.0, 475.0]
    assert told["focal_ratio"] < 1.0
    assert np.abs(fringe(tmp_path / "on.exr")).max() > 1e-3
    done = aplanat(*words, "-o", tmp_path / "off.exr", "--no-chromatic")
    assert done.code == 0, done
    assert done.answer["settings"]["chromatic"] is None
    assert not fringe(tmp_path / "off.exr").any()
