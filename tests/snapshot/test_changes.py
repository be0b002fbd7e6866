from dataclasses import replace

import numpy as np
import pytest

from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import Camera
from addon.snapshot.changes import Change, compare, compare_content
from addon.snapshot.content import (
    ImageSnapshot,
    InstanceGroup,
    InstanceTable,
    Light,
    MaterialSnapshot,
    MeshSnapshot,
    SceneContent,
    World,
)
from addon.snapshot.film import Film, Sampling
from addon.snapshot.scene import SceneSnapshot
from addon.snapshot.surface_graph import SurfaceGraph


def table(x=0.0, **other):
    world = np.eye(4, dtype=np.float32)[None].copy()
    world[0, 0, 3] = x
    return InstanceTable(world, np.array([np.float32(1e-12)]), **other)


def mesh(uid):
    return MeshSnapshot(uid, "m", np.zeros((3, 3), np.float32), np.array([[0, 1, 2]]), ((0, 0, 1),))


def content(**other):
    parts = {
        "meshes": {1: mesh(1)},
        "images": {2: ImageSnapshot(2, "i", np.zeros((1, 1, 4), np.uint8))},
        "materials": {3: MaterialSnapshot(3, "p", SurfaceGraph())},
        "instances": table(),
        "groups": (InstanceGroup(1, (3,), 0, 1),),
    }
    return SceneContent(**(parts | other))


def snapshot(**other):
    parts = {
        "content": content(),
        "camera": Camera(np.eye(4), np.eye(4), ThinLens(0.01, 2.0)),
        "film": Film(4, 4, (0, 0, 4, 4)),
        "sampling": Sampling(),
    }
    return SceneSnapshot(**(parts | other))


LAMP = Light("POINT", (0, 0, 0), (0, 0, -1), (1, 1, 1))


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ({}, Change.NONE),
        ({"meshes": {4: mesh(4)}}, Change.GEOMETRY),
        ({"images": {}}, Change.IMAGES),
        ({"materials": {}}, Change.MATERIALS),
        ({"instances": table(1.0)}, Change.TRANSFORMS),
        ({"instances": table(names=("a",))}, Change.TRANSFORMS),
        ({"instances": table(next_world=np.zeros((1, 4, 4)))}, Change.TRANSFORMS),
        ({"groups": (InstanceGroup(1, (3,), 0, 1, True),)}, Change.GROUPS),
        ({"lights": (LAMP,)}, Change.LIGHTS),
        ({"world": World((1, 0, 0))}, Change.WORLD),
        ({"report": ("a line",)}, Change.REPORT),
        ({"meshes": {}, "groups": ()}, Change.GEOMETRY | Change.GROUPS),
    ],
)
def test_a_changed_part_of_the_content_is_named(other, expected):
    assert compare_content(content(), content(**other)) == expected


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ({}, Change.NONE),
        ({"camera": Camera(np.eye(4) * 2, np.eye(4), ThinLens(0.01, 2.0))}, Change.CAMERA),
        ({"camera": Camera(np.eye(4), np.eye(4), ThinLens(0.02, 2.0))}, Change.CAMERA),
        ({"film": Film(4, 4, (0, 0, 2, 4))}, Change.FILM),
        ({"sampling": Sampling(lens_samples=3)}, Change.SAMPLING),
        ({"passes": ("Combined", "Depth")}, Change.PASSES),
    ],
)
def test_a_changed_part_of_the_snapshot_is_named(other, expected):
    same = content()
    assert compare(snapshot(content=same), snapshot(content=same, **other)) == expected


def test_motion_of_the_camera_counts():
    still = snapshot().camera
    moving = replace(still, previous=(np.eye(4), np.eye(4)))
    same = content()
    change = compare(snapshot(content=same, camera=still), snapshot(content=same, camera=moving))
    assert change == Change.CAMERA


def test_everything_differs_from_nothing():
    assert compare(None, snapshot()) == Change.ALL
    assert compare_content(None, content()) == Change.CONTENT


def test_a_line_of_the_report_does_not_spoil_the_picture():
    assert not Change.REPORT & Change.PICTURE
