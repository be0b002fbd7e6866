"""Focusing: by the whole lens and by a group."""

import math

import numpy as np
import pytest

from addon.errors import PrescriptionError
from addon.optics.focus import focused
from addon.optics.glass import REFERENCE_WAVELENGTH_NM
from addon.optics.paraxial import first_order, image_distance
from addon.optics.prescription import FocusGroup
from addon.optics.rays.trace import trace
from tests.optics.lenses import CROWN, lens, rays, surface, triplet

# Triplet: 1-2 front lens, 3 stop, 4-6 doublet.
FRONT, REAR, WHOLE = FocusGroup(1, 2), FocusGroup(4, 6), FocusGroup(1, 6)
INNER = FocusGroup(3, 4)


def internal():
    """A positive front, a negative lens that can move, and a positive rear."""
    return lens(
        surface(40.0, 4.0, CROWN, semi_diameter=9.0, is_stop=True),
        surface(-200.0, 9.0),
        surface(-70.0, 1.5, CROWN),
        surface(70.0, 9.0),
        surface(60.0, 4.0, CROWN),
        surface(-90.0, 50.0),
    )


def image_of(configuration, distance):
    return configuration.vertices[-1] + image_distance(configuration, distance)


@pytest.mark.parametrize("distance", [math.inf, 1.0e6, 1000.0, 300.0, 80.0])
@pytest.mark.parametrize("group", [None, FRONT, WHOLE])
def test_sensor_lies_at_the_image(distance, group):
    seen = focused(triplet(), distance, group)
    assert seen.sensor == pytest.approx(image_of(seen, distance), abs=1e-10)


def test_rays_near_the_axis_meet_on_the_sensor():
    seen = focused(internal(), 1500.0, INNER)
    fan = rays((0.0, 0.0, -1500.0), [(0.0, y, 1500.0) for y in (0.01, 0.02, 0.04)])
    heights = trace(seen, fan, REFERENCE_WAVELENGTH_NM).at_plane(seen.sensor)[:, 1]
    # Spherical aberration is of third order: millions of times less than the height at the lens.
    np.testing.assert_allclose(heights, 0.0, atol=1e-7)


def test_whole_lens_moves_by_newtons_equation():
    configuration = triplet()
    values = first_order(configuration)
    seen = focused(configuration, 1000.0)
    extension = seen.surfaces[-1].thickness - values.bfl
    assert extension == pytest.approx(values.efl**2 / (1000.0 + values.ffl), rel=1e-10)
    assert seen.surfaces[:-1] == configuration.surfaces[:-1]


@pytest.mark.parametrize("group", [None, FRONT, INNER, WHOLE])
def test_infinity_is_the_paraxial_focus(group):
    configuration = internal()
    seen = focused(configuration, math.inf, group)
    assert seen.surfaces[-1].thickness == pytest.approx(first_order(configuration).bfl, rel=1e-14)
    assert seen.surfaces[:-1] == configuration.surfaces[:-1]


def test_group_inside_moves_and_all_else_stays():
    configuration = internal()
    at_infinity = focused(configuration, math.inf, INNER)
    near = focused(configuration, 1500.0, INNER)
    assert near.sensor == pytest.approx(at_infinity.sensor, abs=1e-12)
    shift = near.surfaces[3].thickness - at_infinity.surfaces[3].thickness
    assert abs(shift) > 0.01
    before = near.surfaces[1].thickness - at_infinity.surfaces[1].thickness
    assert before == pytest.approx(-shift, abs=1e-13)
    for number in (1, 3, 5, 6):
        assert near.surfaces[number - 1] == at_infinity.surfaces[number - 1]


def test_front_group_moves_towards_the_scene():
    at_infinity, near = (focused(triplet(), d, FRONT) for d in (math.inf, 1000.0))
    assert near.surfaces[1].thickness > at_infinity.surfaces[1].thickness
    assert near.surfaces[2:] == at_infinity.surfaces[2:]


def test_group_of_all_surfaces_is_the_whole_lens():
    one, other = focused(triplet(), 700.0, WHOLE), focused(triplet(), 700.0)
    assert one.surfaces[-1].thickness == pytest.approx(other.surfaces[-1].thickness, rel=1e-12)


def test_nearest_distance_of_the_message_can_be_reached():
    with pytest.raises(PrescriptionError, match="out of reach of the focus group") as refused:
        focused(internal(), 60.0, INNER)
    nearest = float(str(refused.value).split("nearest distance is ")[1].split()[0])
    seen = focused(internal(), nearest * 1.0001, INNER)
    assert seen.sensor == pytest.approx(image_of(seen, nearest * 1.0001), abs=1e-9)
    assert min(s.thickness for s in seen.surfaces) >= 0.0
    with pytest.raises(PrescriptionError):
        focused(internal(), nearest * 0.999, INNER)


def test_whole_lens_tells_its_front_focus():
    with pytest.raises(PrescriptionError, match=f"{-first_order(triplet()).ffl:.6g} mm"):
        focused(triplet(), 5.0)


@pytest.mark.parametrize("distance", [0.0, -100.0, math.nan])
def test_distances_that_are_none_are_refused(distance):
    with pytest.raises(PrescriptionError, match="greater than 0"):
        focused(triplet(), distance)


def test_group_that_is_not_there_is_refused():
    with pytest.raises(PrescriptionError, match="has 1 to 6"):
        focused(triplet(), 1000.0, FocusGroup(5, 9))


def test_diverging_lens_has_no_sensor():
    front = lens(surface(-50.0, 2.0, CROWN, is_stop=True), surface(50.0, 40.0))
    for group in (None, FocusGroup(1, 2)):
        with pytest.raises(PrescriptionError):
            focused(front, 1000.0, group)
