"""First-order optics against the formulas of textbooks and against real rays near the axis."""

import math
from dataclasses import replace

import numpy as np
import pytest

from addon.errors import PrescriptionError
from addon.optics.glass import REFERENCE_WAVELENGTH_NM, AbbeGlass, ConstantGlass
from addon.optics.paraxial import entrance_pupil, first_order, image_distance, magnification, power
from addon.optics.rays.trace import trace
from tests.optics.lenses import CROWN, FLINT, biconvex, lens, parallel, rays, surface, triplet

NM = REFERENCE_WAVELENGTH_NM
N = 1.5168


def test_a_thick_lens_follows_the_lensmakers_formula():
    # 1 / f = (n - 1) (1 / R1 - 1 / R2 + (n - 1) t / (n R1 R2)); H = f (n - 1) t / (n R2) and so on.
    r1, r2, t = 50.0, -80.0, 6.0
    values = first_order(lens(surface(r1, t, CROWN, is_stop=True), surface(r2, 90.0)))
    f = 1.0 / ((N - 1.0) * (1.0 / r1 - 1.0 / r2 + (N - 1.0) * t / (N * r1 * r2)))
    assert values.efl == pytest.approx(f, rel=1e-14)
    assert values.bfl == pytest.approx(f * (1.0 - (N - 1.0) * t / (N * r1)), rel=1e-14)
    assert values.ffl == pytest.approx(-f * (1.0 + (N - 1.0) * t / (N * r2)), rel=1e-14)
    assert values.h == pytest.approx(-f * (N - 1.0) * t / (N * r2), rel=1e-13)
    assert values.h_prime == pytest.approx(-f * (N - 1.0) * t / (N * r1), rel=1e-13)


def test_a_ball_lens_has_both_principal_planes_in_its_centre():
    # f = n R / (2 (n - 1)), both principal planes at the centre.
    ball = lens(surface(10.0, 20.0, CROWN, 9.0, is_stop=True), surface(-10.0, 5.0))
    values = first_order(ball)
    assert values.efl == pytest.approx(N * 10.0 / (2.0 * (N - 1.0)), rel=1e-14)
    assert values.h == pytest.approx(10.0, rel=1e-13)
    assert values.h_prime == pytest.approx(-10.0, rel=1e-13)


def test_two_thin_lenses_apart():
    # 1 / f = 1 / f1 + 1 / f2 - d / (f1 f2).
    def thin(f, gap, **more):
        return surface(2 * 0.5 * f, 0.0, ConstantGlass(1.5), **more), surface(-f, gap)

    pair = lens(*thin(100.0, 30.0, is_stop=True), *thin(60.0, 40.0))
    f = 1.0 / (1.0 / 100.0 + 1.0 / 60.0 - 30.0 / 6000.0)
    values = first_order(pair)
    assert values.efl == pytest.approx(f, rel=1e-14)
    assert values.bfl == pytest.approx(f * (1.0 - 30.0 / 100.0), rel=1e-13)


def test_stop_in_front_is_its_own_entrance_pupil():
    configuration = lens(
        surface(math.inf, 12.0, semi_diameter=4.0, is_stop=True),
        surface(50.0, 5.0, CROWN),
        surface(-50.0, 45.0),
    )
    values = first_order(configuration)
    assert (values.enp_z, values.enp_diameter) == (0.0, 8.0)
    # The exit pupil is its image: 1 / s' = 1 / f - 1 / s from the principal planes.
    away = 12.0 + values.h - 12.0
    image = 1.0 / (1.0 / values.efl - 1.0 / away)
    assert values.exp_z == pytest.approx(values.h_prime + image, rel=1e-12)
    assert values.exp_diameter == pytest.approx(8.0 * abs(image / away), rel=1e-12)


def test_stop_behind_is_its_own_exit_pupil():
    values = first_order(
        lens(
            surface(50.0, 5.0, CROWN),
            surface(-50.0, 12.0),
            surface(math.inf, 33.0, semi_diameter=4.0, is_stop=True),
        )
    )
    assert values.exp_z == pytest.approx(0.0, abs=1e-14)
    assert values.exp_diameter == pytest.approx(8.0, rel=1e-14)
    assert values.enp_diameter > 8.0


def test_refracting_stop_is_a_stop_in_its_vertex_plane():
    # Its own power neither moves nor enlarges what stands in its vertex plane.
    plane = lens(
        surface(40.0, 4.0, CROWN),
        surface(200.0, 3.0),
        surface(math.inf, 0.0, semi_diameter=6.0, is_stop=True),
        surface(-60.0, 2.0, FLINT),
        surface(-80.0, 60.0),
    )
    one, two, _, four, five = plane.surfaces
    itself = lens(one, two, replace(four, semi_diameter=6.0, is_stop=True), five)
    assert first_order(itself) == pytest.approx(first_order(plane))


def test_pupils_are_images_of_each_other():
    # Rays towards the centre of the entrance pupil leave from that of the exit pupil.
    configuration = triplet()
    values = first_order(configuration)
    slope = 1.0e-5
    chief = rays((0.0, 0.0, values.enp_z), (0.0, slope, 1.0))
    traced = trace(configuration, chief, NM, clip=False)
    last = configuration.vertices[-1]
    # Third-order terms are slope^3.
    assert abs(traced.at_plane(last + values.exp_z)[0, 1]) < 1e-12


