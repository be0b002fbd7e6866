"""Tiles of a real lens, for the discs of a frame: traced and drawn in steps, and kept.

Of a lens whose samples are a thin lens' because sums of terms do not follow its rays; those of
others are made of the samples' own (`ray_tiles`).
"""

from functools import lru_cache, partial

import numpy as np

from ...lens_bokeh.look import splat_pupil
from ...lens_bokeh.look.pupil_beams import PupilBeams
from ...lens_bokeh.look.splat_profile import distance_from_h
from ...lens_bokeh.tables.pupil_tracing import build_pupil_tables
from ...optics.focus import focused
from .lens_profiles import lens_pupil
from .tiles_work import TilesWork

# Focus distance over the depth of the nearest tile: nearer patterns only grow.
_NEAREST = 4.0
# Steps in which traced beams come nearer, per halving of the distance.
_SHARED = 4
_MM = 1000.0


# Memo of its arguments alone: how far it has got does not change what it returns in the end.
@lru_cache(maxsize=2)
def tiles_work(lens, focus_distance, tangent):
    """Return the `TilesWork` of a lens.

    Parameters
    ----------
    lens : look_keys.LensKey
    focus_distance : float
        m.
    tangent : float
        Of the field at the last tiles.
    """
    return TilesWork(partial(_made, lens, focus_distance, tangent))


def _made(lens, focus_distance, tangent):
    profile = lens.profile()
    yield
    distance = distance_from_h(profile, focus_distance)
    state = profile.focused(distance)
    focus = distance if lens.settings.prescription.focus else np.inf
    nearest = min(float(state.ray_map.vergences[-1]), _NEAREST / (focus_distance * _MM))
    reach = nearest
    if np.isinf(focus):
        # Beams are traced once for all focus distances down to a step; nearer ones need new beams.
        reach = 2.0 ** (np.ceil(np.log2(nearest) * _SHARED) / _SHARED)
        reach = min(float(state.ray_map.vergences[-1]), float(reach))
    beams = _beams(lens, focus, float(state.ray_map.pupil), tangent, reach)
    yield
    yield from beams.traced()
    plane = state.image_plane(distance)
    # The circle of confusion of the lens, c = k0 + k1 V, is 0 at the focus.
    linear = state.ray_map.reference[0] + (plane - state.ray_map.plane) * state.ray_map.reference[1]
    radius = profile.stop_fraction(lens.settings.f_number) * state.ray_map.pupil_radius
    k0, k1 = (-radius * linear).tolist()
    # Off the axis, patterns change most where they are as small as the aberrations there.
    soft = beams.width_in_focus(plane - beams.sensor, -k0 / k1)
    yield
    ends = [k0 + k1 * vergence for vergence in (0.0, nearest)]
    w_range = tuple(sorted(c / (abs(c) + soft) for c in ends))
    shift = plane - beams.sensor
    distorted = beams.distorted(shift, -k0 / k1)

    def grids(field, vergences):
        return beams.grids(field, vergences, shift, distorted)

    tiles = yield from splat_pupil.tiles_in_steps(grids, beams.tangents, (k0, k1), soft, w_range)
    return tiles, w_range, soft / abs(k0)


# Memo of its arguments alone, whose beams are traced when they are needed.
@lru_cache(maxsize=2)
def _beams(lens, focus, pupil, tangent, nearest):
    settings = lens.settings
    prescription = settings.prescription
    if np.isinf(focus):
        tables = lens_pupil(settings)
    else:
        configuration = prescription.configuration(settings.label)
        tables = build_pupil_tables(focused(configuration, focus, prescription.focus))
    return PupilBeams(tables, pupil, settings.f_number, tangent, nearest)
