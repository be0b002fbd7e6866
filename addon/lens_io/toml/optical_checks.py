"""Checks that need first-order values or traced rays (E16, E24, E25, W01 to W06).

First-order values are those at the reference wavelength; in a lens with cylinders those of the
meridian y are compared with the nominal ones.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...errors import PrescriptionError
from ...optics.glass import REFERENCE_WAVELENGTH_NM, Air
from ...optics.media import indices
from ...optics.paraxial import LEAST_POWER, entrance_pupil, first_order, power
from ...optics.prescription import Configuration
from ...optics.rays.trace import Rays, trace
from ...optics.surfaces import FAR, sag

# Allowed differences between computed and nominal values, as shares.
FOCAL_LENGTH_TOLERANCE = 0.02
F_NUMBER_TOLERANCE = 0.03
BACK_FOCUS_TOLERANCE = 0.05
# Share of the half field at which light must get through.
CHECKED_FIELD = 0.7
# Rims that overlap by less touch: mm, above the rounding of sags and below every tolerance.
LEAST_OVERLAP = 1.0e-9
# Radius of the entrance pupil, mm: beyond these a stop has no image that light could fill.
SMALLEST_OPENING, LARGEST_OPENING = 1.0e-9, 1.0e9
# Rays along the diameter of the first surface, rounds of search between two of them, and rays along
# the side of a square grid on it.
FAN, ROUNDS, GRID = 101, 3, 31


@dataclass(frozen=True)
class CheckedPosition:
    """A lens at one zoom position, as the checks take it.

    Parameters
    ----------
    configuration : Configuration
        Nominal values that are not known are None.
    nominal : str
        Path of the table with the nominal values: ``lens`` or ``zoom[2]``.
    moved : frozenset of str
        Ids whose distances the position sets.
    """

    configuration: Configuration
    nominal: str = "lens"
    moved: frozenset[str] = frozenset()

    @property
    def is_zoom(self):
        """Whether this is a position of a zoom lens."""
        return self.nominal != "lens"

    def whole(self, number=None):
        """Path of what the surfaces give together, or of one surface."""
        if self.is_zoom:
            return self.nominal
        return "surface" if number is None else f"surface[{number}]"

    def thickness(self, number):
        """Path of the distance behind a surface."""
        name = self.configuration.surfaces[number - 1].id
        if name in self.moved:
            return f"{self.nominal}.thickness_mm.{name}"
        return f"surface[{number}].thickness_mm"


def asphere_fault(surface):
    """Find where the sag of an asphere is not finite inside its rim.

    Parameters
    ----------
    surface : Surface

    Returns
    -------
    float or None
        Radius in mm, to 1 part in 1e6; None if the sag is finite everywhere.
    """
    if not surface.asphere:
        return None
    low, high = 0.0, surface.semi_diameter
    radii = np.linspace(low, high, 65)
    bad = ~np.isfinite(_sags(surface, radii))
    if not bad.any():
        return None
    first = int(np.argmax(bad))
    low, high = float(radii[max(first - 1, 0)]), float(radii[first])
    while high - low > 1.0e-6 * high:
        middle = 0.5 * (low + high)
        if np.isfinite(_sags(surface, middle)):
            low = middle
        else:
            high = middle
    return high


def check_dispersion(surfaces, findings):
    """Note glasses without dispersion (W02).

    Parameters
    ----------
    surfaces : sequence of (Surface or None)
    findings : Findings
    """
    for number, surface in enumerate(surfaces, 1):
        if surface is None or isinstance(surface.glass, Air) or surface.glass.has_dispersion:
            continue
        findings.add(
            "W02",
            f"surface[{number}].material",
            f"the glass behind surface {number} has the same index at every wavelength; "
            "give its Abbe number vd for colour errors",
        )


def check_position(position, findings):
    """Check a lens at one zoom position (E24, E25, W01, W03 to W06).

    Parameters
    ----------
    position : CheckedPosition
    findings : Findings
    """
    before = len(findings.errors)
    _check_power(position, findings)
    openings = _check_pupil(position, findings)
    lit = _check_rays(position, openings, findings)
    _check_rims(position, findings)
    if len(findings.errors) > before:
        return
    try:
        values = first_order(position.configuration)
    except PrescriptionError as error:
        findings.add("E24", position.whole(), str(error))
        return
    _check_nominal(position, values, findings)
    if not lit:
        _check_field(position, findings)


def _check_power(position, findings):
    for meridian in _meridians(position.configuration):
        value = power(position.configuration, meridian=meridian)
        if math.isfinite(value) and value >= LEAST_POWER:
            continue
        if not math.isfinite(value):
            what = "a power that is not a finite number; its figures are too large"
        elif abs(value) < LEAST_POWER:
            what = f"no power: 1 / focal length is {value + 0.0:.3g} per mm"
        else:
            behind = indices(position.configuration, REFERENCE_WAVELENGTH_NM)[-1]
            what = f"a focal length of {behind / value:.6g} mm; it must be positive"
        where = "" if position.configuration.of_revolution else f" in the meridian {meridian}"
        findings.add("E24", position.whole(), f"the prescription has {what}{where}")


def _check_pupil(position, findings):
    """Return the radius of the entrance pupil in each meridian where there is one."""
    configuration = position.configuration
    stop = configuration.stop
    openings = {}
    for meridian in _meridians(configuration):
        try:
            _, diameter = entrance_pupil(configuration, meridian=meridian)
        except PrescriptionError as error:
            findings.add("E25", position.whole(stop), str(error))
            continue
        height = 0.5 * diameter
        if not SMALLEST_OPENING <= height <= LARGEST_OPENING:
            findings.add(
                "E25",
                position.whole(stop),
                f"the stop (surface {stop}) has an image of {height:.3g} mm radius in object "
                f"space; it must be {SMALLEST_OPENING:g} to {LARGEST_OPENING:g} mm",
            )
            continue
        openings[meridian] = height
    return openings


def _check_rays(position, openings, findings):
    """Check the axial rays at full opening; return whether light of the checked field was seen."""
    configuration = position.configuration
    half_field = configuration.half_field_deg
    rays = [
        ([[0.0, height, 0.0] if meridian == "y" else [height, 0.0, 0.0]], [[0.0, 0.0, 1.0]])
        for meridian, height in openings.items()
    ]
    if half_field is not None:
        heights = _fan(configuration)
        rays.append(_beam(configuration, 0.0 * heights, heights, CHECKED_FIELD * half_field))
    if not rays:
        return False
    # One trace for both: the time goes into the steps from surface to surface.
    origins, directions = (np.concatenate(parts) for parts in zip(*rays, strict=True))
    traced = trace(configuration, Rays(origins, directions), REFERENCE_WAVELENGTH_NM, clip=False)
    for number, height in enumerate(openings.values()):
        if traced.reached[number]:
            continue
        surface = int(traced.surface[number])
        findings.add(
            "E25",
            position.whole(surface),
            f"the axial ray at full opening, {height:.6g} mm from the axis, fails at surface "
            f"{surface}: it misses the surface or is totally reflected; "
            "check its radius, or close the stop",
        )
    return half_field is None or bool(traced.passed[len(openings) :].any())


def _check_rims(position, findings):
    surfaces = position.configuration.surfaces
    noted = {warning.path for warning in findings.warnings if warning.code == "W04"}
    with np.errstate(all="ignore"):
        gaps = _rim_gaps(surfaces)
    for number, (this, following) in enumerate(zip(surfaces, surfaces[1:], strict=False), 1):
        path = position.thickness(number)
        rim = min(this.semi_diameter, following.semi_diameter)
        overlap = -gaps[number - 1]
        if path in noted or not (math.isfinite(overlap) and overlap > LEAST_OVERLAP):
            continue
        if this.thickness < 0.0:
            # A stop that the file puts inside its neighbour's bulge.
            continue
        findings.add(
            "W04",
            path,
            f"surfaces {number} and {number + 1} overlap by {overlap:.4g} mm at {rim:.6g} mm "
            "from the axis; check the distance and the semi-diameters",
        )


def _check_nominal(position, values, findings):
    configuration = position.configuration
    nominal = configuration.focal_length
    if nominal is not None and _differs(values.efl, nominal, FOCAL_LENGTH_TOLERANCE):
        findings.add(
            "W01",
            f"{position.nominal}.focal_length_mm",
            f"the prescription has a focal length of {values.efl:.6g} mm, the file says "
            f"{nominal:.6g} mm",
        )
    nominal = configuration.f_number
    if nominal is not None and _differs(values.f_number, nominal, F_NUMBER_TOLERANCE):
        findings.add(
            "W03",
            f"{position.nominal}.f_number",
            f"focal length over entrance pupil diameter is {values.f_number:.6g}, the file says "
            f"{nominal:.6g}",
        )
    last = len(configuration.surfaces)
    distance = configuration.surfaces[-1].thickness
    if distance != 0.0 and _differs(distance, values.bfl, BACK_FOCUS_TOLERANCE):
        findings.add(
            "W05",
            position.thickness(last),
            f"the last distance is {distance:.6g} mm, the paraxial back focal length "
            f"{values.bfl:.6g} mm",
        )


def _check_field(position, findings):
    half_field = position.configuration.half_field_deg
    if half_field is None:
        return
    field = CHECKED_FIELD * half_field
    if not light_passes(position.configuration, field):
        findings.add(
            "W06",
            f"{position.nominal}.half_field_deg",
            f"no ray gets through at {field:.6g} deg, {CHECKED_FIELD:.0%} of the half field of "
            f"{half_field:.6g} deg",
        )


def light_passes(configuration, field_deg):
    """Return whether light from infinity gets through a lens at a field angle.

    Parameters
    ----------
    configuration : Configuration
    field_deg : float
        The light travels in the direction (0, sin a, cos a).

    Returns
    -------
    bool
    """
    heights = _fan(configuration)
    for _ in range(ROUNDS):
        traced = _trace_beam(configuration, np.zeros_like(heights), heights, field_deg)
        if traced.passed.any():
            return True
        # The beam may be thinner than the fan is dense: look on both sides of the ray that got
        # farthest, and there passed nearest to the axis.
        farthest = np.flatnonzero(traced.surface == traced.surface.max())
        height = np.hypot(traced.points[farthest, 0], traced.points[farthest, 1])
        best = farthest[np.argmin(height)]
        near = heights[max(best - 1, 0)], heights[min(best + 1, FAN - 1)]
        heights = np.linspace(*near, FAN)
    if configuration.of_revolution:
        # Round rims about the axis are symmetric to the meridian of the field: a beam that gets
        # through has rays in it.
        return False
    rim = _front_rim(configuration)
    x, y = np.meshgrid(*2 * [np.linspace(-rim, rim, GRID)])
    inside = np.hypot(x, y) <= rim
    return bool(_trace_beam(configuration, x[inside], y[inside], field_deg).passed.any())


def _fan(configuration):
    rim = _front_rim(configuration)
    return np.linspace(-rim, rim, FAN)


def _front_rim(configuration):
    # No ray meets a surface farther out.
    return min(configuration.surfaces[0].semi_diameter, FAR)


def _trace_beam(configuration, x, y, field_deg):
    rays = Rays(*_beam(configuration, x, y, field_deg))
    return trace(configuration, rays, REFERENCE_WAVELENGTH_NM)


def _beam(configuration, x, y, field_deg):
    """Origins and directions of parallel rays through points of the first surface."""
    angle = math.radians(field_deg)
    z = np.nan_to_num(sag(configuration.surfaces[0], x, y), nan=0.0)
    directions = np.tile([0.0, math.sin(angle), math.cos(angle)], (len(x), 1))
    return np.stack([x, y, z], axis=-1), directions


def _meridians(configuration):
    return ("y",) if configuration.of_revolution else ("y", "x")


def _sags(surface, radii):
    across = np.zeros_like(radii)
    return (
        sag(surface, across, radii) if surface.curved_along == "y" else sag(surface, radii, across)
    )


def _on_axes(radii):
    """Points at some radii on the axes x (row 0) and y (row 1), shapes (2, N)."""
    nowhere = np.zeros_like(radii)
    return np.stack([radii, nowhere]), np.stack([nowhere, radii])


def _rim_gaps(surfaces):
    """Distances between neighbouring surfaces at the smaller of their rims, mm.

    The smallest of the meridians x and y.
    """
    radii = [surface.semi_diameter for surface in surfaces]
    rims = np.minimum(radii, [*radii[1:], radii[-1]])
    sags = [
        sag(surface, *_on_axes(np.array([before, rim])))
        for surface, before, rim in zip(surfaces, [rims[0], *rims[:-1]], rims, strict=True)
    ]
    return [
        float(np.min(this.thickness + following[:, 0] - here[:, 1]))
        for this, here, following in zip(surfaces, sags, sags[1:], strict=False)
    ]


def _differs(value, wanted, tolerance):
    return not abs(value - wanted) <= tolerance * abs(wanted)
