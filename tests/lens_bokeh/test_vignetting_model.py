import numpy as np
import pytest

from addon.errors import InputError
from addon.lens_bokeh.look.vignetting_model import Rim, cat_eye, transmission
from addon.lens_bokeh.openings.masks import texel_centres

POINTS = texel_centres(256, 1.0)
TEXEL = 2.0 / 256


def open_area(rims, field):
    inside = np.clip(0.5 + (1.0 - np.hypot(POINTS[..., 0], POINTS[..., 1])) / TEXEL, 0.0, 1.0)
    return (transmission(rims, POINTS, field, TEXEL) * inside).sum() * TEXEL**2


def lens_area(distance):
    """Area common to two unit discs."""
    half = distance / 2.0
    return 2.0 * (np.arccos(half) - half * np.sqrt(1.0 - half**2))


def test_axial_beam_is_whole():
    assert np.all(transmission(cat_eye(0.8, 0.4), POINTS * 0.7, (0.0, 0.0)) == 1.0)


@pytest.mark.parametrize("field", [0.1, 0.25, 0.4])
def test_one_rim_leaves_the_area_common_to_two_discs(field):
    area = open_area((Rim(1.0, 1.5),), (field, 0.0))
    assert area == pytest.approx(lens_area(1.5 * field), rel=1e-3)


def test_front_and_rear_rim_make_a_cat_s_eye_along_the_field():
    mask = transmission(cat_eye(0.5, 0.4), POINTS, (0.4, 0.0), TEXEL)
    assert np.allclose(mask, mask[:, ::-1]) and np.allclose(mask, mask[::-1])
    open_ = mask > 0.5
    # Narrow along the field (1 - shift on either side), the full intersection across it.
    assert np.ptp(POINTS[open_][:, 0]) == pytest.approx(2.0 * 0.5, abs=2 * TEXEL)
    assert np.ptp(POINTS[open_][:, 1]) == pytest.approx(2.0 * np.sqrt(0.75), abs=2 * TEXEL)


def test_several_members_soften_the_edge():
    hard = transmission((Rim(1.0, 1.0),), POINTS, (0.5, 0.0))
    soft = transmission((Rim(1.0, 1.0, 4),), POINTS, (0.5, 0.0))
    row = soft[128]
    assert set(np.unique(hard[128])) <= {0.0, 0.5, 1.0}
    assert len(np.unique(row)) > 20
    rise = np.diff(row[: np.argmax(row >= 1.0)])
    assert np.all(rise >= 0.0) and rise.max() < 0.03


def test_wrong_rims_are_refused():
    for wrong in (dict(radius=0.0, shift=1.0), dict(radius=1.0, shift=np.inf)):
        with pytest.raises(InputError):
            Rim(**wrong)
    with pytest.raises(InputError):
        Rim(1.0, 1.0, 0)
    with pytest.raises(InputError):
        cat_eye(0.5, 0.0)
