"""Picking a depth in captured layers, against a loop over layers and pixels."""

import numpy as np
import pytest

from addon.layers.layer_stack import DepthLayer, LayerCamera, LayerStack
from addon.layers.picking import depth_at

WIDTH, HEIGHT, ACROSS, UP = 12, 9, 3, 2
CAMERA = LayerCamera(tuple(map(tuple, np.eye(4))))


def layer(color, depth):
    return DepthLayer(color.astype(np.float32), depth.astype(np.float32))


@pytest.fixture
def stack():
    """Three layers with holes, thin cover and depths of their own, before a world with holes."""
    chance = np.random.default_rng(4)
    shape = HEIGHT + 2 * UP, WIDTH + 2 * ACROSS
    layers = []
    for nearest in (1.0, 2.0, 4.0):
        cover = chance.choice([0.0, 0.3, 1.0], shape, p=[0.6, 0.2, 0.2])
        color = np.repeat(cover[..., None], 4, axis=-1)
        depth = np.where(cover > 0.0, nearest * (1.0 + chance.random(shape)), np.inf)
        layers.append(layer(color, depth))
    world = np.repeat(chance.choice([0.0, 1.0], shape, p=[0.2, 0.8])[..., None], 4, axis=-1)
    layers.append(layer(world, np.full(shape, np.inf)))
    return LayerStack(tuple(layers), CAMERA, WIDTH, HEIGHT, (ACROSS, UP))


def looked_up(stack, x, y):
    """The depth, pixel by pixel and layer by layer."""
    row, column = y + UP, x + ACROSS
    through, shares = 1.0, []
    for one in stack.layers:
        shares.append(through * float(one.color[row, column, 3]))
        through *= 1.0 - float(one.color[row, column, 3])
    if sum(shares) == 0.0:
        return None
    half = next(k for k in range(len(shares)) if sum(shares[: k + 1]) >= 0.5 * sum(shares))
    one = stack.layers[half]
    found = []
    for j in (row - 1, row, row + 1):
        for i in (column - 1, column, column + 1):
            if one.color[j, i, 3] > 0.0 and np.isfinite(one.depth[j, i]):
                found.append(float(one.depth[j, i]))
    found.sort()
    middle = len(found) // 2
    if not found:
        return np.inf
    return found[middle] if len(found) % 2 else 0.5 * (found[middle - 1] + found[middle])


def test_it_is_that_of_the_loop_at_every_pixel(stack):
    told = []
    for y in range(HEIGHT):
        for x in range(WIDTH):
            expected, got = looked_up(stack, x, y), depth_at(stack, x + 0.4, y + 0.7)
            assert (expected is None) == (got is None)
            if expected is not None:
                assert got == pytest.approx(expected, rel=1e-6)
            told.append(expected)
    assert None in told and np.inf in told
    assert len({value for value in told if value is not None}) > 40


@pytest.mark.parametrize("place", [(-0.1, 4), (WIDTH, 4), (4, -0.1), (4, HEIGHT)])
def test_outside_the_picture_is_nothing(stack, place):
    assert depth_at(stack, *place) is None


def test_at_the_border_without_overscan():
    depth = np.arange(6.0).reshape(2, 3) + 1.0
    one = LayerStack((layer(np.ones((2, 3, 4)), depth),), CAMERA, 3, 2)
    # Of 1, 2, 4 and 5 the middle.
    assert depth_at(one, 0.5, 0.5) == 3.0
    assert depth_at(one, 2.9, 1.9) == 4.0


def test_hair_before_a_wall_is_not_what_is_seen():
    hair = layer(np.full((3, 3, 4), 0.4), np.full((3, 3), 1.0))
    wall = layer(np.ones((3, 3, 4)), np.full((3, 3), 5.0))
    assert depth_at(LayerStack((hair, wall), CAMERA, 3, 3), 1.5, 1.5) == 5.0
    hair = layer(np.full((3, 3, 4), 0.6), np.full((3, 3), 1.0))
    assert depth_at(LayerStack((hair, wall), CAMERA, 3, 3), 1.5, 1.5) == 1.0
