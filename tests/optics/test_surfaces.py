"""Shapes of surfaces, and where rays meet them."""

import math

import numpy as np
import pytest

from addon.optics.bundle import Bundle
from addon.optics.surfaces import FAR, Shape, normal, sag, within_reach
from tests.optics.lenses import rays, surface

SHAPES = {
    "plane": surface(),
    "sphere": surface(30.0),
    "concave": surface(-30.0),
    "ellipsoid": surface(30.0, conic=0.7),
    "prolate": surface(-30.0, conic=-0.6),
    "paraboloid": surface(30.0, conic=-1.0),
    "hyperboloid": surface(-25.0, conic=-2.3),
    "asphere": surface(30.0, conic=-0.6, asphere=((4, 1.1e-5), (6, -2.0e-8), (20, 1.0e-24))),
    "flat asphere": surface(asphere=((2, 1.0e-3), (4, 2.0e-5))),
    "cylinder x": surface(30.0, curved_along="x"),
    "cylinder y": surface(-30.0, conic=0.4, curved_along="y"),
    "aspheric cylinder": surface(30.0, asphere=((4, 1.0e-5),), curved_along="x"),
}
# Rounding of positions of tens of mm, and of Newton's last step.
ROUNDING_MM = 1.0e-12


def intersect(surface, points, directions):
    """Intersections of rays with a surface whose vertex is the origin.

    Returns the points, shape (N, 3) in mm, and which rays met the surface.
    """
    bundle = Bundle(np.asarray(points, dtype=float), np.asarray(directions, dtype=float))
    with np.errstate(all="ignore"):
        missed = Shape(surface).meet(bundle)
        far = ~(bundle.radius_squared() <= FAR * FAR)
    missed = far if missed is None else missed | far
    hits = np.stack([bundle.x, bundle.y, bundle.z], axis=-1)
    return within_reach(hits), ~missed


@pytest.fixture(params=SHAPES)
def shape(request):
    return SHAPES[request.param]


def skew(count=300, seed=5):
    """Points all around and directions of all kinds through the clear disk."""
    random = np.random.default_rng(seed)
    target = random.uniform(-7.0, 7.0, (count, 3)) * (1.0, 1.0, 0.0)
    way = random.normal(size=(count, 3))
    way[:, 2] = np.copysign(np.abs(way[:, 2]) + 1.0, way[:, 2])
    return rays(target - way * random.uniform(-5.0, 40.0, (count, 1)), way)


def test_hits_lie_on_the_surface_and_on_the_ray(shape):
    fan = skew()
    hits, met = intersect(shape, fan.origins, fan.directions)
    assert met.mean() > 0.95
    hits = hits[met]
    np.testing.assert_allclose(hits[:, 2], sag(shape, hits[:, 0], hits[:, 1]), 0.0, ROUNDING_MM)
    away = hits - fan.origins[met]
    across = away - np.sum(away * fan.directions[met], axis=1)[:, None] * fan.directions[met]
    np.testing.assert_allclose(across, 0.0, atol=1.0e-11)


def test_normal_is_the_gradient(shape):
    random = np.random.default_rng(1)
    x, y = random.uniform(-7.0, 7.0, (2, 50))
    step = 1.0e-5
    slope_x = (sag(shape, x + step, y) - sag(shape, x - step, y)) / (2.0 * step)
    slope_y = (sag(shape, x, y + step) - sag(shape, x, y - step)) / (2.0 * step)
    wanted = np.stack([-slope_x, -slope_y, np.ones(50)], axis=-1)
    wanted /= np.linalg.norm(wanted, axis=1)[:, None]
    # The central difference is good to about step^2 and rounding / step.
    np.testing.assert_allclose(normal(shape, x, y), wanted, atol=1.0e-9)


def test_sag_of_the_format():
    # 20 mm conic with two terms at r = 5 mm, by hand: c = 0.05, k = -0.5.
    base = 0.05 * 25.0 / (1.0 + math.sqrt(1.0 - 0.5 * 0.0025 * 25.0))
    found = sag(surface(20.0, conic=-0.5, asphere=((4, 1e-5), (6, 1e-7))), 3.0, 4.0)
    assert found == pytest.approx(base + 1e-5 * 5**4 + 1e-7 * 5**6, rel=1e-15)


def test_ray_may_start_anywhere_on_its_line(shape):
    fan = skew()
    hits, met = intersect(shape, fan.origins, fan.directions)
    for shift in (-300.0, 55.0):
        moved, still = intersect(shape, fan.origins + shift * fan.directions, fan.directions)
        both = met & still
        assert np.array_equal(met, still)
        np.testing.assert_allclose(moved[both], hits[both], atol=1.0e-11)


