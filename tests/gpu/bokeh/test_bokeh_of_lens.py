"""Points of light through a real lens: splats against every ray traced through the lens itself.

Five depths and three fields; the point's ray through the middle of the stop lands in the middle of
the picture, as a pinhole camera in the entrance pupil has it.
"""

import numpy as np
import pytest

from addon.optics.focus import focused
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
    fine = counted_picture(beam, shift, SIZE * FINE, 0.5 * SIZE * pixel, centre)
    width = round(FILTER * FINE)
    for axis in (0, 1):
        fine = np.apply_along_axis(np.convolve, axis, fine, np.ones(width) / width, "same")
    picture = fine[FINE // 2 :: FINE, FINE // 2 :: FINE] * FINE**2
    return picture / fine.sum()


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
