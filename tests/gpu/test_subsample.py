"""Pyramid of a lens sample and its blur, each against its numpy twin; what the blur keeps."""

import numpy as np
import pytest

from addon.device import geometry, readback
from addon.device.targets import Targets, TargetSpec
from addon.device.textures import texture_2d
from addon.passes import pyramid, subsample
from addon.sampling.pixel_filter import filter_density
from addon.sampling.sequence import pixel_offsets, subsample_places
from benchmarks.reference import subsample as twin

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT = 37, 26
SWEEP = np.array([-420.0, -410.0, 500.0, 490.0])


def stepped_depth(seed=4):
    """Return rectangles at several depths before a far background."""
    rng = np.random.default_rng(seed)
    depth = np.ones((HEIGHT, WIDTH), np.float32)
    for _ in range(5):
        x, y = rng.integers(0, WIDTH - 8), rng.integers(0, HEIGHT - 6)
        depth[y : y + 9, x : x + 12] = rng.uniform(0.78, 0.93)
    return depth


# Of the means, and of the depths: squares of 64 texels hold the whole picture.
TOP, LEVELS = 3, 6


def pyramid_on_device(targets, color, depth):
    height, width = depth.shape
    sample = texture_2d(color), texture_2d(depth[..., None], "R32F")
    targets.add(TargetSpec("means", "RGBA32F", TOP, 0.5))
    targets.add(TargetSpec("ranges", "RG32F", LEVELS, 0.5))
    pyramid.build(*sample, targets["means"], targets["ranges"], TOP, LEVELS)
    return sample


def test_pyramid_equals_its_twin():
    import gpu

    depth = stepped_depth()
    color = np.random.default_rng(3).random((HEIGHT, WIDTH, 4)).astype(np.float32)
    with Targets(WIDTH, HEIGHT, []) as targets:
        pyramid_on_device(targets, color, depth)
        for level, expected in enumerate(twin.pyramid(color, depth, LEVELS)[1:]):
            for name, values in zip(("means", "ranges"), expected, strict=True):
                if name == "means" and level >= TOP:
                    continue
                framebuffer = gpu.types.GPUFrameBuffer(
                    color_slots=({"texture": targets[name], "layer": level},)
                )
                height, width, channels = values.shape
                found = readback.read_color(framebuffer, width, height, channels)
                # float32 sums of four, in another order.
                assert np.abs(found - values).max() < 1e-6


def blurred(color, depth, offsets, cell=0.0, shifts=(0.0, 0.0), jitter=(0.0, 0.0)):
    """Blur a sample on the device over places on the lens."""
    height, width = depth.shape
    table = np.zeros((1, len(offsets), 4), np.float32)
    table[0, :, :2], table[0, :, 2:] = offsets, shifts
    with Targets(width, height, [TargetSpec("sum", "RGBA32F")]) as targets:
        targets.clear("sum", (0.0, 0.0, 0.0, 0.0))
        sample = pyramid_on_device(targets, color, depth)
        textures = (*sample, texture_2d(table), targets["means"], targets["ranges"])
        with targets.framebuffer("sum").bind():
            block = subsample.params(
                sweep=SWEEP,
                spread=np.abs(offsets).max(axis=0),
                depths=(float(depth.min()), 1.0),
                cell=cell,
                top=TOP,
                levels=LEVELS,
            )
            subsample.blur(
                geometry.fullscreen_batch(),
                textures,
                block,
                jitter=jitter,
                apart=np.abs(table[0, :, 2:]).max(axis=0),
                weight=0.5,
                index=0,
                count=len(offsets),
            )
        return 2.0 * readback.read_color(targets.framebuffer("sum"), width, height)


# With the wide cell, means of up to 8 texels are taken.
@pytest.mark.parametrize("apart", [0.0, 0.45, 1.7])
@pytest.mark.parametrize(("places", "cell"), [(1, 0.0), (5, 0.0), (4, 0.1)])
def test_subsample_blur_equals_its_twin(places, cell, apart):
    rng = np.random.default_rng(7)
    depth = stepped_depth()
    color = rng.random((HEIGHT, WIDTH, 4)).astype(np.float32)
    offsets = rng.uniform(-0.02, 0.02, (places, 2)).astype(np.float32)
    shifts = rng.uniform(-apart, apart, (places, 2)).astype(np.float32)
    ways = shifts, (-0.375, 0.21)
    found = blurred(color, depth, offsets, cell, *ways)
    levels = twin.pyramid(color, depth, LEVELS)
    total, margin = twin.subsample_sum(levels, TOP, offsets, SWEEP, cell, *ways)
    # Where a decision hangs on less than rounding, it may turn out otherwise.
    sure = margin > 1e-4
    assert sure.mean() > 0.8
    assert np.abs(found - total)[sure].max() < 2e-5
    if cell:
        plain, _ = twin.subsample_sum(levels, TOP, offsets, SWEEP, 0.0, *ways)
        assert (np.abs(total - plain).max(axis=-1) > 0.1).mean() > 0.2


