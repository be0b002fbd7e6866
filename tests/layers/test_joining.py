"""Layers of a picture are joined where a surface goes on, and nowhere else."""

import numpy as np
import pytest

from addon.layers.joining import join_layers
from addon.layers.layer_stack import DepthLayer, LayerCamera, LayerStack

HEIGHT, WIDTH = 24, 16
GREY, RED = (0.5, 0.5, 0.5), (0.9, 0.1, 0.1)
_ROWS = np.mgrid[0:HEIGHT, 0:WIDTH][0]
# A floor before a camera that looks along it: one over its depth falls evenly from row to row.
FLOOR = 1.0 / (0.5 - 0.02 * _ROWS)


def camera(orthographic=False):
    rows = ((1.0, 0, 0, 0), (0, 1.0, 0, 0), (0, 0, -1.0, -0.2), (0, 0, -1.0, 0))
    return LayerCamera(rows, orthographic=orthographic, aperture_radius=0.1)


def layer(depth, coverage, color=GREY):
    coverage = np.broadcast_to(coverage, depth.shape).astype(np.float32)
    pixels = coverage[..., None] * np.array([*color, 1.0], np.float32)
    return DepthLayer(pixels, np.where(coverage > 0.0, depth, np.inf).astype(np.float32))


def stack(*layers, orthographic=False):
    return LayerStack(layers, camera(orthographic), WIDTH, HEIGHT)


def laid_over(layers):
    total = np.zeros((HEIGHT, WIDTH, 4))
    for found in reversed(layers):
        total = found.color + (1.0 - found.color[..., 3:]) * total
    return total


def floor(first, last, ends=(), depth=FLOOR):
    """The rows of a floor from one to another, with what is covered of those at its ends."""
    coverage = ((first <= _ROWS) & (last >= _ROWS)).astype(np.float32)
    for row, share in dict(ends).items():
        coverage[row] = share
    return layer(depth, coverage)


def whole_rows(found):
    return set(np.flatnonzero((found.color[..., 3] > 0.999).all(axis=1)).tolist())


@pytest.mark.parametrize("orthographic", [False, True])
@pytest.mark.parametrize(
    ("near_ends", "far_ends"),
    [
        ({}, {}),
        # What Cycles makes of slices: the last pixels are covered in part.
        ({10: 0.3}, {9: 0.7}),
        # Whole in neither of them.
        ({10: 0.4}, {10: 1.0 - 1e-5}),
        ({10: 0.4, 11: 0.05}, {9: 0.1, 10: 0.3, 11: 1.0}),
        ({9: 1.0, 10: 0.6}, {10: 0.999999}),
    ],
)
def test_a_surface_through_a_cut_is_whole_in_both_layers(near_ends, far_ends, orthographic):
    depth = 1.0 + 0.3 * _ROWS if orthographic else FLOOR
    near, far = floor(0, 9, near_ends, depth), floor(11, HEIGHT, far_ends, depth)
    if not far_ends:
        far = floor(10, HEIGHT, depth=depth)
    told = stack(near, far, orthographic=orthographic)
    # As the capture mends it: laid over each other they are whole.
    missing = 1.0 - laid_over(told.layers)[..., 3]
    rows = np.flatnonzero(missing.max(axis=1) > 1e-4)
    far.color[rows] = np.array([*GREY, 1.0])
    far.depth[rows] = depth[rows]
    joined = join_layers(told)
    assert joined.layers[0] is near
    front, behind = map(whole_rows, joined.layers)
    assert front & behind and front | behind == set(range(HEIGHT))
    # The same surface, where it was.
    found = joined.layers[1].depth
    assert np.allclose(found[np.isfinite(found)], depth[np.isfinite(found)])
    assert np.allclose(laid_over(joined.layers), laid_over(told.layers), atol=1e-6)
    whole = joined.layers[1].color[..., 3] > 0.999
    assert np.allclose(joined.layers[1].color[whole], [*GREY, 1.0], atol=1e-6)


def test_jittered_depths_of_a_renderer_are_one_surface():
    # Depths are those of one sample of a pixel, anywhere in it.
    random = np.random.default_rng(2)
    depths = [
        1.0 / (0.5 - 0.02 * (_ROWS + random.uniform(-0.75, 0.75, _ROWS.shape))) for _ in range(2)
    ]
    joined = join_layers(stack(floor(0, 9, depth=depths[0]), floor(10, HEIGHT, depth=depths[1])))
    assert whole_rows(joined.layers[0]) & whole_rows(joined.layers[1])


def test_layers_that_overlap_are_left():
    told = stack(floor(0, 11), floor(10, HEIGHT), layer(np.full((HEIGHT, WIDTH), np.inf), 1.0))
    joined = join_layers(told)
    assert all(a is b for a, b in zip(joined.layers, told.layers, strict=True))


def test_a_row_that_is_a_layer_of_its_own_is_joined_on_both_sides():
    joined = join_layers(stack(floor(0, 9), floor(10, 10), floor(11, HEIGHT)))
    assert whole_rows(joined.layers[1]) >= {9, 10}
    assert 10 in whole_rows(joined.layers[2])


def box(rows, depth, color=RED):
    return layer(np.full((HEIGHT, WIDTH), depth), (rows[0] <= _ROWS) & (rows[1] >= _ROWS), color)


def test_objects_before_a_wall_stay_as_they_are():
    wall = layer(np.full((HEIGHT, WIDTH), 9.0), 1.0)
    told = stack(box((6, 14), 3.0), wall)
    assert join_layers(told).layers[1] is wall


def test_an_edge_before_one_of_something_farther_is_not_bridged():
    # By chance the wall begins in the row where the object ends.
    wall = box((15, HEIGHT), 9.0, GREY)
    told = stack(box((6, 14), 3.0), wall)
    assert join_layers(told).layers[1] is wall
    # A sloped top before a sloped floor, each less steep than the step between them.
    top = layer(1.0 / (0.6 - 0.01 * _ROWS), _ROWS <= 9, RED)
    told = stack(top, floor(10, HEIGHT))
    assert join_layers(told).layers[1] is told.layers[1]


def test_the_world_gets_no_surface():
    # As flat input has it: only where there is nothing else. The floor ends at the horizon.
    horizon = 1.0 / np.maximum(0.02 * (12.0 - _ROWS), 1e-6)
    world = layer(np.full((HEIGHT, WIDTH), np.inf), _ROWS >= 12)
    told = stack(layer(horizon, _ROWS < 12), world)
    assert join_layers(told).layers[1] is world
