"""Beams, aimed rays, real pupils and vignetting."""

import math
from dataclasses import replace

import numpy as np
import pytest

from addon.errors import PrescriptionError
from addon.lens_io.toml.toml_reader import read_lens
from addon.optics.glass import REFERENCE_WAVELENGTH_NM as NM
from addon.optics.paraxial import first_order
from addon.optics.rays.aiming import aim, chief_ray
from addon.optics.rays.beam import Beam
from addon.optics.rays.pupil import is_open, pupil_outline, pupil_rays, stop_outline
from addon.optics.rays.trace import trace
from addon.optics.rays.vignetting import coverage, vignetting
from tests.optics.lenses import CROWN, biconvex, lens, surface, symmetric, triplet

SOURCES = [Beam.from_infinity(a) for a in (0.0, 8.0, -8.0)] + [
    Beam.from_infinity(10.0, 30.0),
    Beam.from_point((0.0, 0.0, -300.0)),
    Beam.from_point((20.0, -40.0, -300.0)),
]


def two_rims(first=10.0, second=6.0, gap=20.0):
    """An empty tube: the overlap of two circles is known."""
    return lens(
        surface(math.inf, gap, semi_diameter=first),
        surface(math.inf, 30.0, semi_diameter=second, is_stop=True),
    )


def overlap(r1, r2, distance):
    """Area that two disks share (any geometry book)."""
    if distance <= abs(r1 - r2):
        return math.pi * min(r1, r2) ** 2
    if distance >= r1 + r2:
        return 0.0
    a = (distance**2 + r1**2 - r2**2) / (2.0 * distance * r1)
    b = (distance**2 + r2**2 - r1**2) / (2.0 * distance * r2)
    root = (r1 + r2) ** 2 - distance**2, distance**2 - (r1 - r2) ** 2
    return r1**2 * math.acos(a) + r2**2 * math.acos(b) - 0.5 * math.sqrt(root[0] * root[1])


@pytest.mark.parametrize("beam", SOURCES)
def test_beam_finds_its_rays_again(beam):
    random = np.random.default_rng(2)
    places = random.uniform(-20.0, 20.0, (50, 2))
    rays = beam.rays(places)
    np.testing.assert_allclose(np.linalg.norm(rays.directions, axis=1), 1.0, rtol=1e-14)
    for shift in (-100.0, 0.0, 70.0):
        found = beam.coordinates(rays.origins + shift * rays.directions)
        np.testing.assert_allclose(found, places, atol=1e-11)
    backwards = beam.miss(rays.origins, -rays.directions)
    np.testing.assert_allclose(backwards, 0.0, atol=1e-14)


def test_beam_from_infinity_runs_upwards():
    direction = Beam.from_infinity(30.0).axis
    np.testing.assert_allclose(direction, [0.0, 0.5, math.sqrt(0.75)], atol=1e-15)


def test_far_point_is_infinity():
    far = Beam.from_point((0.0, -math.sin(0.2) * 1e9, -math.cos(0.2) * 1e9))
    wanted = Beam.from_infinity(math.degrees(0.2))
    for name in ("axis", "across", "up"):
        np.testing.assert_allclose(getattr(far, name), getattr(wanted, name), atol=1e-14)


def test_solid_angle_of_a_disk():
    # 2 pi (1 - cos), by the weights of rays on a grid.
    tube = two_rims(first=30.0, second=15.0, gap=0.0)
    pupil = pupil_rays(tube, (0.0, 0.0, -40.0), grid=401)
    cosine = 40.0 / math.hypot(40.0, 15.0)
    # 401^2 cells: the edge is counted to about 1e-4.
    assert pupil.weights.sum() == pytest.approx(2.0 * math.pi * (1.0 - cosine), rel=5e-4)


