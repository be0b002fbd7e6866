"""A pixel drawn as a grid of sub-pixels is the weighted mean of a finer picture's pixels."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame, subpixels
from addon.snapshot.content import InstanceGroup

from .conftest import LENS, make_renderer, some_triangles, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

# Six ranks and two spare slots: a place for each of the seven triangles.
MATTES = ("CryptoObject00", "CryptoObject01", "CryptoObject02")
PASSES = ("Combined", "Focus Matte", *MATTES)
SAMPLES = 4


def passes_of(snapshot, **changes):
    plan = replace(plan_frame(snapshot), **changes)
    renderer = make_renderer(snapshot, plan)
    renderer.advance(plan.samples)
    pictures = renderer.read_passes()
    renderer.release()
    return pictures


def weighted_blocks(picture, columns, rows):
    """Weighted mean of blocks of the size of the weights."""
    size = len(columns)
    height, width, channels = picture.shape
    blocks = picture.reshape(height // size, size, width // size, size, channels)
    total = np.einsum("yjxic,j,i->yxc", blocks.astype(np.float64), rows, columns)
    return total / (np.sum(rows) * np.sum(columns))


def coverage(pictures, identifier):
    """Coverage of one id in all the ranks."""
    ranks = np.concatenate([pictures[name] for name in MATTES], axis=-1)
    return (ranks[..., 1::2] * (ranks[..., 0::2] == identifier)).sum(axis=-1, keepdims=True)


@pytest.mark.parametrize("size", [2, 3, 4])
@pytest.mark.parametrize("even", [True, False], ids=["even weights", "uneven weights"])
def test_subpixels_are_the_weighted_mean_of_a_finer_picture(size, even):
    corners, colors = some_triangles()
    snapshot = triangles_snapshot(corners, colors, lens=LENS, samples=SAMPLES, passes=PASSES)
    columns = np.full(size, 1.0) if even else 0.2 + np.arange(size)
    rows = np.full(size, 1.0) if even else 1.0 / (1.0 + np.arange(size))
    weights = np.tile(np.stack([columns, rows]), (SAMPLES, 1, 1))
    found = passes_of(snapshot, subpixels=size, subpixel_weights=weights)
    plan = plan_frame(snapshot)
    fine = passes_of(snapshot, width=size * plan.width, height=size * plan.height)
    # Sums of up to 64 float32 products of order 1.
    for name in ("Combined", "Focus Matte"):
        expected = weighted_blocks(fine[name], columns, rows)
        assert np.abs(found[name] - expected).max() < 4e-6, name
    for identifier in (1.0, 2.0, 5.0):
        expected = weighted_blocks(coverage(fine, identifier), columns, rows)
        # Only the six ranks that are shown are read: a seventh id of a pixel is not.
        shown = len(MATTES) * 2
        full = np.count_nonzero(
            np.concatenate([found[name] for name in MATTES], axis=-1)[..., 1::2], axis=-1
        )
        differs = np.abs(coverage(found, identifier) - expected)[..., 0]
        assert differs[full < shown].max() < 4e-6


def test_the_raster_is_as_fine_as_the_geometry_within_bounds():
    corners, colors = some_triangles()
    content = triangles_snapshot(corners, colors).content
    assert subpixels(content, 48, 32) == 1
    mesh, materials = content.groups[0].mesh, content.groups[0].materials

    def with_triangles(count):
        return replace(content, groups=(InstanceGroup(mesh, materials, 0, count),))

    pixels = 480 * 270
    assert [subpixels(with_triangles(n * pixels), 480, 270) for n in (1, 2, 4, 9, 100)] == [
        1,
        2,
        2,
        3,
        4,
    ]
    # 2 x 2 sub-pixels of a 4K picture would take more than the raster's share of memory.
    assert subpixels(with_triangles(100 * 3840 * 2160), 3840, 2160) == 1
    assert subpixels(with_triangles(100 * 1920 * 1080), 1920, 1080) == 2