def test_reversed_ray_meets_the_same_point(shape):
    # Of two points on the vertex' sheet the direction chooses; near the axis both ways agree.
    fan = skew()
    gentle = np.abs(fan.directions[:, 2]) > 0.8
    hits, met = intersect(shape, fan.origins, fan.directions)
    back, still = intersect(shape, fan.origins, -fan.directions)
    both = met & still & gentle
    assert both.sum() > 50
    np.testing.assert_allclose(back[both], hits[both], atol=1.0e-11)


def test_origin_a_kilometre_away_costs_no_digits():
    sphere = surface(50.0)
    way = np.array([[0.003, -0.004, 1.0]])
    near = rays((3.0, 2.0, 0.0), way)
    far = rays(near.origins - 1.0e6 * near.directions, way)
    wanted, _ = intersect(sphere, near.origins, near.directions)
    found, met = intersect(sphere, far.origins, far.directions)
    assert met[0]
    # What a double holds of 1e6 mm.
    np.testing.assert_allclose(found, wanted, atol=3.0e-10)


def test_skimming_ray_meets_a_dome_but_no_plane():
    flat = rays((-40.0, 0.0, 3.0), (1.0, 0.0, 0.0))
    hits, met = intersect(surface(20.0), flat.origins, flat.directions)
    assert met[0]
    # x^2 = 2 R z - z^2.
    np.testing.assert_allclose(abs(hits[0, 0]), math.sqrt(2 * 20 * 3 - 9), rtol=1e-14)
    assert not intersect(surface(), flat.origins, flat.directions)[1][0]


def test_far_hemisphere_is_no_surface():
    beside = rays((-40.0, 0.0, 30.0), (1.0, 0.0, 0.1))
    assert not intersect(surface(20.0), beside.origins, beside.directions)[1][0]


def test_ray_beside_the_sphere_misses():
    beside = rays((0.0, 20.001, 0.0), (0.0, 0.0, 1.0))
    assert not intersect(surface(20.0), beside.origins, beside.directions)[1][0]


def test_hyperboloid_is_met_on_the_sheet_of_its_vertex():
    # Its asymptotes have slope 1/2 (r^2 = 20 z + 4 z^2): these rays cross each sheet once.
    sheet = surface(10.0, conic=-5.0)
    fan = rays((0.0, -20.0, 1.0), [(0.0, 1.0, 0.6), (0.0, 1.0, -0.6), (0.1, 1.0, 0.8)])
    hits, met = intersect(sheet, fan.origins, fan.directions)
    assert met.all()
    assert (hits[:, 2] >= 0.0).all()
    np.testing.assert_allclose(hits[:, 2], sag(sheet, hits[:, 0], hits[:, 1]), atol=ROUNDING_MM)


def test_asphere_of_zero_coefficients_is_the_conic():
    fan = skew()
    conic = surface(-25.0, conic=-1.7)
    asphere = surface(-25.0, conic=-1.7, asphere=((4, 0.0), (8, 0.0)))
    wanted, met = intersect(conic, fan.origins, fan.directions)
    found, also = intersect(asphere, fan.origins, fan.directions)
    # Newton's method also takes rays that the conic's equation has no root for, and none less.
    assert (also | ~met).all()
    np.testing.assert_allclose(found[met], wanted[met], atol=ROUNDING_MM)


def test_conic_written_as_asphere():
    # A paraboloid is its own first term.
    fan = skew()
    wanted, met = intersect(surface(40.0, conic=-1.0), fan.origins, fan.directions)
    term = surface(asphere=((2, 1.0 / 80.0),))
    found, also = intersect(term, fan.origins, fan.directions)
    both = met & also & (np.abs(fan.directions[:, 2]) > 0.5)
    assert both.sum() > 100
    np.testing.assert_allclose(found[both], wanted[both], atol=1.0e-11)


def test_cylinder_is_its_cross_section():
    sphere, cylinder = surface(30.0), surface(30.0, curved_along="y")
    heights = np.linspace(-9.0, 9.0, 19)
    points = np.stack([0.0 * heights, heights, 0.0 * heights], axis=-1)
    meridional = rays(points, (0.0, 0.1, 1.0))
    wanted, _ = intersect(sphere, meridional.origins, meridional.directions)
    found, met = intersect(cylinder, meridional.origins, meridional.directions)
    assert met.all()
    np.testing.assert_allclose(found, wanted, atol=ROUNDING_MM)
    aside = meridional.origins + [7.0, 0.0, 0.0]
    found, _ = intersect(cylinder, aside, meridional.directions)
    np.testing.assert_allclose(found, wanted + [7.0, 0.0, 0.0], atol=ROUNDING_MM)


def test_sag_and_normal_stay_finite_beyond_the_equator():
    sphere = surface(5.0)
    x = np.array([4.0, 5.0, 6.0, 1e3])
    assert np.isfinite(sag(sphere, x, 0.0 * x)).all()
    assert np.isfinite(normal(sphere, x, 0.0 * x)).all()
    assert sag(sphere, 6.0, 0.0) == pytest.approx(5.0)
