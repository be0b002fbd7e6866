"""Tiles of a real lens: their light, and what an opening leaves of it."""

import numpy as np
import pytest

from addon.bokeh.appearance import Appearance
from addon.bokeh.iris_mask import BladedIris
from addon.bokeh.splat_pupil import AZIMUTHS, BLURS, DEPTHS, FIELDS, SHARP, SOFT, reach
from addon.engine.bokeh_look import describe_look
from tests.splat_pictures import library_lens, plan_of

LENS = "double-gauss-50mm-f2"


@pytest.fixture(scope="module")
def arrays():
    plan = plan_of(
        Appearance(BladedIris(6)), size=500, focal_px=6000.0, lens=library_lens(LENS),
        vignetting="LENS",
    )  # fmt: skip
    variants, arrays, _ = describe_look(plan)
    assert variants == ("TILES",)
    return arrays


def test_every_tile_holds_unit_light(arrays):
    sharp = arrays["sharp_tx"][..., 0].astype(float).sum(axis=(1, 2))
    sharp *= (2.0 * reach(BLURS[0]) / SHARP) ** 2
    assert sharp == pytest.approx(np.ones(FIELDS * DEPTHS), abs=1e-5)
    soft = arrays["soft_tx"][..., 0].astype(float).sum(axis=(1, 2)).reshape(3, -1)
    for blur, light in zip(BLURS[1:], soft, strict=True):
        light *= (2.0 * reach(blur) / SOFT) ** 2
        assert light == pytest.approx(np.ones(FIELDS * DEPTHS), abs=1e-5)


def test_a_six_sided_opening_leaves_the_same_of_an_axial_beam_every_sixth_turn(arrays):
    left = arrays["left_tx"].reshape(-1, FIELDS, AZIMUTHS + 1, DEPTHS, 4)[1, 0, :AZIMUTHS, :, 0]
    # Its area over that of the disc, or its density times the share of the light inside it.
    assert left == pytest.approx(np.full_like(left, 1.0 / np.pi), rel=0.25)
    turned = np.roll(left, AZIMUTHS // 6, axis=0)
    # Texels of tile and opening are squares.
    assert np.abs(left - turned).max() < 0.01 * left.max()
