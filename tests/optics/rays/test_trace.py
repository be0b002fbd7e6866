"""Laws of refraction, stigmatic surfaces, and what becomes of rays that fail."""

import math
from dataclasses import replace

import numpy as np
import pytest

from addon.errors import PrescriptionError
from addon.optics.glass import ConstantGlass
from addon.optics.media import indices
from addon.optics.rays import trace as tracing
from addon.optics.rays.trace import Rays, RayStatus, trace
from addon.optics.surfaces import normal
from tests.optics.lenses import (
    CROWN,
    FLINT,
    biconvex,
    lens,
    parallel,
    random_rays,
    rays,
    surface,
    triplet,
)

NM = 550.0


def test_snells_law_holds_at_every_surface():
    configuration = triplet()
    fan = random_rays()
    media = indices(configuration, NM)
    for number, one in enumerate(configuration.surfaces, 1):
        before = trace(configuration, fan, NM, clip=False, last=number - 1)
        behind = trace(configuration, fan, NM, clip=False, last=number)
        good = behind.reached
        at = behind.points[good] - [0.0, 0.0, configuration.vertices[number - 1]]
        axis = normal(one, at[:, 0], at[:, 1])
        # n sin(i) and the plane of incidence at once: n (d x N) does not change.
        first = media[number - 1] * np.cross(before.directions[good], axis)
        second = media[number] * np.cross(behind.directions[good], axis)
        np.testing.assert_allclose(second, first, atol=1.0e-14)
        assert (np.sum(behind.directions[good] * axis, axis=1) > 0.0).all()


def test_directions_stay_unit_vectors():
    traced = trace(triplet(), random_rays(), NM, clip=False)
    np.testing.assert_allclose(np.linalg.norm(traced.directions, axis=1), 1.0, rtol=1.0e-14)


@pytest.mark.parametrize("aspheric", [False, True])
def test_light_goes_back_the_way_it_came(aspheric):
    configuration = triplet()
    if aspheric:
        first = replace(configuration.surfaces[0], conic=-0.4, asphere=((4, 2e-6), (6, 1e-9)))
        configuration = replace(configuration, surfaces=(first, *configuration.surfaces[1:]))
    fan = random_rays(spread=5.0)
    there = trace(configuration, fan, NM)
    passed = there.passed
    assert passed.sum() > 100
    turned = Rays(there.points[passed], -there.directions[passed])
    back = trace(configuration, turned, NM, backwards=True)
    assert back.passed.all()
    np.testing.assert_allclose(-back.directions, fan.directions[passed], atol=1.0e-13)
    away = back.points - fan.origins[passed]
    np.testing.assert_allclose(np.cross(away, fan.directions[passed]), 0.0, atol=1.0e-11)


def test_mirrored_rays_stay_mirrored():
    configuration, fan = triplet(), random_rays()
    turned = trace(configuration, fan, NM).at_plane(60.0)
    flip = np.array([-1.0, -1.0, 1.0])
    mirrored = trace(configuration, Rays(fan.origins * flip, fan.directions * flip), NM)
    np.testing.assert_allclose(mirrored.at_plane(60.0), -turned, atol=1.0e-12)


def test_plane_plate_only_shifts_a_ray():
    plate = lens(surface(math.inf, 10.0, CROWN, is_stop=True), surface(math.inf, 5.0))
    angle = math.radians(30.0)
    way = (0.0, math.sin(angle), math.cos(angle))
    traced = trace(plate, rays((0.0, -3.0, 0.0), way), NM)
    np.testing.assert_allclose(traced.directions[0], way, atol=1.0e-15)
    # Shift across the ray, any optics book: t sin(a - b) / cos(b).
    inside = math.asin(math.sin(angle) / 1.5168)
    shift = 10.0 * math.sin(angle - inside) / math.cos(inside)
    straight = -3.0 + 20.0 * math.tan(angle)
    found = traced.at_plane(20.0)[0, 1]
    assert found == pytest.approx(straight - shift / math.cos(angle), abs=1.0e-13)


def test_ellipsoid_of_eccentricity_1_over_n_focuses_parallel_light_inside_the_glass():
    # Descartes: conic = -1 / n^2, focus at n R / (n - 1).
    n = 1.5168
    front = lens(surface(20.0, 58.0, CROWN, conic=-1.0 / n**2, semi_diameter=18.0, is_stop=True))
    traced = trace(front, parallel(np.linspace(-17.0, 17.0, 35)), NM)
    assert traced.passed.all()
    focus = n * 20.0 / (n - 1.0)
    np.testing.assert_allclose(traced.at_plane(focus)[:, 1], 0.0, atol=1.0e-12)


