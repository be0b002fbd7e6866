"""Points of light through a real lens: splats against every ray traced through the lens itself.

Five depths and three fields; the point's ray through the middle of the stop lands in the middle of
the picture, as a pinhole camera in the entrance pupil has it.
"""

from dataclasses import replace

import numpy as np
import pytest

from addon.lens_bokeh.samples.field_grid import field_grid
from addon.lens_bokeh.samples.landing import spread_places
from addon.lens_bokeh.samples.lens_rays import lens_rays
from addon.lens_bokeh.samples.sample_tables import sample_tables
from addon.lens_bokeh.tables.undistorted import undistorted
from addon.optics.focus import focused
from benchmarks.referees.osl_lens import osl_lens
from benchmarks.reference.traced_beam import counted_picture, traced_beam
from benchmarks.reference.traced_bokeh import psnr
from tests.splat_pictures import FOCUS, library_lens, plan_of, splatted

pytestmark = pytest.mark.usefixtures("gpu_context")

LENS = "double-gauss-50mm-f2"
DEPTHS = (0.8, 1.3, 3.0, 6.0, 40.0)
TANGENTS = (0.0, 0.18, 0.32)
SIZE, FOCAL_PX = 160, 6000.0
# The reference counts rays in this many texels along a pixel; odd.
FINE = 5
FILTER = 1.4
# Side of a square lamp, in the reference's cells; an odd number of pixels.
LAMP = 3 * FINE
# Of a small pattern and of a large one, where fewer would leave more noise than there is error.
RAYS, MANY_RAYS = 1 << 19, 1 << 21