@pytest.mark.parametrize("field", [0.0, 10.0, 20.0, 30.0, 35.0])
def test_vignetting_of_two_rims_is_the_overlap_of_disks(field):
    angle = math.radians(field)
    wanted = overlap(10.0, 6.0, 20.0 * math.tan(angle)) * math.cos(angle)
    found = vignetting(two_rims(), field)
    # 401^2 cells; slim overlaps have more edge for their area.
    assert found.area_passing == pytest.approx(wanted, rel=2e-3)
    assert found.area_stop_only == pytest.approx(math.pi * 36.0 * math.cos(angle), rel=1e-3)
    assert found.fraction_of_paraxial_pupil == pytest.approx(
        wanted / (math.pi * 36.0 * math.cos(angle)), abs=1e-3
    )


def test_outline_has_the_area_of_the_pupil():
    # A polygon of 256 sides in a circle lacks 1e-4 of its area.
    circle = pupil_outline(two_rims(), 0.0)
    assert circle.area == pytest.approx(math.pi * 36.0, rel=2e-4)
    np.testing.assert_allclose(np.hypot(*circle.points.T), 6.0, atol=1e-9)
    lune = pupil_outline(two_rims(), 25.0)
    angle = math.radians(25.0)
    wanted = overlap(10.0, 6.0, 20.0 * math.tan(angle)) * math.cos(angle)
    assert lune.area == pytest.approx(wanted, rel=5e-4)


def test_tiny_stop_is_not_overlooked():
    front = two_rims(first=400.0, second=0.02)
    assert pupil_outline(front, 50.0).area == pytest.approx(
        math.pi * 0.02**2 * math.cos(math.radians(50.0)), rel=2e-4
    )


def test_closed_pupil_is_no_error():
    beyond = 50.0
    assert not is_open(two_rims(), beyond)
    found = vignetting(two_rims(), beyond, grid=41)
    assert (found.area_passing, found.unvignetted_fraction) == (0.0, 0.0)
    assert pupil_outline(two_rims(), beyond).area == 0.0
    assert len(pupil_rays(two_rims(), beyond).rays) == 0


def test_coverage_is_where_the_disks_part():
    assert coverage(two_rims()) == pytest.approx(
        math.degrees(math.atan((10.0 + 6.0) / 20.0)), abs=0.3
    )
    half = coverage(two_rims(), share=0.5)
    angle = math.radians(half)
    seen = overlap(10.0, 6.0, 20.0 * math.tan(angle)) * math.cos(angle)
    assert seen == pytest.approx(0.5 * math.pi * 36.0, rel=0.01)


@pytest.mark.parametrize("beam", SOURCES)
def test_aimed_rays_hit_the_stop_where_they_should(beam):
    configuration = triplet()
    turn = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    targets = 7.0 * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    aimed = aim(configuration, beam, targets)
    assert aimed.found.all()
    hits = trace(configuration, beam.rays(aimed.coordinates), NM, clip=False, last=3).points
    np.testing.assert_allclose(hits[:, :2], targets, atol=1e-10)


@pytest.mark.parametrize("beam", SOURCES)
def test_chief_ray_goes_through_the_centre_of_the_stop(beam):
    configuration = triplet()
    chief = chief_ray(configuration, beam)
    hit = trace(configuration, beam.rays(chief[None]), NM, clip=False, last=3).points[0]
    np.testing.assert_allclose(hit[:2], 0.0, atol=1e-11)


def test_chief_ray_near_the_axis_aims_at_the_paraxial_pupil():
    configuration = triplet()
    field = 1.0e-3
    chief = chief_ray(configuration, Beam.from_infinity(math.degrees(field)))
    # It crosses the axis at the pupil: v = -z sin(field) in the plane across the beam.
    wanted = -first_order(configuration).enp_z * math.sin(field)
    assert chief[1] == pytest.approx(wanted, rel=1e-5)


@pytest.mark.parametrize("number", [1, 2])
def test_stop_may_be_the_first_or_the_last_surface(number):
    both = [surface(50.0, 4.0, CROWN), surface(-50.0, 48.0)]
    both[number - 1] = replace(both[number - 1], semi_diameter=5.0, is_stop=True)
    configuration = lens(*both)
    outline = pupil_outline(configuration, 5.0)
    paraxial = math.pi * first_order(configuration).enp_diameter ** 2 / 4.0
    assert outline.area == pytest.approx(paraxial, rel=0.02)


