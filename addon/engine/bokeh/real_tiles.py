"""Tiles of a real lens, for the discs of a frame: traced and drawn in steps, and kept."""

from functools import lru_cache

import numpy as np

from ...lens_bokeh.look import splat_pupil
from ...lens_bokeh.look.pupil_beams import PupilBeams
from ...lens_bokeh.look.splat_profile import distance_from_h
from ...lens_bokeh.tables.pupil_tracing import build_pupil_tables
from ...optics.focus import focused
from .lens_profiles import lens_pupil

# Focus distance over the depth of the nearest tile: nearer patterns only grow.
_NEAREST = 4.0
# Steps in which traced beams come nearer, per halving of the distance.
_SHARED = 4
_MM = 1000.0


class TilesWork:
    """Making a lens' tiles at a focus, a step at a time.

    Parameters
    ----------
    lens : look_keys.LensKey
    focus_distance : float
        m.
    tangent : float
        Of the field at the last tiles.
    """

    def __init__(self, lens, focus_distance, tangent):
        self._given = lens, focus_distance, tangent
        self._steps = self._result = None

    def step(self):
        """Take a step; return whether there are more."""
        if self._result is not None:
            return False
        # After an error it begins anew.
        self._steps = self._steps or _made(*self._given)
        try:
            next(self._steps)
        except StopIteration as end:
            self._result, self._steps = end.value, None
            return False
        except Exception:
            self._steps = None
            raise
        return True

    def whole(self):
        """Take all steps that are left.

        Returns
        -------
        tiles : PupilTiles
        w_range : tuple of 2 float
            Of the first and last depth.
        soft : float
            c0 over the circle of confusion of infinity.
        """
        while self.step():
            pass
        return self._result


# Memo of its arguments alone: how far it has got does not change what it returns in the end.
@lru_cache(maxsize=2)
def tiles_work(lens, focus_distance, tangent):
    """Return the `TilesWork` of a lens."""
    return TilesWork(lens, focus_distance, tangent)


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
    tiles = yield from splat_pupil.tiles_in_steps(beams, shift, (k0, k1), soft, w_range)
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
