"""N-buffers, bounds of the blur, pyramid and the blur itself, each against its numpy twin."""

import numpy as np
import pytest

from addon.device import geometry, readback
from addon.device.targets import Targets, TargetSpec
from addon.device.textures import texture_2d
from addon.passes import nbuffer, pyramid, subsample
from addon.reference import subsample as twin

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT = 37, 26
SWEEP = np.array([-420.0, -410.0, 500.0, 490.0])
OPENING = np.array([0.05, 0.06])


def stepped_depth(seed=4):
    """Return rectangles at several depths before a far background."""
    rng = np.random.default_rng(seed)
    depth = np.ones((HEIGHT, WIDTH), np.float32)
    for _ in range(5):
        x, y = rng.integers(0, WIDTH - 8), rng.integers(0, HEIGHT - 6)
        depth[y : y + 9, x : x + 12] = rng.uniform(0.78, 0.93)
    return depth


def layers_on_device(depth, count):
    targets = Targets(WIDTH, HEIGHT, [TargetSpec("levels", "RG32F", count)])
    nbuffer.build(texture_2d(depth[..., None], "R32F"), targets["levels"], count)
    return targets


def read_layer(targets, layer):
    import gpu

    framebuffer = gpu.types.GPUFrameBuffer(
        color_slots=({"texture": targets["levels"], "layer": layer},)
    )
    return readback.read_color(framebuffer, WIDTH, HEIGHT, 2)


def test_nbuffers_hold_the_extremes_of_squares():
    depth = np.random.default_rng(1).random((HEIGHT, WIDTH)).astype(np.float32)
    count = nbuffer.layers(7)
    targets = layers_on_device(depth, count)
    expected = twin.nbuffers(depth, count)
    for layer in range(count):
        assert np.array_equal(read_layer(targets, layer), expected[layer]), layer


def bounds_on_device(depth, depth_range):
    count = nbuffer.layers(WIDTH)
    targets = layers_on_device(depth, count)
    targets.add(TargetSpec("bounds", "RG32F"))
    with targets.framebuffer("bounds").bind():
        nbuffer.draw_bounds(
            geometry.fullscreen_batch(), targets["levels"], SWEEP, OPENING, depth_range
        )
    return targets, readback.read_color(targets.framebuffer("bounds"), WIDTH, HEIGHT, 2)


def test_bounds_hold_all_depths_that_can_reach_a_pixel():
    depth = stepped_depth()
    depth_range = (float(depth.min()), 1.0)
    _, found = bounds_on_device(depth, depth_range)
    for y, x in np.ndindex(depth.shape):
        # Every texel whose circle of confusion covers this one.
        ys, xs = np.mgrid[0:HEIGHT, 0:WIDTH]
        reach = np.abs(OPENING * (SWEEP[:2] + SWEEP[2:] * depth[..., None]))
        covers = (np.abs(xs - x) <= reach[..., 0]) & (np.abs(ys - y) <= reach[..., 1])
        assert found[y, x, 0] <= depth[covers].min(initial=1.0)
        assert found[y, x, 1] >= depth[covers].max(initial=0.0)


def test_bounds_are_those_of_the_twin_or_a_little_wider():
    depth = stepped_depth()
    depth_range = (float(depth.min()), 1.0)
    _, found = bounds_on_device(depth, depth_range)
    expected = twin.blur_bounds(depth, SWEEP, OPENING, depth_range)
    # Where the picture's edge cuts a square, overlapping squares cover a little more than it.
    assert (found[..., 0] <= expected[..., 0]).all()
    assert (found[..., 1] >= expected[..., 1]).all()
    inner = (slice(8, -8), slice(8, -8))
    assert (found == expected.astype(np.float32)).all(axis=-1)[inner].mean() > 0.9


LEVELS = 3


def pyramid_on_device(targets, color, depth):
    sample = texture_2d(color), texture_2d(depth[..., None], "R32F")
    targets.add(TargetSpec("means", "RGBA32F", LEVELS, 0.5))
    targets.add(TargetSpec("ranges", "RG32F", LEVELS, 0.5))
    pyramid.build(*sample, targets["means"], targets["ranges"], LEVELS)
    return sample


def test_pyramid_equals_its_twin():
    import gpu

    depth = stepped_depth()
    color = np.random.default_rng(3).random((HEIGHT, WIDTH, 4)).astype(np.float32)
    with Targets(WIDTH, HEIGHT, []) as targets:
        pyramid_on_device(targets, color, depth)
        for level, expected in enumerate(twin.pyramid(color, depth, LEVELS)[1:]):
            for name, values in zip(("means", "ranges"), expected, strict=True):
                framebuffer = gpu.types.GPUFrameBuffer(
                    color_slots=({"texture": targets[name], "layer": level},)
                )
                height, width, channels = values.shape
                found = readback.read_color(framebuffer, width, height, channels)
                # float32 sums of four, in another order.
                assert np.abs(found - values).max() < 1e-6


# With the wide cell, means of up to 8 texels are taken.
@pytest.mark.parametrize(("places", "cell"), [(1, 0.0), (5, 0.0), (4, 0.1)])
def test_subsample_blur_equals_its_twin(places, cell):
    rng = np.random.default_rng(7)
    depth = stepped_depth()
    color = rng.random((HEIGHT, WIDTH, 4)).astype(np.float32)
    offsets = rng.uniform(-0.02, 0.02, (places, 2)).astype(np.float32)
    targets, bounds = bounds_on_device(depth, (float(depth.min()), 1.0))
    targets.add(TargetSpec("sum", "RGBA32F"))
    targets.clear("sum", (0.0, 0.0, 0.0, 0.0))
    sample = pyramid_on_device(targets, color, depth)
    table = np.zeros((1, places, 4), np.float32)
    table[0, :, :2] = offsets
    textures = (
        *sample,
        targets["bounds"],
        texture_2d(table),
        targets["means"],
        targets["ranges"],
    )
    with targets.framebuffer("sum").bind():
        subsample.blur(
            geometry.fullscreen_batch(),
            textures,
            sweep=SWEEP,
            spread=np.abs(offsets).max(axis=0),
            cell=cell,
            top=LEVELS,
            weight=0.5,
            index=0,
            count=places,
        )
    found = readback.read_color(targets.framebuffer("sum"), WIDTH, HEIGHT)
    levels = twin.pyramid(color, depth, LEVELS)
    total, margin = twin.subsample_sum(levels, bounds, offsets, SWEEP, cell)
    # Where a decision hangs on less than rounding, it may turn out otherwise.
    sure = margin > 1e-4
    assert sure.mean() > 0.8
    assert np.abs(found - 0.5 * total)[sure].max() < 1e-5
    if cell:
        plain, _ = twin.subsample_sum(levels, bounds, offsets, SWEEP, 0.0)
        assert (np.abs(total - plain).max(axis=-1) > 0.1).mean() > 0.2