def traced(plan, lens, depth, tangent):
    """Picture of a point by tracing, normalised, with the filter of the splats."""
    from addon.lens_io import profile_cache

    profile = profile_cache.profile(lens.prescription, lens.label, chromatic=False)
    state = profile.focused(FOCUS * 1000.0)
    distance = FOCUS * 1000.0 - (state.ray_map.pupil - state.first_order.h)
    configuration = focused(
        lens.prescription.configuration(lens.label), distance - state.first_order.h
    )
    depth_mm = depth * 1000.0
    point = (0.0, -tangent * depth_mm, -(depth_mm - state.ray_map.pupil))
    plane = state.image_plane(distance)
    shift = plane - configuration.sensor
    rays = MANY_RAYS if depth < 1.0 else RAYS
    beam = traced_beam(configuration, point, lens.f_number, rays)
    narrow = traced_beam(configuration, point, 60.0, 1 << 12)
    centre = (narrow.landing + narrow.slopes * shift).mean(axis=0)
    reference = state.ray_map.reference
    linear = reference[0] + (plane - state.ray_map.plane) * reference[1]
    k0 = abs(profile.stop_fraction(lens.f_number) * state.ray_map.pupil_radius * linear)[0]
    pixel = k0 / (plan.coc_scale / plan.focus_distance)
    # Straight lines in focus are straight in the picture.
    straight = lens_rays(lens.prescription, None, FOCUS, lens.f_number, 0.5).distorted
    scale = abs(osl_lens(lens.prescription, None, FOCUS, lens.f_number).scale)
    landing, centre = (
        _straightened(places, straight, scale)
        for places in (beam.landing + beam.slopes * shift, centre[None])
    )
    beam = replace(beam, landing=landing)
    fine = counted_picture(beam, 0.0, SIZE * FINE, 0.5 * SIZE * pixel, centre[0])
    width = round(FILTER * FINE)
    for axis in (0, 1):
        fine = np.apply_along_axis(np.convolve, axis, fine, np.ones(width) / width, "same")
    picture = fine[FINE // 2 :: FINE, FINE // 2 :: FINE] * FINE**2
    return picture / fine.sum()


def _straightened(places, straight, scale):
    away = np.hypot(*places.T) / scale
    return places * (undistorted(straight, away) / np.maximum(away, 1e-12))[:, None]


def compared(depth, tangent, vignetting):
    """Return the splat and the traced picture."""
    lens = library_lens(LENS)
    plan = plan_of(
        size=SIZE, focal_px=FOCAL_PX, lens=lens, vignetting=vignetting, filter_width=FILTER
    )
    # The tables reach as far as the farthest of the points.
    plan.bokeh.projection[[0, 1], [0, 1]] = np.sqrt(2.0) / TANGENTS[-1]
    drawn = splatted(plan, depth, chief=(0.0, tangent))[..., 1]
    return drawn, traced(plan, lens, depth, tangent)


@pytest.mark.parametrize("tangent", TANGENTS)
@pytest.mark.parametrize("depth", DEPTHS)
def test_a_point_through_a_real_lens_is_drawn_as_its_rays_fall(depth, tangent):
    drawn, wanted = compared(depth, tangent, "LENS")
    peak = np.quantile(wanted[wanted > 0.02 * wanted.max()], 0.99)
    assert psnr(drawn / peak, wanted / peak) >= 30.0


def sampled(plan, lens, depth, tangent, count=4096):
    """Picture of a point by lens samples of a real lens, normalised, with the splats' filter."""
    prescription = lens.prescription
    rays = lens_rays(prescription, None, FOCUS, lens.f_number, 1.3 * np.sqrt(2.0) * tangent)
    radius = plan.coc_scale / FOCAL_PX
    # Where the disc lies, and the point.
    middle, side = np.array([0.0, tangent]), 0.5 * SIZE / FOCAL_PX
    around = field_grid(middle - side, middle + side)
    tables = sample_tables(rays, around, field_grid(middle - side, middle + 0.01 * side), radius)
    positions = np.append(spread_places(count) * radius, np.zeros((1, 2)), axis=0)
    index, weights = tables.moves_grid.taps(middle[None])
    moves = tables.moves(positions).reshape(len(positions), -1, 4, 2)[:, index[0]]
    powers = np.minimum(1.0 / depth / tables.largest_vergence, 1.0) ** np.arange(4)
    moves = np.einsum("t,k,ntkc->nc", weights[0], powers, moves)
    seen = middle + positions * (1.0 / FOCUS - 1.0 / depth) + moves
    chief, seen = seen[-1], seen[:-1]
    light = tables.light(positions[:-1], np.sqrt(np.pi / count)).reshape(count, -1)
    index, weights = tables.light_grid.taps(seen)
    light = (np.take_along_axis(light, index, axis=1) * weights).sum(axis=1)
    x, y = ((seen - chief) * (FOCAL_PX * FINE)).T + 0.5 * SIZE * FINE
    edges = np.arange(SIZE * FINE + 1)
    fine = np.histogram2d(y, x, bins=(edges, edges), weights=light)[0]
    # As wide as the filter and a lamp: samples are few beside the cells.
    for width in (round(FILTER * FINE), LAMP):
        for axis in (0, 1):
            fine = np.apply_along_axis(np.convolve, axis, fine, np.ones(width) / width, "same")
    return fine[FINE // 2 :: FINE, FINE // 2 :: FINE] * FINE**2 / fine.sum()


def test_a_disc_behind_the_focus_is_what_lens_samples_draw():
    lens, depth, tangent = library_lens(LENS), 40.0, 0.18
    plan = plan_of(size=SIZE, focal_px=FOCAL_PX, lens=lens, vignetting="LENS", filter_width=FILTER)
    plan.bokeh.projection[[0, 1], [0, 1]] = np.sqrt(2.0) / TANGENTS[-1]
    drawn = splatted(plan, depth, chief=(0.0, tangent))[..., 1].astype(float)
    wide = np.ones(LAMP // FINE) / (LAMP // FINE)
    for axis in (0, 1):
        drawn = np.apply_along_axis(np.convolve, axis, drawn, wide, "same")
    wanted = sampled(plan, lens, depth, tangent)
    peak = wanted.max()
    assert psnr(drawn / peak, wanted / peak) >= 35.0
