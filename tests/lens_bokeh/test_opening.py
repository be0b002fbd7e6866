"""The layers that splats read."""

import numpy as np
import pytest

from addon.lens_bokeh.look.opening import LAYERS, LEAST_BLUR, extent, opening_layers
from addon.lens_bokeh.openings.blades import BladedIris

SIZE = 256


def moments(layer, number):
    """Return integral, mean and variance along x of a layer's density."""
    texel = 2 * extent(number) / SIZE
    places = (np.arange(SIZE) + 0.5) * texel - extent(number)
    weights = layer * texel**2
    total = weights.sum()
    return (
        total,
        (weights * places).sum() / total,
        (weights * places[:, None] ** 2).sum() / total,
        (weights * places**2).sum() / total,
    )


@pytest.mark.parametrize("iris", [BladedIris(), BladedIris(3, 0.0, 0.4), BladedIris(6, 0.5, 0.0)])
def test_every_layer_holds_all_light(iris):
    for number, layer in enumerate(opening_layers(iris.coverage, SIZE)):
        total = moments(layer[..., 0], number)[0]
        assert total == pytest.approx(1.0, abs=1e-5)
        assert (layer >= 0.0).all()
        assert (layer[..., 0] == layer[..., 1]).all()


def test_layers_have_the_variance_of_disc_and_blur():
    layers = opening_layers(BladedIris().coverage, SIZE)
    assert len(layers) == LAYERS
    for number, layer in enumerate(layers):
        _, mean, variance_y, variance_x = moments(layer[..., 0], number)
        # Of a unit disc along an axis, and of a box.
        expected = 0.25 + (LEAST_BLUR * 2.0**number) ** 2 / 12
        assert mean == pytest.approx(0.0, abs=1e-6)
        # The texels' own width.
        assert variance_x == pytest.approx(expected, abs=2e-4)
        assert variance_y == pytest.approx(expected, abs=2e-4)


def test_colours_keep_their_shares():
    def tinted(places, width):
        return BladedIris().coverage(places, width)[..., None] * np.array([1.0, 0.5, 0.25])

    layers = opening_layers(tinted, SIZE)
    for number, layer in enumerate(layers):
        totals = [moments(layer[..., channel], number)[0] for channel in range(3)]
        assert totals == pytest.approx([1.0, 0.5, 0.25], abs=1e-5)


def test_first_row_is_the_lower_end():
    # A triangle with a side to the right and a corner to the left; turned up by a quarter.
    layer = opening_layers(BladedIris(3, 0.0, np.pi / 2).coverage, SIZE)[0][..., 0]
    upper, lower = layer[SIZE // 2 :].sum(), layer[: SIZE // 2].sum()
    widths = (layer > 0.1).sum(axis=1)
    # The side is above, the corner below.
    assert widths[int(0.73 * SIZE)] > widths[int(0.25 * SIZE)] > 0
    assert upper > 0 and lower > 0
