"""Focusing a lens: where its sensor stands, or how far its focus group has moved.

The sensor lies at the paraxial image of the axial object point, for the d line. A group that
moves by s towards the scene changes two distances by -s and +s. The object is in focus where
one entry of the matrix from object to sensor is 0, and that is quadratic in s.
"""

import math

import numpy as np

from ..errors import PrescriptionError
from .glass import REFERENCE_WAVELENGTH_NM
from .media import indices
from .paraxial import first_order, image_distance, ray_matrix, transfer


def focused(configuration, object_distance, focus_group=None):
    """Return the lens focused at a distance.

    Parameters
    ----------
    configuration : Configuration
    object_distance : float
        From the object to surface 1 of the focused lens, mm; inf is allowed.
    focus_group : FocusGroup or None
        None: the whole lens moves, so only its distance to the sensor changes. A group: it moves,
        and the sensor stays where the image of an object at infinity was.

    Returns
    -------
    Configuration
        With the last distance up to the sensor.

    Raises
    ------
    PrescriptionError
        If the distance is out of reach; the message names the nearest one that is not.
    """
    if not object_distance > 0.0:
        raise PrescriptionError(f"focus distance {object_distance:g} mm must be greater than 0")
    infinity = image_distance(configuration, math.inf)
    if focus_group is None:
        return _whole_lens(configuration, object_distance, infinity)
    if infinity <= 0.0:
        raise PrescriptionError(
            f"the lens forms no real image: its focus is {-infinity:g} mm in front of its last"
            " vertex"
        )
    at_infinity = configuration.with_thickness(len(configuration.surfaces), infinity)
    with np.errstate(all="ignore"):
        motion = _GroupMotion(at_infinity, focus_group)
        shift = 0.0 if math.isinf(object_distance) else motion.shift(object_distance)
    return shifted(at_infinity, focus_group, shift)


def shifted(configuration, focus_group, shift):
    """Return the lens with a group moved.

    Parameters
    ----------
    configuration : Configuration
    focus_group : FocusGroup
    shift : float
        mm towards the scene; negative towards the sensor.

    Returns
    -------
    Configuration
    """
    surfaces = configuration.surfaces
    behind = surfaces[focus_group.last - 1].thickness + shift
    moved = configuration.with_thickness(focus_group.last, max(behind, 0.0))
    if focus_group.first == 1:
        return moved
    before = surfaces[focus_group.first - 2].thickness - shift
    return moved.with_thickness(focus_group.first - 1, max(before, 0.0))


def _whole_lens(configuration, object_distance, infinity):
    last = len(configuration.surfaces)
    if math.isinf(object_distance):
        behind = infinity
    else:
        front_focus = -first_order(configuration).ffl
        if object_distance <= front_focus:
            raise PrescriptionError(
                f"focus distance {object_distance:g} mm is out of reach: objects must be more than"
                f" {front_focus:.6g} mm in front of the lens"
            )
        behind = image_distance(configuration, object_distance)
    if not behind > 0.0:
        raise PrescriptionError(
            f"the image of an object at {object_distance:g} mm lies {-behind:g} mm inside the"
            " lens; there can be no sensor"
        )
    return configuration.with_thickness(last, behind)


class _GroupMotion:
    """The matrix from surface 1 to the sensor as a polynomial in the shift of a group.

    Coefficients stand in `terms`, of shift^0, shift^1 and shift^2.
    """

    def __init__(self, configuration, group):
        count = len(configuration.surfaces)
        if not 1 <= group.first <= group.last <= count:
            raise PrescriptionError(
                f"focus group has surfaces {group.first} to {group.last}; the lens has 1 to {count}"
            )
        surfaces = configuration.surfaces
        media = indices(configuration, REFERENCE_WAVELENGTH_NM)
        self.group = group
        self.least = -surfaces[group.last - 1].thickness
        # A group that holds the front lens has only the scene before it.
        self.most = math.inf if group.first == 1 else surfaces[group.first - 2].thickness

        def part(first, last):
            return ray_matrix(configuration, REFERENCE_WAVELENGTH_NM, "y", first, last)

        front = part(1, group.first - 1)
        gap = np.eye(2)
        slide = np.zeros((2, 2))
        if group.first > 1:
            gap = transfer(surfaces[group.first - 2].thickness, media[group.first - 1])
            slide = -_per_distance(media[group.first - 1])
        back = transfer(surfaces[group.last - 1].thickness, media[group.last])
        if group.last < count:
            rest = transfer(surfaces[-1].thickness, media[-1]) @ part(group.last + 1, count)
        else:
            rest = np.eye(2)
        own, grow = part(group.first, group.last), _per_distance(media[group.last])
        self.terms = (
            rest @ back @ own @ gap @ front,
            rest @ (grow @ own @ gap + back @ own @ slide) @ front,
            rest @ grow @ own @ slide @ front,
        )

    def shift(self, object_distance):
        """Shift, nearest to 0, that brings an object into focus, mm."""
        # A ray from the axial point with slope 1 is as high as the distance at surface 1.
        start = [object_distance, 1.0]
        heights = [float((term @ start)[0]) for term in self.terms]
        reachable = [s for s in _real_roots(heights) if self.least <= s <= self.most]
        if not reachable:
            raise PrescriptionError(self._refusal(object_distance))
        return min(reachable, key=abs)

    def _refusal(self, object_distance):
        what = (
            f"focus distance {object_distance:g} mm is out of reach of the focus group (surfaces"
            f" {self.group.first} to {self.group.last})"
        )
        ends = [s for s in (self.least, self.most) if math.isfinite(s)]
        nearest = min((d for d in map(self._object_distance, ends) if d > 0.0), default=math.inf)
        if math.isinf(nearest):
            return f"{what}; it can only be focused at infinity"
        return f"{what}; the nearest distance is {nearest:.6g} mm"

    def _object_distance(self, shift):
        total = sum(term * shift**power for power, term in enumerate(self.terms))
        (a, b) = total[0].tolist()
        return -b / a if abs(a) > 0.0 else math.inf


def _per_distance(index):
    return np.array([[0.0, 1.0 / index], [0.0, 0.0]])


def _real_roots(coefficients):
    """Real roots of c0 + c1 s + c2 s^2, without cancellation."""
    c, b, a = coefficients
    if not all(map(math.isfinite, coefficients)):
        return []
    discriminant = b * b - 4.0 * a * c
    if discriminant < 0.0:
        return []
    q = -0.5 * (b + math.copysign(math.sqrt(discriminant), b))
    return [top / bottom for top, bottom in ((c, q), (q, a)) if bottom != 0.0]
