"""The error of a picture on the device is that of its numpy twin, and of the similarity itself."""

import numpy as np
import pytest

from addon.device import geometry, readback
from addon.device.targets import Targets, TargetSpec
from addon.device.textures import texture_2d
from addon.passes import picture_error
from addon.passes.tile_scales import TileScales
from addon.sampling.tile_control import TILE
from benchmarks.reference.picture_error import displayed, tile_means, window_errors

pytestmark = pytest.mark.usefixtures("gpu_context")


def pictures(width, height, noise=0.05):
    random = np.random.default_rng(7)
    x, y = np.meshgrid(np.linspace(0.0, 3.0, width), np.linspace(0.0, 2.0, height))
    base = np.stack([np.sin(3 * x) ** 2, 0.5 + 0.4 * np.cos(5 * y), x * y / 6.0, 0 * x + 1.0], -1)
    changed = base + noise * random.standard_normal(base.shape) * [1.0, 1.0, 1.0, 0.0]
    return base, changed


def drawn(width, height, first, second, rest):
    names = ("a", "b")
    fullscreen = geometry.fullscreen_batch()
    tiles = (-(-height // TILE), -(-width // TILE))
    specs = [TargetSpec("sum", "RGBA32F"), *picture_error.specs(width, height, names)]
    with Targets(width, height, specs) as targets:
        scales = TileScales(texture_2d(np.full((*tiles, 4), 0.5)))
        for name, picture in zip(names, (first, second), strict=True):
            with targets.framebuffer(name).bind():
                picture_error.display(fullscreen, texture_2d(2.0 * picture), scales)
        shown = [readback.read_color(targets.framebuffer(name), width, height) for name in names]
        picture_error.measure(fullscreen, targets, *names, rest)
        table = readback.read_color(targets.framebuffer("tile_errors"), *tiles[::-1])
    return shown, table


@pytest.mark.parametrize(("width", "height"), [(64, 48), (37, 21), (7, 5), (1, 1)])
def test_tiles_are_those_of_the_twin(width, height):
    first, second = pictures(width, height)
    shown, table = drawn(width, height, first, second, 0.7)
    # Encoded values are kept as half floats.
    assert np.abs(shown[0] - displayed(first)).max() < 1e-3
    errors, changes = window_errors(*shown, 0.7)
    # Variances as differences of squares in float32, over C2.
    assert np.abs(table[..., 0] - tile_means(errors)).max() < 2e-3
    assert table[..., 1] == pytest.approx(tile_means(changes), rel=1e-2, abs=1e-6)


def test_the_error_is_that_of_the_similarity_with_a_picture_without_noise():
    similarity = pytest.importorskip("skimage.metrics").structural_similarity
    truth, noisy = pictures(160, 96, 0.02)
    _, other = pictures(160, 96, 0.0)
    assert np.array_equal(other, truth)
    # The picture's own noise as its change: what is left then is as large as the change.
    _, table = drawn(160, 96, noisy, truth, 1.0)
    expected = 1.0 - similarity(
        displayed(noisy)[..., :3],
        displayed(truth)[..., :3],
        data_range=1.0,
        channel_axis=2,
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
    )
    # Windows every 4 px instead of every one.
    assert table[..., 0].mean() == pytest.approx(expected, rel=0.1)


def test_numbers_that_are_none_are_black():
    picture = np.full((16, 16, 4), np.nan)
    shown, table = drawn(16, 16, picture, picture, 1.0)
    assert (shown[0] == 0.0).all()
    assert (table[..., :2] == 0.0).all()


def test_a_matte_that_changes_counts_where_colours_do_not():
    first = np.zeros((32, 32, 4))
    second = first.copy()
    second[8:24, 8:24, 3] = 1.0
    _, table = drawn(32, 32, first, second, 1.0)
    assert table[..., 0].min() > 0.1
