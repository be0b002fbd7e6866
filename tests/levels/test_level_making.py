"""Levels of detail follow from the mesh alone: the same bits whatever was made before."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from addon.levels import level_making
from addon.levels.level_files import LevelFiles
from addon.levels.level_making import LevelMaker
from addon.snapshot.content import MeshSnapshot, next_uid

from .test_level_store import assert_same_levels, sheet

LEAST = 100


def pose(rest, frame):
    """Return a sheet as it is bent in a frame, with normals and colours."""
    x, y, z = rest.positions.T.astype(np.float64)
    lift = 0.08 * frame * np.sin(3.0 * x + 0.2 * frame)
    positions = np.float32(np.stack([x, y, z + lift], axis=1))
    normals = np.float32(np.stack([-0.24 * frame * np.cos(3.0 * x), 0.0 * x, 1.0 + 0.0 * x], 1))
    colors = np.float32(np.stack([x, y, x * y, 1.0 + 0.0 * x], axis=1))
    return replace(
        rest,
        uid=next_uid(),
        positions=positions,
        attributes={"normal": normals, "color:": colors},
        rest=rest.positions,
    )


def split(mesh, corners):
    """Return a mesh whose given corners, of its first triangles, have vertices of their own."""
    triangles = mesh.triangles.copy()
    old = triangles.reshape(-1)[corners]
    triangles.reshape(-1)[corners] = len(mesh.positions) + np.arange(len(corners), dtype=np.int32)

    def longer(values):
        return np.concatenate([values, values[old]])

    return replace(
        mesh,
        uid=next_uid(),
        triangles=triangles,
        positions=longer(mesh.positions),
        rest=longer(mesh.rest),
        attributes={key: longer(values) for key, values in mesh.attributes.items()},
    )


@pytest.fixture
def maker(tmp_path):
    return LevelMaker(LevelFiles(tmp_path / "levels", 1 << 30), 1 << 30)


def levels_of(maker, mesh):
    return maker.make(mesh, LEAST, lambda done: None)[0]


def test_frames_get_the_same_levels_in_every_order(tmp_path):
    rest = sheet(30)
    frames = [pose(rest, frame) for frame in (0.5, 1.0, 2.0)]
    alone = [
        levels_of(LevelMaker(LevelFiles(tmp_path / str(i), 1 << 30), 1 << 30), frame)
        for i, frame in enumerate(frames)
    ]
    for order in itertools.permutations(range(3)):
        maker = LevelMaker(LevelFiles(tmp_path / "levels", 1 << 30), 1 << 30)
        for number in order:
            assert_same_levels(levels_of(maker, frames[number]), alone[number])


@pytest.mark.parametrize("kept", ["memory", "disk", "little memory"])
def test_what_is_kept_changes_no_bit(monkeypatch, tmp_path, kept):
    monkeypatch.setattr(level_making, "_LEAST_TRIANGLES_ON_DISK", 0)
    rest = sheet(30)
    first, second = pose(rest, 1.0), pose(rest, 2.0)
    expected = levels_of(LevelMaker(LevelFiles(tmp_path / "other", 1 << 30), 1 << 30), second)
    limit = 0 if kept == "little memory" else 1 << 30
    maker = LevelMaker(LevelFiles(tmp_path / "levels", 1 << 30), limit)
    levels_of(maker, first)
    levels_of(maker, sheet(25))
    if kept == "disk":
        maker = LevelMaker(LevelFiles(tmp_path / "levels", 1 << 30), limit)
    found, work = maker.make(second, LEAST, lambda done: None)
    assert_same_levels(found, expected)
    if kept == "memory":
        assert (work.decimations, work.replays, work.loads) == (0, 1, 0)
    else:
        assert (work.decimations, work.replays, work.loads) == (0, 0, 1)


def test_frames_that_are_split_along_other_seams_share_their_collapses(maker):
    rest = sheet(30)
    whole, cut = pose(rest, 1.0), split(pose(rest, 2.0), np.arange(0, 300, 7))
    levels_of(maker, whole)
    found, work = maker.make(cut, LEAST, lambda done: None)
    assert (work.decimations, work.replays) == (0, 1)
    # And they are those that the mesh would have if it were the only one.
    places = level_making.weld(cut.rest)
    bare = level_making._bare(cut, cut.rest, places)
    _, halvings = level_making.simplify(bare, LEAST)
    assert_same_levels(found, level_making.replay(cut, halvings, places))
    assert [len(level.triangles) for level in found] == [
        len(level.triangles) for level in levels_of(maker, pose(rest, 2.0))
    ]


def test_a_mesh_that_is_deformed_beyond_its_rest_is_simplified_by_itself(maker):
    flat = sheet(30, lift=0.0)
    rough = np.random.default_rng(5).normal(size=len(flat.positions)) * 0.05
    positions = flat.positions.copy()
    positions[:, 2] = rough
    crumpled = replace(flat, uid=next_uid(), positions=positions, rest=flat.positions)
    alone = replace(crumpled, uid=next_uid(), rest=None)
    assert_same_levels(levels_of(maker, crumpled), levels_of(maker, alone))


def test_vertices_that_part_are_not_merged_by_a_rest_where_they_lie_together(maker):
    left, right = sheet(20), sheet(20)
    rest = np.concatenate([left.positions, right.positions + np.float32([1.0, 0.0, 0.0])])
    # The seam between the halves is closed at rest.
    seam = np.flatnonzero(left.positions[:, 0] == 1.0)
    other = len(left.positions) + np.flatnonzero(right.positions[:, 0] == 0.0)
    rest[other] = rest[seam]
    parted = rest.copy()
    parted[len(left.positions) :, 0] += 0.5
    triangles = np.concatenate([left.triangles, right.triangles + len(left.positions)])
    mesh = MeshSnapshot(
        next_uid(), "halves", parted, np.int32(triangles), ((0, 0, len(triangles)),), rest=rest
    )
    assert_same_levels(levels_of(maker, mesh), levels_of(maker, replace(mesh, rest=None)))


def test_a_rest_that_tells_nothing_is_not_used(maker):
    mesh = sheet(30)
    collapsed = replace(mesh, uid=next_uid(), rest=np.zeros_like(mesh.positions))
    assert_same_levels(levels_of(maker, collapsed), levels_of(maker, mesh))
