"""The ray map against rays traced one by one."""

import numpy as np
import pytest

from addon.errors import FocusError, PrescriptionError
from addon.lens_bokeh.tables.focus_state import state_at, trace_states
from addon.lens_io.toml.toml_reader import read_lens
from addon.optics.focus import focused
from addon.optics.glass import AIR, REFERENCE_WAVELENGTH_NM, ConstantGlass
from addon.optics.paraxial import first_order, image_distance
from addon.optics.prescription import Configuration, FocusGroup, Surface
from addon.optics.rays.trace import Rays, trace

WAVELENGTHS = np.array([480.0, REFERENCE_WAVELENGTH_NM])
NAMES = ("double-gauss-50mm-f2", "petzval-51mm-f1.4", "retrofocus-35mm-f2.5", "fisheye-16mm-f2.8")


@pytest.fixture(scope="module")
def lenses(shared):
    folder = shared / "lenses"
    return {
        name: read_lens(folder / f"{name}.toml").prescription.configuration()
        for name in (*NAMES, "sonnar-50mm-f1.5")
    }


def state_of(configuration):
    nearness, states = trace_states(configuration, WAVELENGTHS)
    assert len(nearness) == 1
    return states[0]


def rays_from(configuration, distance, count=4001, reach=1.1):
    """A fan from an axial point before H, even over the height in the entrance pupil."""
    order = first_order(configuration)
    slopes = np.linspace(0.0, reach, count) * order.enp_diameter / 2.0
    slopes /= distance - order.h + order.enp_z
    origins = np.tile([0.0, 0.0, order.h - distance], (count, 1))
    directions = np.stack([np.zeros(count), slopes, np.ones(count)], axis=-1)
    return Rays(origins, directions / np.linalg.norm(directions, axis=1, keepdims=True))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("distance", [400.0, 1234.0, 30000.0])
def test_rays_lie_where_traced_ones_do(lenses, name, distance):
    state = state_of(lenses[name])
    ray_map = state.ray_map
    heights, slopes, radii = ray_map.rays(state.vergence(distance), 1.0, 101)
    for i, wavelength in enumerate(WAVELENGTHS):
        traced = trace(lenses[name], rays_from(lenses[name], distance), wavelength)
        rays = rays_from(lenses[name], distance)
        # Solid angle over V^2 tells which ray it is: pi g^2 = 2 pi (1 - cos) D^2.
        span = distance - state.first_order.h + ray_map.pupil
        told = span * np.sqrt(2.0 * (1.0 - rays.directions[:, 2]))
        passed = traced.passed
        y = traced.at_plane(ray_map.plane)[passed, 1]
        t = traced.directions[passed, 1] / traced.directions[passed, 2]
        # Linear between 4000 rays; aberrations of some 0.1 mm are told to a thousandth and better.
        np.testing.assert_allclose(
            np.interp(radii[i, :-1], told[passed], y), heights[i, :-1], atol=2e-5
        )
        np.testing.assert_allclose(
            np.interp(radii[i, :-1], told[passed], t), slopes[i, :-1], atol=1e-6
        )
        # The last ray of the map is the last that the rims let through.
        step = told[1]
        assert radii[i, -1] == pytest.approx(told[passed].max(), abs=1.5 * step)


def test_stopping_down_ends_where_the_closed_stop_does(lenses):
    lens = lenses["double-gauss-50mm-f2"]
    state = state_of(lens)
    for f_number in (4.0, 8.0):
        closed = lens.stopped_down(f_number)
        rays = rays_from(lens, 700.0, count=20001)
        passed = trace(closed, rays, REFERENCE_WAVELENGTH_NM).passed
        span = 700.0 - state.first_order.h + state.ray_map.pupil
        told = span * np.sqrt(2.0 * (1.0 - rays.directions[:, 2]))
        _, _, radii = state.ray_map.rays(state.vergence(700.0), lens.f_number / f_number)
        assert radii[1, -1] == pytest.approx(told[passed].max(), abs=1.5 * told[1])


def test_pupil_that_a_closed_stop_blocks_in_a_ring_keeps_its_outer_part(lenses):
    # In this lens rays turn back in the stop before the pupil ends: a slightly closed stop blocks
    # a ring, and what lies outside of it goes through again.
    lens = lenses["sonnar-50mm-f1.5"]
    state = state_of(lens)
    closed = lens.stopped_down(lens.f_number / 0.86)
    rays = rays_from(lens, 300.0, count=40001)
    passed = trace(closed, rays, REFERENCE_WAVELENGTH_NM).passed
    assert np.count_nonzero(np.diff(passed.astype(int))) == 3
    energy = 2.0 * (1.0 - rays.directions[:, 2])
    span = 300.0 - state.first_order.h + state.ray_map.pupil
    expected = span**2 * np.diff(energy)[passed[1:]].sum()
    _, _, radii = state.ray_map.rays(state.vergence(300.0), 0.86)
    assert radii[1, -1] ** 2 == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_focus_plane_is_the_paraxial_image(lenses, name):
    state = state_of(lenses[name])
    order = state.first_order
    for distance in (500.0, 2000.0, np.inf):
        expected = state.last_vertex + image_distance(lenses[name], distance - order.h)
        assert state.image_plane(distance) == pytest.approx(expected, abs=1e-9)


def test_focus_within_the_focal_length_is_refused(lenses):
    with pytest.raises(FocusError, match="focal length"):
        state_of(lenses["double-gauss-50mm-f2"]).image_plane(40.0)


def test_focus_group_between_its_states_is_the_traced_lens(lenses):
    lens = lenses["double-gauss-50mm-f2"]
    # The front half alone: a hard case, its focal length changes by a tenth down to 1.5 m.
    group = FocusGroup(1, 5)
    nearness, states = trace_states(lens, WAVELENGTHS[1:], focus_group=group)
    for distance in (1500.0, 5000.0):
        state = state_at(nearness, states, distance)
        direct = focused(lens, distance - state.first_order.h, group)
        assert state.first_order.efl == pytest.approx(first_order(direct).efl, rel=1e-6)
        assert state.image_plane(distance) == pytest.approx(direct.sensor, abs=1e-4)
        alone = state_of(direct)
        vergence = state.vergence(1500.0)
        ours = state.ray_map.rays(vergence, 0.9, 33)
        theirs = alone.ray_map.rays(vergence, 0.9, 33)
        shift = direct.sensor - state.ray_map.plane
        assert state.ray_map.plane == pytest.approx(alone.ray_map.plane, abs=1e-4)
        across = [h[-1] + shift * s[-1] for h, s, _ in (ours, theirs)]
        np.testing.assert_allclose(across[0], across[1], atol=2e-5)


def test_focus_group_out_of_reach_names_the_nearest_distance(lenses):
    nearness, states = trace_states(
        lenses["double-gauss-50mm-f2"], WAVELENGTHS[1:], focus_group=FocusGroup(1, 5)
    )
    with pytest.raises(FocusError, match="nearest is"):
        state_at(nearness, states, 60.0)


def test_lens_that_lets_no_ray_through_is_refused():
    front = Surface(50.0, 5.0, 10.0, ConstantGlass(1.5))
    back = Surface(-50.0, 50.0, 1e-9, AIR)
    stop = Surface(np.inf, 5.0, 5.0, AIR, is_stop=True)
    with pytest.raises(PrescriptionError, match="near the axis"):
        trace_states(Configuration((stop, front, back), 50.0, 5.0, 20.0), WAVELENGTHS)
