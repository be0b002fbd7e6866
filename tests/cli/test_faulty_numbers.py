"""Numbers in the file that make no picture leave a picture and a warning."""

import math

import numpy as np
import OpenEXR
import pytest


def _not_finite(value):
    def spoil(_bpy, scene):
        # Blender's own fields would clamp an infinite value.
        mesh = scene.objects["Near"].data
        places = np.empty((len(mesh.vertices), 3), np.float32)
        mesh.attributes["position"].data.foreach_get("vector", places.ravel())
        places[2, 0] = value
        mesh.attributes["position"].data.foreach_set("vector", places.ravel())

    return spoil


def _set_focus(name, value):
    def spoil(_bpy, scene):
        setattr(scene.camera.data.dof, name, value)

    return spoil


def _focus_behind(_bpy, scene):
    scene.objects["Near"].location.z = 3.0
    scene.camera.data.dof.focus_object = scene.objects["Near"]


@pytest.mark.parametrize(
    "spoil, told",
    [
        (_not_finite(math.nan), "coordinates that are not finite"),
        (_not_finite(math.inf), "coordinates that are not finite"),
        (_set_focus("focus_distance", 0.0), "focus distance is 0 m"),
        (_set_focus("focus_distance", 1e-6), "nearer than its focal length"),
        (_set_focus("aperture_fstop", 0.0), "f-stop is 0"),
        (_focus_behind, "focus object 'Near' is behind the camera"),
    ],
)
def test_the_picture_is_finite_and_the_fault_is_told(aplanat, make_blend, tmp_path, spoil, told):
    path = tmp_path / "a.exr"
    words = ("-o", path, "--samples", "2", "--resolution", "32x18", "--json")
    done = aplanat("render", make_blend(spoil), *words)
    assert done.code == 0, done.err
    with OpenEXR.File(str(path)) as file:
        for channel in file.channels().values():
            assert np.isfinite(channel.pixels).all()
    assert any(told in line for line in done.answer["warnings"])
