"""What traced rays tell of a lens whose file does not: clear radii, fields and coverage."""

import math

import numpy as np

from ...optics.aiming import chief_ray
from ...optics.beam import Beam
from ...optics.glass import REFERENCE_WAVELENGTH_NM
from ...optics.pupil import grid_of, passing, stop_outline
from ...optics.surfaces import sag
from ...optics.trace import trace

# A lens covers the field where at least this share of the axial beam gets through, two stops less
# than on the axis. At the corners that their makers give, thirty lenses of published prescriptions
# let 12 to 99 % through, half of them 30 to 57 %; the quarter lies 0 to 8 degrees further out.
COVERED_SHARE = 0.25
# Beyond this, in degrees, no rectilinear lens and few others see.
WIDEST_FIELD = 89.0
# Halvings of the search for a field: to 1e-5 degrees.
_HALVINGS = 24
# Directions around the stop's rim.
_RIM_RAYS = 64
# Halvings of the search for the coverage, to 0.1 degrees, and rays along the side of its two grids.
_COVERAGE_HALVINGS = 10
_GRIDS = (41, 31)


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
    for _ in range(_HALVINGS):
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
    for _ in range(_COVERAGE_HALVINGS if wanted > 0.0 else 0):
        middle = 0.5 * (low + high)
        covered = _open_area(configuration, middle) >= wanted
        low, high = (middle, high) if covered else (low, middle)
    return round(low, 1)


def _open_area(configuration, field):
    # The rays that meet the first surface inside its rim, then those around the ones that pass:
    # a few per cent are good enough for a nominal angle, and damaged files must not take long.
    beam = Beam.from_infinity(field)
    box = _front_box(configuration.surfaces[0], beam)
    for cells in _GRIDS:
        coordinates, cell = grid_of(box, cells)
        open_ = coordinates[passing(configuration, beam, coordinates)]
        if not len(open_):
            return 0.0
        (u0, v0), (u1, v1) = open_.min(axis=0), open_.max(axis=0)
        du, dv = (box[1] - box[0]) / cells, (box[3] - box[2]) / cells
        box = (u0 - du, u1 + du, v0 - dv, v1 + dv)
    return cell * len(open_)


def _front_box(surface, beam):
    radius, angle = np.meshgrid(np.linspace(0.0, surface.semi_diameter, 9), np.arange(0, 6.4, 0.2))
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    points = np.stack([x, y, np.nan_to_num(sag(surface, x, y))], axis=-1)
    u, v = points @ beam.across, points @ beam.up
    return (u.min(), u.max(), v.min(), v.max())