def test_plano_hyperbolic_lens_has_no_spherical_aberration():
    # Descartes: conic = -n^2 behind a flat front, focus at R / (n - 1).
    n = 1.5168
    single = lens(
        surface(math.inf, 9.0, CROWN, semi_diameter=15.0, is_stop=True),
        surface(-25.0, 48.0, conic=-(n**2), semi_diameter=15.0),
    )
    traced = trace(single, parallel(np.linspace(-14.0, 14.0, 29)), NM)
    assert traced.passed.all()
    focus = 9.0 + 25.0 / (n - 1.0)
    np.testing.assert_allclose(traced.at_plane(focus)[:, 1], 0.0, atol=1.0e-12)


def test_aplanatic_points_of_a_sphere():
    # Abbe: all light towards a point R n2 / n1 behind the centre goes to R n1 / n2.
    n = 1.5168
    ball = lens(surface(-20.0, 5.0, semi_diameter=19.9, is_stop=True))
    start = -20.0 - 20.0 / n
    angles = np.radians(np.linspace(-35.0, 35.0, 15))
    way = np.stack([0.0 * angles, np.sin(angles), np.cos(angles)], axis=-1)
    inside = replace(ball, surfaces=(surface(math.inf, 0.0, CROWN, 99.0), *ball.surfaces))
    traced = trace(inside, rays((0.0, 0.0, start), way), NM, first=2)
    assert traced.passed.all()
    image = -20.0 - 20.0 * n
    np.testing.assert_allclose(traced.at_plane(image)[:, 1], 0.0, atol=1.0e-11)


def test_cylinder_bends_in_one_meridian_only():
    bar = lens(surface(30.0, 5.0, CROWN, curved_along="x", is_stop=True), surface(math.inf, 50.0))
    ball = lens(surface(30.0, 5.0, CROWN, is_stop=True), surface(math.inf, 50.0))
    fan = random_rays(spread=6.0, slope=0.0)
    seen = trace(bar, fan, NM)
    np.testing.assert_allclose(seen.directions[:, 1], 0.0, atol=1.0e-15)
    across = rays(fan.origins * (1.0, 0.0, 1.0), (0.0, 0.0, 1.0))
    wanted = trace(ball, across, NM)
    np.testing.assert_allclose(seen.directions[:, 0], wanted.directions[:, 0], atol=1.0e-14)


def test_status_tells_how_each_ray_fared():
    single = lens(
        surface(20.0, 15.0, FLINT, semi_diameter=19.0, is_stop=True),
        surface(math.inf, 50.0, semi_diameter=3.0),
    )
    # Through; outside the first rim; beside the sphere; outside the second rim.
    traced = trace(single, parallel([1.0, 19.5, 25.0, 10.0]), NM)
    blocked, missed = RayStatus.BLOCKED, RayStatus.MISSED
    assert traced.status.tolist() == [RayStatus.PASSED, blocked, missed, blocked]
    assert traced.surface.tolist() == [0, 1, 1, 2]
    assert traced.reached.tolist() == [True, False, False, False]
    assert np.isfinite(traced.points).all() and np.isfinite(traced.directions).all()


def test_total_reflection_is_told():
    block = lens(
        surface(math.inf, 10.0, CROWN, 50.0, is_stop=True), surface(-8.0, 20.0, semi_diameter=8.0)
    )
    critical = 8.0 / 1.5168
    traced = trace(block, parallel([critical - 1e-9, critical + 1e-9]), NM)
    assert traced.status.tolist() == [RayStatus.PASSED, RayStatus.TOTAL_REFLECTION]
    assert traced.surface.tolist() == [0, 2]
    # It ends where it was reflected, with the direction it came with.
    assert traced.points[1, 1] == pytest.approx(critical, abs=1e-8)
    np.testing.assert_allclose(traced.directions[1], [0.0, 0.0, 1.0], atol=1e-15)


def test_rim_is_clear_radius():
    configuration = biconvex()
    traced = trace(configuration, parallel([9.999999, 10.000001, -10.000001]), NM)
    assert traced.status.tolist() == [RayStatus.PASSED, RayStatus.BLOCKED, RayStatus.BLOCKED]
    assert traced.surface.tolist() == [0, 1, 1]
    np.testing.assert_allclose(traced.points[1:, 1], [10.000001, -10.000001], rtol=1e-12)


def test_without_clipping_blocked_rays_go_on_and_tell_the_first_rim():
    configuration = triplet()
    fan = random_rays(count=2000, spread=14.0)
    obeyed = trace(configuration, fan, NM)
    told = trace(configuration, fan, NM, clip=False)
    through = told.reached
    assert through.sum() > obeyed.passed.sum() > 0
    assert np.array_equal(told.surface[through], obeyed.surface[through])
    assert np.array_equal(told.status[through], obeyed.status[through])
    np.testing.assert_array_equal(told.points[obeyed.passed], obeyed.points[obeyed.passed])
    failed = ~through
    assert set(told.status[failed]) <= {RayStatus.MISSED, RayStatus.TOTAL_REFLECTION}


