"""Tiles of a real lens: their light, and what an opening leaves of it."""

import numpy as np
import pytest

from addon.engine.bokeh.lens_profiles import lens_pupil
from addon.engine.bokeh.look import describe_look
from addon.lens_bokeh.look.appearance import Appearance
from addon.lens_bokeh.look.deposit import deposit, open_weights
from addon.lens_bokeh.look.pupil_beams import PupilBeams
from addon.lens_bokeh.look.splat_pupil import (
    AZIMUTHS,
    BLURS,
    DEPTHS,
    FIELDS,
    SHARP,
    SOFT,
    reach,
)
from addon.lens_bokeh.look.tile_drawing import blur_matrix, blurred, draw_tile
from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_bokeh.tables.pupil_beam import beam_from_point
from tests.splat_pictures import library_lens, plan_of

LENS = "double-gauss-50mm-f2"


@pytest.fixture(scope="module")
def arrays():
    plan = plan_of(
        Appearance(BladedIris(6)), size=500, focal_px=6000.0, lens=library_lens(LENS),
        vignetting="LENS",
    )  # fmt: skip
    variants, arrays, _ = describe_look(plan)
    assert variants == ("TILES", "OPENED")
    return arrays


def test_every_tile_holds_unit_light(arrays):
    sharp = arrays["sharp_tx"][..., 0].astype(float).sum(axis=(1, 2))
    sharp *= (2.0 * reach(BLURS[0]) / SHARP) ** 2
    assert sharp == pytest.approx(np.ones(FIELDS * DEPTHS), abs=1e-5)
    soft = arrays["soft_tx"][..., 0].astype(float).sum(axis=(1, 2)).reshape(len(BLURS) - 1, -1)
    for blur, light in zip(BLURS[1:], soft, strict=True):
        light *= (2.0 * reach(blur) / SOFT) ** 2
        assert light == pytest.approx(np.ones(FIELDS * DEPTHS), abs=1e-5)


def test_a_six_sided_opening_leaves_the_same_of_an_axial_beam_every_sixth_turn(arrays):
    left = arrays["left_tx"].reshape(-1, 3, FIELDS, AZIMUTHS + 1, DEPTHS, 4)
    left = left[1, 1, 0, :AZIMUTHS, :, 0]
    # Its area over that of the disc, or its density times the share of the light inside it.
    assert left == pytest.approx(np.full_like(left, 1.0 / np.pi), rel=0.25)
    turned = np.roll(left, AZIMUTHS // 6, axis=0)
    # Texels of tile and opening are squares.
    assert np.abs(left - turned).max() < 0.01 * left.max()


def test_an_even_opening_is_not_laid_over_the_tiles():
    plan = plan_of(
        Appearance(), size=500, focal_px=6000.0, lens=library_lens(LENS), vignetting="LENS"
    )
    variants, arrays, _ = describe_look(plan)
    assert variants == ("TILES",)
    assert set(arrays) == {"sharp_tx", "soft_tx", "places_tx"}


def test_blurs_of_a_mirrored_tile_are_those_of_all_of_it():
    half = np.random.default_rng(3).random((3, SHARP, SHARP), dtype=np.float32)
    half[1:] *= half[0]
    mirrored = half[..., ::-1].copy()
    mirrored[1] = mirrored[0] - mirrored[1]
    tile = half + mirrored
    matrix = blur_matrix(BLURS[2], SHARP, reach(BLURS[0]), SOFT, reach(BLURS[2]))
    (found,) = blurred(tile, [matrix])
    expected = matrix @ tile.astype(float) @ matrix.T
    # Single precision.
    assert np.abs(found - expected).max() < 1e-5 * expected.max()


def smoothed(picture):
    """Means over 3 x 3 texels, of unit sum."""
    shifts = [np.roll(picture, (i, j), axis=(0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    return np.mean(shifts, axis=0) / picture.sum()


@pytest.mark.parametrize("field", [0, 5, 8])
@pytest.mark.parametrize("distance_mm", [600.0, 1900.0, 9000.0])
def test_a_tile_is_the_pattern_of_its_point(aplanat_bpy, field, distance_mm):
    lens = library_lens(LENS)
    tables = lens_pupil(lens)
    # The image of what is 2 m away is about here.
    pupil, shift = 20.0, 1.28
    beams = PupilBeams(tables, pupil, lens.f_number, 0.3, 1.0 / 500.0)
    list(beams.traced())
    (grid,), _ = beams.grids(field, [1.0 / distance_mm], shift)
    tile, (middle, half_x, half_y) = draw_tile(grid, SHARP, reach(BLURS[0]))
    height = beams.tangents[field] * distance_mm
    fine = beam_from_point(tables, height, distance_mm - pupil, lens.f_number).refined(500)
    light, landing = open_weights(fine), fine.landing(shift)
    low, high = (landing[..., 1][light > 0.0].min(), landing[..., 1][light > 0.0].max())
    assert high - low == pytest.approx(2.0 * half_y, rel=0.02)
    at = (landing - (0.0, 0.5 * (low + high))) / (half_x, half_y) / reach(BLURS[0])
    wanted = smoothed(deposit((at + 1.0) * 0.5 * SHARP, light, SHARP))
    # Half of a texel at the rim is a hundredth of the light; caustics are sharper than that.
    assert np.abs(smoothed(tile[0]) - wanted).sum() < 0.06


def test_a_draft_has_the_pattern_of_the_axis():
    plan = plan_of(lens=library_lens(LENS), vignetting="LENS")
    plan.bokeh.draft = True
    variants, arrays, _ = describe_look(plan)
    assert variants == ("PROFILE",)
    assert "sharp_tx" not in arrays