def test_real_rays_approach_the_paraxial_focus_quadratically():
    configuration = triplet()
    focus = configuration.vertices[-1] + first_order(configuration).bfl
    heights = np.array([2.0, 1.0, 0.5, 0.25])
    traced = trace(configuration, parallel(heights), NM)
    crossing = traced.points[:, 2] - traced.points[:, 1] * (
        traced.directions[:, 2] / traced.directions[:, 1]
    )
    error = crossing - focus
    order = np.log2(error[:-1] / error[1:])
    # The next term is two orders higher, so the observed order is 2 within h^2.
    assert (np.abs(order - 2.0) < [0.1, 0.03, 0.01]).all()


def test_efl_is_the_scale_of_the_image():
    configuration = triplet()
    values = first_order(configuration)
    field = 1.0e-5
    chief = rays((0.0, 0.0, values.enp_z), (0.0, math.sin(field), math.cos(field)))
    place = configuration.vertices[-1] + values.bfl
    height = trace(configuration, chief, NM, clip=False).at_plane(place)[0, 1]
    assert height / math.tan(field) == pytest.approx(values.efl, rel=1e-8)


@pytest.mark.parametrize("distance", [80.0, 200.0, 1000.0, 1.0e5])
def test_conjugate_distances_follow_newtons_equation(distance):
    configuration = triplet()
    values = first_order(configuration)
    x = distance + values.ffl
    x_prime = image_distance(configuration, distance) - values.bfl
    assert x * x_prime == pytest.approx(values.efl**2, rel=1e-10)
    assert magnification(configuration, distance) == pytest.approx(-values.efl / x, rel=1e-12)


def test_object_at_infinity_is_imaged_at_the_focus():
    configuration = triplet()
    assert image_distance(configuration, math.inf) == first_order(configuration).bfl
    assert magnification(configuration, math.inf) == 0.0


def test_second_order_asphere_is_curvature():
    curved = biconvex(radius=50.0)
    front, back = curved.surfaces
    flat = replace(front, radius=math.inf, asphere=((2, 1.0 / 100.0), (4, 1e-5)))
    assert first_order(replace(curved, surfaces=(flat, back))).efl == pytest.approx(
        first_order(curved).efl, rel=1e-14
    )


def test_cylinders_act_in_their_meridian():
    ball = biconvex()
    bent = tuple(replace(one, curved_along="x") for one in ball.surfaces)
    bar = replace(ball, surfaces=bent)
    assert first_order(bar, meridian="x") == first_order(ball)
    with pytest.raises(PrescriptionError, match="no power"):
        first_order(bar, meridian="y")


def test_abbe_number_tells_the_spread_of_focal_lengths():
    # Thin lens: (1/f_F - 1/f_C) f_d = 1 / vd.
    thin = lens(surface(100.0, 0.0, AbbeGlass(1.5168, 64.17), is_stop=True), surface(-100.0, 96.0))
    blue, middle, red = (power(thin, nm) for nm in (486.1327, 587.5618, 656.2725))
    assert (blue - red) / middle == pytest.approx(1.0 / 64.17, rel=1e-12)


def test_lens_without_power_is_refused():
    plate = lens(surface(math.inf, 3.0, CROWN, is_stop=True), surface(math.inf, 3.0))
    assert power(plate) == 0.0
    with pytest.raises(PrescriptionError, match="no power"):
        first_order(plate)


def telecentric(gap):
    front = [surface(50.0, 4.0, CROWN), surface(-50.0, gap)]
    return lens(*front, surface(semi_diameter=3.0, thickness=20.0, is_stop=True), surface())


def test_stop_in_the_rear_focus_has_no_entrance_pupil():
    focus = first_order(biconvex()).bfl
    with pytest.raises(PrescriptionError, match=r"stop \(surface 3\) has no finite image"):
        entrance_pupil(telecentric(focus))
    assert math.isfinite(entrance_pupil(telecentric(0.9 * focus))[0])


def test_stop_in_the_front_focus_has_no_exit_pupil():
    front = -first_order(biconvex()).ffl
    values = first_order(
        lens(
            surface(math.inf, front, semi_diameter=3.0, is_stop=True),
            surface(50.0, 4.0, CROWN),
            surface(-50.0, 48.0),
        )
    )
    assert values.exp_z is None and values.exp_diameter is None
    assert values.enp_diameter == 6.0


def test_object_in_the_front_focus_has_no_image():
    configuration = biconvex()
    with pytest.raises(PrescriptionError, match="at infinity"):
        image_distance(configuration, -first_order(configuration).ffl)


def test_medium_behind_the_lens_counts():
    # An eye under glass: n' / f' = power, and the nodal shift of the front focus.
    eye = lens(surface(20.0, 60.0, CROWN, is_stop=True))
    values = first_order(eye)
    assert values.efl == pytest.approx(N * 20.0 / (N - 1.0), rel=1e-14)
    assert values.ffl == pytest.approx(-20.0 / (N - 1.0), rel=1e-14)