def test_hits_follow_the_ray_and_stop_with_it():
    configuration = triplet()
    fan = random_rays(count=2000, spread=14.0)
    traced = trace(configuration, fan, NM, record=True)
    assert traced.hits.shape == (6, 2000, 3)
    assert np.isfinite(traced.hits).all()
    np.testing.assert_array_equal(traced.hits[-1][traced.passed], traced.points[traced.passed])
    for number in range(1, 7):
        part = trace(configuration, fan, NM, last=number)
        alive = part.reached
        np.testing.assert_array_equal(traced.hits[number - 1][alive], part.points[alive])
    for ray in np.flatnonzero(traced.status == RayStatus.BLOCKED)[:50]:
        order = traced.surface[ray] - 1
        assert (traced.hits[order:, ray] == traced.points[ray]).all()


def test_rays_do_not_influence_each_other(monkeypatch):
    configuration, fan = triplet(), random_rays(count=1000, spread=14.0)
    whole = trace(configuration, fan, NM, record=True, transmission=True)
    monkeypatch.setattr(tracing, "CHUNK", 7)
    pieces = trace(configuration, fan, NM, record=True, transmission=True)
    for name in ("points", "directions", "status", "surface", "reached", "hits", "transmission"):
        np.testing.assert_array_equal(getattr(pieces, name), getattr(whole, name))


def test_tracing_in_two_parts_is_tracing_at_once():
    configuration, fan = triplet(), random_rays()
    front = trace(configuration, fan, NM, last=3)
    going = front.passed
    rest = trace(configuration, Rays(front.points[going], front.directions[going]), NM, first=4)
    whole = trace(configuration, fan, NM)
    np.testing.assert_allclose(rest.points, whole.points[going], atol=1e-13)
    assert np.array_equal(rest.surface, whole.surface[going])


def test_no_surface_leaves_rays_as_they_are():
    fan = random_rays()
    traced = trace(triplet(), fan, NM, last=0)
    np.testing.assert_array_equal(traced.points, fan.origins)
    np.testing.assert_array_equal(traced.directions, fan.directions)
    assert traced.passed.all()


def test_no_rays_are_no_error():
    traced = trace(triplet(), Rays(np.zeros((0, 3)), np.zeros((0, 3))), NM, record=True)
    assert traced.points.shape == (0, 3) and traced.hits.shape == (6, 0, 3)
    assert traced.at_plane(3.0).shape == (0, 2)


def test_transmission_of_a_plate():
    plate = lens(surface(math.inf, 3.0, CROWN, is_stop=True), surface(math.inf, 5.0))
    loss = ((1.5168 - 1.0) / (1.5168 + 1.0)) ** 2
    traced = trace(plate, parallel([0.0, 50.0]), NM, transmission=True)
    np.testing.assert_allclose(traced.transmission, [(1.0 - loss) ** 2, 0.0], rtol=1e-14)


def test_plane_along_a_ray_is_not_crossed():
    nothing = lens(surface(semi_diameter=1e6, is_stop=True), surface(semi_diameter=1e6))
    traced = trace(nothing, rays((0.0, 1.0, 0.0), (1.0, 0.0, 1e-12)), NM, clip=False)
    np.testing.assert_array_equal(traced.at_plane(5.0), [[0.0, 0.0]])


@pytest.mark.parametrize(
    ("origins", "directions"),
    [
        (np.zeros((3, 2)), np.zeros((3, 2))),
        (np.zeros((3, 3)), np.zeros((2, 3))),
        (np.full((1, 3), np.nan), np.zeros((1, 3))),
        (np.zeros((1, 3)), np.full((1, 3), np.inf)),
    ],
)
def test_rays_that_are_none_are_refused(origins, directions):
    with pytest.raises(PrescriptionError):
        Rays(origins, directions)


@pytest.mark.parametrize("options", [{"first": 0}, {"last": 7}, {"first": 4, "last": 2}])
def test_surfaces_that_are_not_there_are_refused(options):
    with pytest.raises(PrescriptionError, match="has 1 to 6"):
        trace(triplet(), random_rays(), NM, **options)


@pytest.mark.parametrize("nm", [0.0, -5.0, math.nan, math.inf])
def test_wavelengths_that_are_none_are_refused(nm):
    with pytest.raises(PrescriptionError, match="wavelength"):
        trace(triplet(), random_rays(), nm)


def test_glass_without_index_is_named():
    bad = lens(surface(30.0, 5.0, ConstantGlass(math.nan), is_stop=True), surface())
    with pytest.raises(PrescriptionError, match="behind surface 1"):
        trace(bad, random_rays(), NM)
