from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from addon.errors import InputError
from addon.lens_bokeh.look.appearance import Appearance, Diffraction
from addon.lens_bokeh.look.grain import Grain
from addon.lens_bokeh.look.onion import OnionRings
from addon.lens_bokeh.look.sprite import sprite
from addon.lens_bokeh.look.vignetting_model import cat_eye
from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_bokeh.openings.pictures import PictureIris


@dataclass(frozen=True)
class Row:
    """What a sprite reads of a profile's row."""

    density: np.ndarray


def row(channels=1):
    radius = (np.arange(64) + 0.5) / 64
    return Row(np.stack([1.0 + 3.0 * radius ** (c + 2) for c in range(channels)], axis=-1))


RINGING = Diffraction(0.7, (620.0, 540.0, 460.0), ((1, 0, 0), (0, 1, 0), (0, 0, 1)))


@settings(max_examples=25)
@given(
    blades=st.sampled_from([0, 3, 6, 9]),
    grain=st.booleans(),
    onion=st.booleans(),
    rims=st.booleans(),
    ringing=st.booleans(),
    channels=st.sampled_from([None, 1, 3]),
    upright=st.booleans(),
    ratio=st.floats(0.5, 2.0),
)
def test_energy_of_any_sprite_is_one(blades, grain, onion, rims, ringing, channels, upright, ratio):
    appearance = Appearance(
        iris=BladedIris(blades, 0.2, 0.3),
        grain=Grain(0.3, 0.1, 5) if grain else None,
        onion=OnionRings() if onion else None,
        rims=cat_eye(0.6, 0.4, 4) if rims else (),
        diffraction=RINGING if ringing else None,
        anamorphic_ratio=ratio,
        edge=0.5,
    )
    made = sprite(
        appearance,
        48,
        row=None if channels is None else row(channels),
        upright=upright,
        chief=(0.2, 0.1),
        fresnel_number=20.0,
        extent=1.2,
    )
    assert made.shape == (48, 48, 3 if ringing or channels == 3 else 1)
    assert np.isfinite(made).all() and made.min() >= 0.0
    # The bar is 1e-4; rounding is all there is.
    assert np.allclose(made.sum(axis=(0, 1)), 1.0, atol=1e-12)


def test_behind_focus_the_opening_is_upright_and_in_front_turned():
    arrow = np.zeros((32, 32))
    arrow[16:, 10:14] = 1.0  # up, a little left
    appearance = Appearance(iris=PictureIris(arrow))
    behind = sprite(appearance, 64, upright=True)[..., 0]
    front = sprite(appearance, 64, upright=False)[..., 0]
    assert np.allclose(front, behind[::-1, ::-1])
    y, x = np.argwhere(behind > 0).mean(axis=0)
    assert y > 40 and x < 30


def test_an_even_disc_has_the_density_of_a_disc():
    made = sprite(size=101)[..., 0]
    assert made[50, 50] == pytest.approx((2.0 / 101) ** 2 / np.pi, rel=2e-3)
    assert np.allclose(made, made.T) and np.allclose(made, made[::-1])


def test_a_row_shapes_the_disc():
    made = sprite(size=150, row=row())[..., 0]
    density = made / (2.0 / 150) ** 2
    # Over the disc the row integrates to pi (1 + 3 / 2).
    assert density[75, 75] == pytest.approx(1.0 / (np.pi * 2.5), rel=0.02)
    assert density[75, 75 + 70] / density[75, 75] == pytest.approx(1.0 + 3.0 * 0.94**2, rel=0.03)


def test_edge_runs_from_cream_to_soap_bubble_and_turns_round_in_front():
    def rim_over_core(edge, upright=True):
        made = sprite(Appearance(edge=edge), 128, upright=upright)[..., 0]
        return made[64, 64 + 58] / made[64, 64]

    values = [rim_over_core(edge) for edge in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    assert np.all(np.diff(values) > 0.0) and values[2] == pytest.approx(1.0)
    assert rim_over_core(0.7, upright=False) == pytest.approx(rim_over_core(-0.7))


def test_anamorphic_ratio_divides_the_width():
    made = sprite(Appearance(anamorphic_ratio=2.0), 200)[..., 0]
    lit = made > 0.5 * made.max()
    assert lit.any(axis=0).sum() == pytest.approx(100, abs=2)
    assert lit.any(axis=1).sum() == pytest.approx(200, abs=2)


def test_diffraction_needs_a_defocus_and_rings_along_the_rim():
    appearance = Appearance(diffraction=Diffraction())
    assert np.array_equal(sprite(appearance, 64), sprite(Appearance(), 64))
    ringing = sprite(appearance, 200, fresnel_number=60.0, extent=1.2)[..., 0]
    sharp = sprite(Appearance(), 200, extent=1.2)[..., 0]
    assert ringing.max() > 1.2 * sharp.max()
    # Light reaches beyond the shadow.
    assert ringing[100, 190] > 0.0 and sharp[100, 190] == 0.0


def test_analytic_cat_s_eye_points_along_the_chief_ray():
    appearance = Appearance(rims=cat_eye(0.8, 0.4))
    sideways = sprite(appearance, 96, chief=(0.4, 0.0))[..., 0]
    assert np.allclose(sprite(appearance, 96, chief=(0.0, 0.4))[..., 0], sideways.T)
    lit = sideways > 0
    assert lit.any(axis=0).sum() < 0.5 * lit.any(axis=1).sum()


def test_a_closed_sprite_is_dark_and_finite():
    closed = sprite(Appearance(rims=cat_eye(5.0, 0.1)), 32, chief=(1.0, 0.0))
    assert np.all(closed == 0.0)


def test_wrong_appearances_are_refused():
    with pytest.raises(InputError, match="anamorphic"):
        Appearance(anamorphic_ratio=0.0)
    with pytest.raises(InputError, match="edge"):
        Appearance(edge=2.0)
    with pytest.raises(InputError, match="strength"):
        Diffraction(2.0)
    with pytest.raises(InputError, match="weights"):
        Diffraction(1.0, (500.0, 600.0), ((1.0,),))