# Before, in and behind the focus, which is where the sweep is 0. The cell takes means of what is
# far around the last, which moves alike, but less than the means are wide.
@pytest.mark.parametrize(("lamp", "cell"), [(0.80, 0.0), (0.84, 0.0), (0.88, 0.0), (0.88, 0.038)])
@pytest.mark.parametrize("side", [1, 2, 3])
def test_a_bright_spot_keeps_its_light_wherever_it_moves(lamp, cell, side):
    rng = np.random.default_rng(side)
    depth = np.full((HEIGHT, WIDTH), 0.93, np.float32)
    color = np.zeros((HEIGHT, WIDTH, 4), np.float32)
    spot = (slice(12, 12 + side), slice(17, 17 + side))
    depth[spot], color[spot] = lamp, 1000.0
    for _ in range(8):
        offsets = rng.uniform(-0.1, 0.1, (6, 2)).astype(np.float32)
        found = blurred(color, depth, offsets, cell, rng.uniform(-1.9, 1.9, (6, 2)))
        # Each place sees it whole.
        assert found[..., 0].sum() == pytest.approx(7 * 1000.0 * side**2, rel=1e-5)


def test_an_edge_in_focus_stays_as_it_is_beside_what_is_blurred():
    focus = float(-SWEEP[0] / SWEEP[2])
    depth = np.full((HEIGHT, WIDTH), 0.93, np.float32)
    depth[:, :6] = 0.70
    sharp = (slice(7, 20), slice(14, 30))
    depth[sharp] = focus
    color = np.zeros((HEIGHT, WIDTH, 4), np.float32)
    color[sharp] = 1.0
    # Neither axis has its focus exactly there: movements of 0.06 texels are left, less than to the
    # edge of a square from any place that the sample has of a pixel.
    offsets = np.array([[0.02, 0.01], [-0.03, 0.02], [0.04, -0.04], [-0.01, -0.03]], np.float32)
    found = blurred(color, depth, offsets, shifts=(-0.43, 0.42))
    beside = slice(12, None)
    assert np.array_equal(found[:, beside], 5.0 * color[:, beside])
    # The blurred strip moves by up to 2.8 texels: it has moved.
    assert np.abs(offsets[:, 0] * (SWEEP[0] + SWEEP[2] * 0.70)).max() > 2.5


@pytest.mark.parametrize("furthest", [0.3, 0.7, 1.6])
def test_an_edge_that_moves_by_less_than_texels_is_blurred_by_that(furthest):
    # Over all places in the pixel, the box filter of what is seen from each place on the lens.
    depth = np.full((HEIGHT, WIDTH), 0.93, np.float32)
    scale = SWEEP[0] + SWEEP[2] * 0.93
    moves = furthest * np.array([1.0, -0.2, 0.35, 0.9])
    offsets = np.stack([moves / scale, np.zeros(4)], axis=-1).astype(np.float32)
    edge, columns = 18.3, np.arange(WIDTH)
    mean = np.zeros(WIDTH)
    places = (np.arange(32) + 0.5) / 32 - 0.5
    for place in places:
        color = np.zeros((HEIGHT, WIDTH, 4), np.float32)
        color[:, columns + 0.5 + place > edge] = 1.0
        mean += blurred(color, depth, offsets, shifts=(-place, 0.0))[9, :, 0] / len(places)
    expected = sum(np.clip(columns + 1.0 - move - edge, 0.0, 1.0) for move in (0.0, *moves))
    # Each place is met to a thirty-second; the outermost columns continue what is not there.
    assert np.abs(mean - expected)[3:-3].max() < 5 / 32


@pytest.mark.parametrize(
    ("kind", "size_px"), [("BLACKMAN_HARRIS", 1.5), ("BLACKMAN_HARRIS", 3.0), ("BOX", 2.0)]
)
@pytest.mark.parametrize("move", [0.0, 0.5, 2.3])
def test_an_edge_is_as_wide_as_the_pixel_filter_however_far_it_moves(kind, size_px, move):
    depth = np.full((HEIGHT, WIDTH), 0.93, np.float32)
    offsets = np.full((64, 2), [move / (SWEEP[0] + SWEEP[2] * 0.93), 0.0], np.float32)
    edge, columns = 18.3, np.arange(WIDTH)
    own = pixel_offsets(0, 64, kind, size_px)
    looks = subsample_places(np.full(64, 64), kind, size_px)
    mean = np.zeros(WIDTH)
    for place, look in zip(own, looks, strict=True):
        color = np.zeros((HEIGHT, WIDTH, 4), np.float32)
        color[:, columns + 0.5 + place[0] > edge] = 1.0
        found = blurred(color, depth, offsets, shifts=look - place)[9, :, 0]
        # Without the sample itself, which has not moved.
        mean += (found - color[9, :, 0]) / (64 * len(own))
    u = np.linspace(-4.0, 4.0, 8001)
    share = np.cumsum(filter_density(u, kind, size_px)) * (u[1] - u[0])
    expected = np.interp(columns + 0.5 - move - edge, u, share)
    # Squares lie at 64 places: measured up to 0.008. When the subsamples of a sample looked at one
    # place of its pixel, edges that moved by half a pixel were off by 0.056 with the first filter.
    assert np.abs(mean - expected)[4:-4].max() < 0.012
