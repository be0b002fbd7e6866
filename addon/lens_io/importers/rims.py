"""Clear radii, fields and coverage of a lens, by traced rays, where its file lacks them."""

import numpy as np

from ...optics.glass import REFERENCE_WAVELENGTH_NM
from ...optics.rays.aiming import aim
from ...optics.rays.beam import Beam
from ...optics.rays.pupil import grid_of, passing
from ...optics.rays.trace import Rays, trace
from ...optics.surfaces import sag

# A lens covers the field where at least this share of the axial beam gets through, two stops less
# than on the axis. At the corners that their makers give, thirty lenses of published prescriptions
# let 12 to 99 % through, half of them 30 to 57 %; the quarter lies 0 to 8 degrees further out.
COVERED_SHARE = 0.25
# Largest half field that is searched, degrees: no rectilinear lens sees farther.
WIDEST_FIELD = 89.0
# Chief rays between which fields are interpolated (to 1e-4 degrees), and the steepest at the stop.
_CHIEF_RAYS, _STEEPEST = 2001, np.radians(80.0)
# Rays through the stop's rim.
_RIM_RAYS = 32
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
    around = np.linspace(0.0, 2.0 * np.pi, _RIM_RAYS, endpoint=False)
    rim = configuration.surfaces[configuration.stop - 1].semi_diameter
    edge = rim * np.stack([np.cos(around), np.sin(around)], axis=-1)
    for field in fields_deg:
        beam = Beam.from_infinity(field)
        aimed = aim(configuration, beam, edge)
        rays = beam.rays(aimed.coordinates[aimed.found])
        traced = trace(configuration, rays, REFERENCE_WAVELENGTH_NM, clip=False, record=True)
        hits = traced.hits[:, traced.reached]
        if hits.size:
            radii = np.maximum(radii, np.hypot(hits[..., 0], hits[..., 1]).max(axis=1))
        else:
            lost.append(field)
    return radii, lost


def fields_of_heights(configuration, heights):
    """Return the fields whose chief rays meet the picture at some heights.

    Chief rays start at the centre of the stop: backwards they tell the field, forwards the height.

    Parameters
    ----------
    configuration : Configuration
    heights : sequence of float
        mm, positive.

    Returns
    -------
    tuple of float or None
        Degrees; None if a chief ray does not reach one of the heights.
    """
    stop = configuration.stop
    slopes = np.linspace(0.0, _STEEPEST, _CHIEF_RAYS)
    directions = np.stack([np.zeros_like(slopes), np.sin(slopes), np.cos(slopes)], axis=-1)
    origins = np.zeros_like(directions)
    origins[:, 2] = configuration.vertices[stop - 1]
    wavelength = REFERENCE_WAVELENGTH_NM
    seen = trace(
        configuration,
        Rays(origins, -directions),
        wavelength,
        clip=False,
        last=stop - 1,
        backwards=True,
    )
    shown = trace(configuration, Rays(origins, directions), wavelength, clip=False, first=stop)
    angles = np.degrees(np.arctan2(np.abs(seen.directions[:, 1]), -seen.directions[:, 2]))
    reach = np.abs(shown.at_plane(configuration.sensor)[:, 1])
    # From the axis outwards, as far as the picture grows with the field.
    fits = seen.reached & shown.reached
    fits[1:] &= (np.diff(reach) > 0.0) & (np.diff(angles) > 0.0) & (angles[1:] < 90.0)
    count = len(fits) if fits.all() else int(np.argmin(fits))
    if count == 0 or max(heights) > reach[count - 1]:
        return None
    return tuple(float(angle) for angle in np.interp(heights, reach[:count], angles[:count]))


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
