"""A lens focused at a distance: its first-order values and its ray map.

A lens that is moved as a whole has one state: focusing changes the distance to the sensor only.
A lens with a focus group has a state for each of a few distances, Chebyshev's points over
1 / distance; all their numbers are smooth over it, and one polynomial gives the states between.

Distances of focus and objects are from the first principal plane of the focused lens, mm.
"""

from dataclasses import dataclass, fields

import numpy as np

from ...errors import FocusError, InputError, PrescriptionError
from ...optics.focus import focused
from ...optics.paraxial import FirstOrder, first_order
from .ray_map import RayMap, lagrange_weights
from .ray_map_tracing import (
    map_vergences,
    nearest_object,
    pupil_reach,
    trace_ray_map,
    without_idle_rims,
)

# States of a lens with a focus group: planes of focus are then exact to a millionth of a mm.
GROUP_STATES = 9
# Nearest focus of a focus group, focal lengths before H: half life size.
_NEAREST_FOCUS = 3.0
# Largest factor by which the focal length may change with focus.
_SAME_LENS = 1.5
# Steps of the search for the nearest focus, and for a distance from a moving principal plane.
_STEPS = 24


@dataclass(frozen=True)
class FocusState:
    """A lens at one focus.

    Parameters
    ----------
    first_order : FirstOrder
        Reference wavelength, wide open.
    last_vertex : float
        The z of the last surface, mm from surface 1.
    ray_map : RayMap
    """

    first_order: FirstOrder
    last_vertex: float
    ray_map: RayMap

    def vergence(self, distance):
        """Vergence at the entrance pupil of an object.

        Parameters
        ----------
        distance : float
            From H, mm; inf is allowed.

        Returns
        -------
        float
            1/mm.

        Raises
        ------
        InputError
            If the object is not before the entrance pupil.
        """
        object_z = self.first_order.h - distance
        if not object_z < self.ray_map.pupil:
            raise InputError(
                f"object distance {distance:g} mm lies behind the lens' entrance pupil; it must be "
                f"more than {self.first_order.h - self.ray_map.pupil:g} mm"
            )
        return float(self.ray_map.vergence(object_z))

    def image_plane(self, distance):
        """Return the z of the paraxial image of an object, mm from surface 1.

        Parameters
        ----------
        distance : float
            From H, mm; beyond the focal length.

        Raises
        ------
        FocusError
            If there is no real image.
        """
        if not distance > self.first_order.efl:
            raise FocusError(
                f"focus distance {distance:g} mm is not beyond the focal length "
                f"{self.first_order.efl:g} mm; focus farther away"
            )
        return self.ray_map.focus_plane(self.vergence(distance))


def trace_states(configuration, wavelengths_nm, *, focus_group=None, step=None, **options):
    """Trace the states of a lens.

    Parameters
    ----------
    configuration : Configuration
        Wide open.
    wavelengths_nm : ndarray
    focus_group : FocusGroup or None
    step : callable or None
        Called with the share done.
    **options
        For `trace_ray_map`.

    Returns
    -------
    nearness : ndarray of shape (S,)
        1 / distance of the focused object from surface 1; 1/mm, from 0.
    states : tuple of FocusState
    """
    lenses, nearness = [configuration], np.zeros(1)
    if focus_group:
        turn = np.linspace(0.0, np.pi, GROUP_STATES)
        nearness = _reach(configuration, focus_group) * (1.0 - np.cos(turn)) / 2.0
        lenses = [focused(configuration, _distance(n), focus_group) for n in nearness]
        if nearness[-1] == 0.0:
            lenses, nearness = lenses[:1], nearness[:1]
    maps = []
    vergences = map_vergences(lenses[0], first_order(lenses[0]))
    # The same for all states, so that a place in the map is the same ray in each.
    reach = pupil_reach(lenses, wavelengths_nm, vergences)
    for i, lens in enumerate(lenses):

        def part(share, done=i):
            if step:
                step((done + share) / len(lenses))

        maps.append(trace_ray_map(lens, wavelengths_nm, vergences, reach, step=part, **options))
    states = [
        FocusState(first_order(lens), lens.vertices[-1], ray_map)
        for lens, ray_map in zip(lenses, without_idle_rims(maps), strict=True)
    ]
    return nearness, tuple(states)


def state_at(nearness, states, distance):
    """Return the state of a lens focused at a distance.

    Parameters
    ----------
    nearness : ndarray of shape (S,)
    states : tuple of FocusState
    distance : float
        From H, mm; inf is allowed.

    Returns
    -------
    FocusState

    Raises
    ------
    FocusError
        If the focus group does not reach so near.
    """
    if len(states) == 1:
        return states[0]
    shifts = np.array([state.first_order.h for state in states])
    # The principal plane moves with the group, little against the distance.
    before = distance
    for _ in range(_STEPS):
        at = 1.0 / before if before > 0.0 else np.inf
        weights, _ = lagrange_weights(nearness, at, len(nearness))
        before = distance - float(weights @ shifts)
    if not 0.0 <= at <= nearness[-1] * (1.0 + 1.0e-9):
        nearest = 1.0 / nearness[-1] + shifts[-1]
        raise FocusError(
            f"focus distance {distance:g} mm is out of reach of the focus group; the nearest is "
            f"{nearest:.6g} mm"
        )
    return _blended(states, weights)


def _blended(states, weights):
    """Return the weighted mean of states, number by number."""
    orders = [state.first_order for state in states]
    values = {}
    for field in fields(FirstOrder):
        numbers = [getattr(order, field.name) for order in orders]
        values[field.name] = None if None in numbers else float(np.dot(weights, numbers))
    last = float(np.dot(weights, [state.last_vertex for state in states]))
    maps = [state.ray_map for state in states]
    return FocusState(FirstOrder(**values), last, RayMap.blend(maps, weights))


def _reach(configuration, focus_group):
    """Return 1 / the nearest focus, from surface 1; half life size at most."""
    order = first_order(configuration)
    nearest = min(nearest_object(configuration, order), order.h - _NEAREST_FOCUS * order.efl)

    def focuses(nearness):
        try:
            efl = first_order(focused(configuration, _distance(nearness), focus_group)).efl
        except PrescriptionError:
            return False
        # Where the focal length changes too much, first-order values are not smooth any more.
        return order.efl / _SAME_LENS < efl < order.efl * _SAME_LENS

    # Beyond a gap a group may focus again, but that is another motion.
    steps = np.linspace(0.0, -1.0 / nearest, _STEPS + 1)
    failed = next((i for i, nearness in enumerate(steps) if not focuses(nearness)), None)
    if failed is None:
        return steps[-1]
    low, high = steps[max(failed - 1, 0)], steps[failed]
    for _ in range(_STEPS):
        middle = (low + high) / 2.0
        low, high = (middle, high) if focuses(middle) else (low, middle)
    return low


def _distance(nearness):
    return 1.0 / nearness if nearness > 0.0 else np.inf
