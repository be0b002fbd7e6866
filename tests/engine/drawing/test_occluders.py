"""Clusters of triangles, the boxes round them, and the atlas of masks."""

import numpy as np
import pytest

from addon.engine.drawing.occluders import (
    BRANCHES,
    CLUSTER,
    Part,
    box_tree,
    cut,
    depth_first,
    occluder_tables,
)
from addon.engine.visibility.plan import lay_out, lay_out_more, note
from addon.passes.visibility import culling


def soup(count, seed=0):
    rng = np.random.default_rng(seed)
    return rng.random((3 * count, 3)), np.arange(3 * count).reshape(-1, 3)


def test_clusters_hold_every_triangle_once():
    positions, triangles = soup(1000)
    shape = cut(positions, triangles)
    corners = shape.corners.reshape(-1, 3, 3)
    real = corners[~(corners == corners[:, :1]).all(axis=(1, 2))]
    expected = positions[triangles].astype(np.float32)
    assert len(real) == 1000
    assert {t.tobytes() for t in real} == {t.tobytes() for t in expected}


def test_boxes_hold_their_clusters_and_the_boxes_below():
    positions, triangles = soup(CLUSTER * 100)
    shape = cut(positions, triangles)
    low, high = shape.boxes[:100, 0], shape.boxes[:100, 1]
    assert (low[:, None] <= shape.corners).all() and (shape.corners <= high[:, None]).all()
    for i in range(100):
        above = shape.boxes[100 + i // BRANCHES]
        assert (above[0] <= low[i]).all() and (high[i] <= above[1]).all()


def test_clusters_are_much_smaller_than_the_mesh():
    positions, triangles = soup(CLUSTER * 100)
    # Small triangles: each within a hundredth of the mesh.
    positions = positions[::3].repeat(3, axis=0) + 0.01 * positions
    shape = cut(positions, triangles)
    extents = np.diff(shape.boxes[:100], axis=1)[:, 0]
    assert extents.mean() < 0.35


def test_a_tree_of_few_boxes_is_those_boxes():
    boxes = np.random.default_rng(1).random((BRANCHES, 2, 3))
    assert np.array_equal(box_tree(boxes), boxes)


def test_parts_lie_in_their_boxes():
    positions, triangles = soup(50)
    shape = cut(positions, triangles)
    world = np.tile(np.eye(4), (20, 1, 1))
    world[:, :3, :3] = np.random.default_rng(2).normal(size=(20, 3, 3))
    world[:, :3, 3] = np.random.default_rng(3).normal(size=(20, 3)) * 10.0
    tables = occluder_tables([Part(0, 20, (shape,))], world)
    for number, record in enumerate(tables.parts):
        matrix = world[int(record[0, 0])]
        points = positions @ matrix[:3, :3].T + matrix[:3, 3]
        low, high = tables.boxes[number]
        assert (low <= points + 1e-5).all() and (points - 1e-5 <= high).all()


def tiles_of(layout, numbers):
    """Return corner and side of every mask."""
    tiles = []
    for number, (_, top, side, each) in zip(numbers, layout.sizes, strict=True):
        rank = np.arange(number)
        x, y = rank % int(each) * side, top + rank // int(each) * side
        tiles += list(zip(x, y, np.full(number, side), strict=True))
    return np.array(tiles, int)


def test_masks_do_not_overlap_and_lie_in_the_atlas():
    numbers = [37, 50, 11, 5, 3, 1]
    layout = lay_out(numbers)
    used = np.zeros((layout.height, layout.width), int)
    for x, y, side in tiles_of(layout, numbers):
        assert x + side <= layout.width and y + side <= layout.height
        used[y : y + side, x : x + side] += 1
    assert used.max() == 1


def test_many_masks_share_the_room_that_there_is():
    few, many = ([0, 0, n, n, 0, 0] for n in (100, 10000))
    room = 1 << 20
    sides = [lay_out(n, room).sizes[2:4, 2] for n in (few, many)]
    assert (sides[0] == culling.LEAST_SIDE * np.array([4, 8])).all()
    layout = lay_out(many, room)
    assert (sides[1] ** 2 * 10000).sum() <= room
    assert layout.width * layout.height < 1.2 * room


def test_the_work_of_rays_is_that_of_the_masks_that_there_is_room_for():
    found = np.zeros(culling.COUNT_GROUPS, np.int64)
    found[culling.COUNT_SIZES + 5] = 1000
    side = culling.LEAST_SIDE << 5
    # Ten steps a texel.
    found[culling.COUNT_WORK] = 1000 * side**2 * 10 // 64
    assert note(found, 1000 * side**2).work == 1000 * side**2 * 10
    assert note(found, 100 * side**2).work == 1000 * (side // 4) ** 2 * 10
    assert note(np.zeros_like(found)).work == 0


@pytest.mark.parametrize("leaves", [1, 8, 9, 65, 700])
def test_a_tree_is_walked_without_memory(leaves):
    low = np.random.default_rng(4).random((leaves, 3))
    boxes = np.stack([low, low + 0.05], axis=1).astype(np.float32)
    laid = depth_first(box_tree(boxes), leaves)
    for point in np.random.default_rng(5).random((20, 3)).astype(np.float32):
        place, met = 0, []
        while place < len(laid):
            inside = (laid[place, 0, :3] <= point).all() and (point <= laid[place, 1, :3]).all()
            if inside and laid[place, 1, 3] >= 0:
                met.append(int(laid[place, 1, 3]))
            place += 1 if inside else int(laid[place, 0, 3])
        holds = (boxes[:, 0] <= point).all(axis=1) & (point <= boxes[:, 1]).all(axis=1)
        assert sorted(met) == np.flatnonzero(holds).tolist()


def test_further_masks_leave_the_others_in_place():
    numbers, further = [37, 50, 11, 5, 3, 1], [3, 0, 70, 0, 1, 0]
    layout = lay_out(numbers)
    more = lay_out_more(layout, sum(numbers), further)
    assert np.array_equal(more.sizes[:6], layout.sizes)
    used = np.zeros((more.height, more.width), int)
    for x, y, side in tiles_of(more, [*numbers, *further]):
        used[y : y + side, x : x + side] += 1
    assert used.max() == 1
    assert more.sizes[:, 0].tolist() == np.cumsum([0, *numbers, *further])[:-1].tolist()