def test_pupil_of_a_slow_lens_is_the_paraxial_one():
    configuration = biconvex(radius=500.0)
    rim = replace(configuration.surfaces[0], semi_diameter=2.0)
    slow = replace(configuration, surfaces=(rim, configuration.surfaces[1]))
    assert pupil_rays(slow, 0.0, grid=401).weights.sum() == pytest.approx(math.pi * 4.0, rel=5e-4)


def test_pupil_rays_get_through():
    configuration = triplet()
    for source in (0.0, 12.0, (0.0, -30.0, -200.0)):
        pupil = pupil_rays(configuration, source, grid=61)
        assert len(pupil.rays) == len(pupil.weights) > 1000
        assert trace(configuration, pupil.rays, NM).passed.all()


def test_pupil_of_a_round_lens_turns_with_the_field():
    configuration = triplet()
    up = pupil_rays(configuration, Beam.from_infinity(12.0, 90.0), grid=61)
    aside = pupil_rays(configuration, Beam.from_infinity(12.0, 0.0), grid=61)
    np.testing.assert_allclose(aside.box, up.box, atol=1e-9)
    assert aside.weights.sum() == pytest.approx(up.weights.sum(), rel=1e-3)


def test_pupil_of_a_cylinder_is_an_ellipse():
    # In front of the stop a cylinder enlarges it across its axis only.
    bar = lens(
        surface(60.0, 4.0, CROWN, semi_diameter=20.0, curved_along="x"),
        surface(math.inf, 15.0, semi_diameter=20.0),
        surface(math.inf, 60.0, semi_diameter=3.0, is_stop=True),
    )
    u0, u1, v0, v1 = pupil_outline(bar, 0.0).box
    wide, high = (first_order(bar, meridian="x").enp_diameter, 6.0)
    # The stop is small against the radius: aberrations are below a percent.
    assert u1 - u0 == pytest.approx(wide, rel=0.01)
    assert v1 - v0 == pytest.approx(high, rel=1e-4)


def test_symmetric_lens_has_no_distortion_at_magnification_minus_one():
    # All odd errors cancel for an object that is imaged at its own size.
    configuration = symmetric()
    values = first_order(configuration)
    distance = values.efl - values.ffl
    sensor = configuration.vertices[-1] + values.bfl + values.efl
    for height in (2.0, 5.0, 9.0):
        beam = Beam.from_point((0.0, height, -distance))
        chief = chief_ray(configuration, beam)
        image = trace(configuration, beam.rays(chief[None]), NM, clip=False).at_plane(sensor)
        assert image[0, 1] == pytest.approx(-height, rel=1e-10)


def test_fisheye_is_aimed_where_its_paraxial_pupil_is_empty(shared):
    prescription = read_lens(shared / "lenses" / "fisheye-16mm-f2.8.toml").prescription
    configuration = prescription.configuration()
    for field in (60.0, 85.0):
        assert vignetting(configuration, field, grid=41).fraction_of_paraxial_pupil == 0.0
        outline = stop_outline(configuration, field, 64)
        beam = Beam.from_infinity(field)
        chief = beam.rays(outline.centre[None])
        hit = trace(configuration, chief, NM, clip=False, last=configuration.stop).points[0]
        np.testing.assert_allclose(hit[:2], 0.0, atol=1e-10)
        radius = configuration.surfaces[configuration.stop - 1].semi_diameter
        edge = trace(
            configuration, beam.rays(outline.points), NM, clip=False, last=configuration.stop
        ).points
        np.testing.assert_allclose(np.hypot(*edge[:, :2].T), radius, atol=1e-8)


@pytest.mark.parametrize("field", [90.0, -120.0, math.nan])
def test_beams_from_behind_are_refused(field):
    with pytest.raises(PrescriptionError, match="below 90"):
        Beam.from_infinity(field)


@pytest.mark.parametrize("point", [(0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (math.inf, 0.0, -1.0)])
def test_points_behind_the_lens_are_refused(point):
    with pytest.raises(PrescriptionError, match="in front of the lens"):
        Beam.from_point(point)
