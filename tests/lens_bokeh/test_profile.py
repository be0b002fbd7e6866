"""Rows and tables of the bokeh profile."""

import numpy as np
import pytest

from addon.errors import InputError, RenderCancelledError
from addon.lens_bokeh.tables.mapping import pattern_row
from addon.lens_bokeh.tables.profile import make_profile, profile_table, ring_areas
from addon.lens_io.toml.toml_reader import read_lens
from addon.optics.fresnel import Coating


@pytest.fixture(scope="module")
def lens(shared):
    return read_lens(shared / "lenses/double-gauss-50mm-f2.toml").prescription.configuration()


@pytest.fixture(scope="module")
def gray(lens):
    return make_profile(lens, name="Gauss", chromatic=False)


@pytest.fixture(scope="module")
def rgb(lens):
    return make_profile(lens, name="Gauss")


def test_energy_of_every_row_is_one(gray, rgb):
    for profile in (gray, rgb):
        table = profile_table(profile, rows=64, radii=128)
        # The bar is 1e-4; what is left is single precision.
        np.testing.assert_allclose(table.energies, 1.0, atol=1e-6)
        assert np.isfinite(table.density).all() and (table.density >= 0.0).all()


def test_table_reaches_from_the_last_surface_to_as_far_behind_the_sensor(gray):
    table = profile_table(gray, rows=9, radii=16)
    state = gray.states[0]
    assert table.planes[0] == pytest.approx(state.last_vertex)
    assert table.planes[4] == pytest.approx(state.ray_map.plane)
    # The image of the reference object is at u = d F / (d - F) behind H'.
    efl = state.first_order.efl
    image = state.image_plane(1000.0) - state.last_vertex - state.first_order.h_prime
    assert image == pytest.approx(1000.0 * efl / (1000.0 - efl))
    assert table.image_distances[4] == pytest.approx(efl)


def test_closed_stop_far_from_focus_gives_an_even_disk_of_paraxial_size(gray):
    row = pattern_row(gray, 500.0, 5000.0, 45.0, radii=64)
    even = 1.0 / np.pi
    # Aberrations fall with the square of the opening: here they are a thousandth.
    np.testing.assert_allclose(row.density[1:, 0], even, rtol=2e-2)
    order = gray.states[0].first_order
    coc = order.enp_diameter / 2.0 * gray.stop_fraction(45.0)
    near, focus = 1.0 / 500.0, 1.0 / 5000.0
    # C = E F (d - d_f) / ((d_f - F) d) with E in the pupil, not in H: 2 % here.
    paper = coc * order.efl * (near - focus) / (1.0 - order.efl * focus)
    assert row.extent == pytest.approx(paper, rel=0.02)


def test_flat_spectrum_is_white(rgb):
    for distance in (700.0, 2000.0, 9000.0):
        np.testing.assert_allclose(pattern_row(rgb, distance, 2000.0, 2.0).energy, 1.0, atol=1e-9)


def test_chromatic_pattern_has_colored_edges(rgb):
    density = pattern_row(rgb, 900.0, 2000.0, 2.0, radii=256).density
    spread = np.ptp(density, axis=1) / density.max(axis=1)
    assert spread[:128].max() < 0.1 < spread[-8:].max()


def test_pattern_before_and_behind_focus_trade_rim_and_core(gray):
    # The double Gauss is overcorrected at the rim of its pupil: bright rings lie on one side only.
    front = pattern_row(gray, 1500.0, 2000.0, 2.0, radii=64).density[:, 0]
    back = pattern_row(gray, 3000.0, 2000.0, 2.0, radii=64).density[:, 0]
    assert abs(np.log(front[-8:].mean() / front[:32].mean())) > 0.2
    assert (front[-8:].mean() / front[:32].mean() - 1.0) * (
        back[-8:].mean() / back[:32].mean() - 1.0
    ) < 0.0


def test_fresnel_losses_dim_and_a_coating_gives_light_back(lens):
    bare = make_profile(lens, chromatic=False, fresnel=True)
    coated = make_profile(lens, chromatic=False, fresnel=True, coating=Coating())
    clear = make_profile(lens, chromatic=False)
    brought = [
        pattern_row(profile, 1500.0, 2000.0, 2.0).brought[0] for profile in (bare, coated, clear)
    ]
    # Eight faces to air lose about 4 to 6 % each, a quarter wave less than 2 %.
    assert 0.5 < brought[0] / brought[2] < 0.75
    assert 0.85 < brought[1] / brought[2] < 0.97


def test_row_areas_fill_the_unit_disk():
    assert ring_areas(100).sum() == pytest.approx(np.pi)


def test_progress_rises_to_one(lens):
    told = []
    make_profile(lens, wavelengths_nm=[450.0, 550.0, 620.0], progress=told.append)
    assert told[0] == 0.0 and told[-1] == 1.0 and told == sorted(told)


def test_cancelling_ends_the_work(lens):
    asked = iter([False, False, True])
    with pytest.raises(RenderCancelledError):
        make_profile(lens, cancelled=lambda: next(asked))


def test_f_number_that_is_not_positive_is_refused(gray):
    with pytest.raises(InputError, match="f-number"):
        pattern_row(gray, 1000.0, 2000.0, 0.0)
