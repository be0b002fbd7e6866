"""What traced rays tell of a lens whose file does not: clear radii, fields and coverage."""

import math

import numpy as np

from ...errors import PrescriptionError
from ...optics.aiming import chief_ray
from ...optics.beam import Beam
from ...optics.glass import REFERENCE_WAVELENGTH_NM
from ...optics.pupil import stop_outline
from ...optics.trace import trace
from ...optics.vignetting import area_passing

# A lens covers the field where at least this share of the beam of the axis gets through. Lenses of
# published prescriptions let 20 to 60 % through at the corner that their makers give.
COVERED_SHARE = 0.25
# Beyond this, in degrees, no rectilinear lens and few others see.
WIDEST_FIELD = 89.0
# Halvings of the search for a field: to 0.02 degrees.
_HALVINGS = 12
# Directions around the stop's rim, and rays along the side of a pupil, of a search.
_RIM_RAYS, _GRID = 64, 61


def beam_radii(configuration, fields_deg):
    """Return how far from the axis the full beams of fields meet each surface.

    Parameters
    ----------
    configuration : Configuration
        The stop's rim bounds the beams, the other rims do not count.
    fields_deg : sequence of float

    Returns
    -------
    ndarray of shape (S,)
        mm; 0 for a surface that no ray meets.
    list of float
        Fields of which no ray gets through, degrees.
    """
    radii = np.zeros(len(configuration.surfaces))
    lost = []
    for field in fields_deg:
        beam = Beam.from_infinity(field)
        edge = stop_outline(configuration, beam, directions=_RIM_RAYS).points
        if len(edge):
            rays = beam.rays(edge)
            traced = trace(configuration, rays, REFERENCE_WAVELENGTH_NM, clip=False, record=True)
            hits = traced.hits[:, traced.reached]
            if hits.size:
                radii = np.maximum(radii, np.hypot(hits[..., 0], hits[..., 1]).max(axis=1))
                continue
        lost.append(field)
    return radii, lost


def field_of_height(configuration, height):
    """Return the field whose chief ray meets the picture at a height.

    Parameters
    ----------
    configuration : Configuration
    height : float
        mm, positive.

    Returns
    -------
    float or None
        Degrees; None if no chief ray reaches that height.
    """

    def reach(field):
        beam = Beam.from_infinity(field)
        start = chief_ray(configuration, beam)
        if start is None:
            return math.inf
        rays = beam.rays(start[None])
        traced = trace(configuration, rays, REFERENCE_WAVELENGTH_NM, clip=False)
        if not traced.reached[0]:
            return math.inf
        return float(np.hypot(*traced.at_plane(configuration.sensor)[0]))

    low, high = 0.0, WIDEST_FIELD
    for _ in range(2 * _HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if reach(middle) < height else (low, middle)
    return low if math.isfinite(reach(high)) else None


def coverage(configuration):
    """Return the half field that a lens covers.

    Parameters
    ----------
    configuration : Configuration

    Returns
    -------
    float
        Degrees, to a tenth, where `COVERED_SHARE` of the axial beam still gets through; 0 if
        nothing does.
    """
    wanted = COVERED_SHARE * _open_area(configuration, 0.0)
    low, high = 0.0, WIDEST_FIELD
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        covered = wanted > 0.0 and _open_area(configuration, middle) >= wanted
        low, high = (middle, high) if covered else (low, middle)
    return round(low, 1)


def _open_area(configuration, field):
    try:
        return area_passing(configuration, Beam.from_infinity(field), grid=_GRID)
    except PrescriptionError:
        return 0.0
