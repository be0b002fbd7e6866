"""The real entrance pupil: which rays of an object point get through the lens.

A pupil is a region in the coordinates of a `Beam`. It is bounded by the stop as the object sees it
through the surfaces in front, and by every rim that cuts the beam; nothing paraxial is in it. Rays
that fill it stand on a regular grid, so each carries the same area across the beam (an object at
infinity) or its exact solid angle (a near point).
"""

from dataclasses import dataclass, replace

import numpy as np

from ..glass import REFERENCE_WAVELENGTH_NM
from ..paraxial import entrance_pupil
from ..surfaces import FAR, sag, within_reach
from .aiming import chief_ray
from .beam import Beam
from .trace import Rays, trace

# Rays along a side of the grid that searches the pupil, and number of its refinements.
SEARCH_GRID = 65
SEARCHES = 4
# Relative change of the box below which the search ends.
SHRINKS = 0.8
# Steps from the centre of a pupil to its edge, and halvings of the last one: to rounding, or to
# what a box with a margin needs.
MARCH = 48
HALVINGS, FEW_HALVINGS = 40, 6


@dataclass(frozen=True)
class PupilRays:
    """Rays of one beam that get through the lens.

    Parameters
    ----------
    rays : Rays
        N of them, from the plane of the beam's coordinates.
    coordinates : ndarray of shape (N, 2)
        u and v, mm.
    weights : ndarray of shape (N,)
        Area across the beam, mm^2, for an object at infinity; else solid angle, sr.
    box : tuple of float
        Of the grid, (u0, u1, v0, v1), mm; zeros if nothing gets through.
    grid : int
        Cells along each side of the box.
    """

    rays: Rays
    coordinates: np.ndarray
    weights: np.ndarray
    box: tuple[float, float, float, float]
    grid: int


@dataclass(frozen=True)
class PupilOutline:
    """Edge of a pupil.

    Parameters
    ----------
    centre : ndarray of shape (2,)
        u and v from which the edge was searched, mm.
    points : ndarray of shape (N, 2)
        u and v of the edge, mm, once around; empty if nothing gets through.
    area : float
        Of the polygon, mm^2.
    """

    centre: np.ndarray
    points: np.ndarray
    area: float

    @property
    def box(self):
        """Bounds (u0, u1, v0, v1) in mm; zeros if nothing gets through."""
        if not len(self.points):
            return (0.0, 0.0, 0.0, 0.0)
        (u0, v0), (u1, v1) = self.points.min(axis=0), self.points.max(axis=0)
        return (float(u0), float(u1), float(v0), float(v1))


def without_rims(configuration):
    """Return the lens without clipping by any rim but the stop's.

    Parameters
    ----------
    configuration : Configuration

    Returns
    -------
    Configuration
    """
    surfaces = tuple(
        surface if surface.is_stop else replace(surface, semi_diameter=np.inf)
        for surface in configuration.surfaces
    )
    return replace(configuration, surfaces=surfaces)


def as_beam(source):
    """Return the beam of a field angle in degrees, an object point, or a beam itself.

    Parameters
    ----------
    source : float, sequence of 3 float, or Beam

    Returns
    -------
    Beam

    Raises
    ------
    PrescriptionError
        If no beam enters the lens from there.
    """
    if isinstance(source, Beam):
        return source
    return Beam.from_infinity(source) if np.ndim(source) == 0 else Beam.from_point(source)


def passing(configuration, beam, coordinates, wavelength_nm=REFERENCE_WAVELENGTH_NM):
    """Return which rays of a beam get through the lens.

    Parameters
    ----------
    configuration : Configuration
    beam : Beam
    coordinates : ndarray of shape (N, 2)
    wavelength_nm : float

    Returns
    -------
    ndarray of bool, shape (N,)
    """
    return trace(configuration, beam.rays(coordinates), wavelength_nm).passed


def pupil_rays(configuration, source, grid=201, wavelength_nm=REFERENCE_WAVELENGTH_NM):
    """Return rays that fill the real entrance pupil, with their exact weights.

    Parameters
    ----------
    configuration : Configuration
    source : float, sequence of 3 float, or Beam
        Field angle of an object at infinity in degrees, object point in mm, or a beam.
    grid : int
        Cells along each side of the box around the pupil.
    wavelength_nm : float

    Returns
    -------
    PupilRays
        None in it if the pupil is closed; that is no error.

    Raises
    ------
    PrescriptionError
        If no beam enters the lens from `source`.
    """
    beam = as_beam(source)
    box = pupil_box(configuration, beam, wavelength_nm)
    if box is None:
        nothing = np.zeros((0, 2))
        return PupilRays(beam.rays(nothing), nothing, np.zeros(0), (0.0,) * 4, grid)
    coordinates, cell = grid_of(box, grid)
    coordinates = coordinates[passing(configuration, beam, coordinates, wavelength_nm)]
    weights = cell * beam.density(coordinates)
    return PupilRays(beam.rays(coordinates), coordinates, weights, box, grid)


def pupil_outline(configuration, source, directions=256, wavelength_nm=REFERENCE_WAVELENGTH_NM):
    """Find the edge of the real entrance pupil.

    Parameters
    ----------
    configuration : Configuration
    source : float, sequence of 3 float, or Beam
        As for `pupil_rays`.
    directions : int
        Points of the edge, at equal angles around the centre of the pupil.
    wavelength_nm : float

    Returns
    -------
    PupilOutline
        The part that is seen from the pupil's centre of gravity; pupils are the overlap of
        disks, so that is all of it.

    Raises
    ------
    PrescriptionError
        If no beam enters the lens from `source`.
    """
    beam = as_beam(source)
    box = pupil_box(configuration, beam, wavelength_nm)
    if box is None:
        return PupilOutline(np.zeros(2), np.zeros((0, 2)), 0.0)
    coordinates, _ = grid_of(box, SEARCH_GRID)
    open_ = coordinates[passing(configuration, beam, coordinates, wavelength_nm)]
    if not len(open_):
        return PupilOutline(np.zeros(2), np.zeros((0, 2)), 0.0)
    # The open cell nearest to the centre of gravity: the centre itself may be blocked.
    centre = open_[np.argmin(np.sum((open_ - open_.mean(axis=0)) ** 2, axis=1))]
    reach = float(np.hypot(box[1] - box[0], box[3] - box[2]))
    points = _edge(configuration, beam, centre, reach, directions, wavelength_nm)
    return PupilOutline(centre, points, _polygon_area(points))


def stop_outline(
    configuration,
    source,
    directions=256,
    wavelength_nm=REFERENCE_WAVELENGTH_NM,
    halvings=HALVINGS,
):
    """Find the edge of the stop as the object sees it, without clipping by any other rim.

    Rays far outside the rims can find another way to the stop; they do not belong to the edge
    that is seen from the chief ray.

    Parameters
    ----------
    configuration, source, directions, wavelength_nm
        As for `pupil_outline`.
    halvings : int
        Of the last step to the edge, 1/32 of the pupil's diameter.

    Returns
    -------
    PupilOutline
        Around the chief ray; empty if there is no such ray.

    Raises
    ------
    PrescriptionError
        If no beam enters the lens from `source`.
    """
    beam = as_beam(source)
    centre = chief_ray(configuration, beam, wavelength_nm)
    bare = without_rims(configuration)
    if centre is None or not passing(bare, beam, centre[None], wavelength_nm)[0]:
        return PupilOutline(np.zeros(2), np.zeros((0, 2)), 0.0)
    reach = min(1.5 * entrance_pupil(configuration, wavelength_nm)[1], FAR)
    points = _edge(bare, beam, centre, reach, directions, wavelength_nm, halvings)
    return PupilOutline(centre, points, _polygon_area(points))


def pupil_box(configuration, beam, wavelength_nm=REFERENCE_WAVELENGTH_NM):
    """Find bounds of the real entrance pupil.

    Parameters
    ----------
    configuration : Configuration
    beam : Beam
    wavelength_nm : float

    Returns
    -------
    tuple of float or None
        (u0, u1, v0, v1) in mm, with a small margin; None if nothing gets through.
    """
    places = _places(configuration, beam, wavelength_nm)
    found = [_search(configuration, beam, place, wavelength_nm) for place in places]
    found = np.array([box for box in found if box is not None])
    if not len(found):
        return None
    low, high = found.min(axis=0), found.max(axis=0)
    return (float(low[0]), float(high[1]), float(low[2]), float(high[3]))


def is_open(configuration, source, wavelength_nm=REFERENCE_WAVELENGTH_NM):
    """Return whether any light gets through the lens.

    Parameters
    ----------
    configuration, source, wavelength_nm
        As for `pupil_rays`.

    Returns
    -------
    bool

    Raises
    ------
    PrescriptionError
        If no beam enters the lens from `source`.
    """
    beam = as_beam(source)
    for place in _places(configuration, beam, wavelength_nm):
        coordinates, _ = grid_of(place, SEARCH_GRID)
        if passing(configuration, beam, coordinates, wavelength_nm).any():
            return True
    return False


def grid_of(box, cells):
    """Return the centres of the cells of a grid.

    Parameters
    ----------
    box : tuple of float
        (u0, u1, v0, v1), mm.
    cells : int
        Along each side.

    Returns
    -------
    coordinates : ndarray of shape (cells^2, 2)
        Row by row with rising v.
    area : float
        Of a cell, mm^2.
    """
    u0, u1, v0, v1 = box
    place = (np.arange(cells) + 0.5) / cells
    u, v = np.meshgrid(u0 + (u1 - u0) * place, v0 + (v1 - v0) * place)
    area = (u1 - u0) * (v1 - v0) / (cells * cells)
    return np.stack([u.ravel(), v.ravel()], axis=-1), area


def _places(configuration, beam, wavelength_nm):
    """Return boxes in which rays that get through may be."""
    # A grid over surface 1 could miss a small pupil, so it is also searched where the stop appears.
    stop = stop_outline(configuration, beam, 32, wavelength_nm, FEW_HALVINGS)
    if len(stop.points):
        yield _widened(stop.box, 0.1)
    # All that gets through hits surface 1 inside its rim.
    yield _front_box(configuration, beam)


def _front_box(configuration, beam):
    """Bounds of surface 1 as the object sees it."""
    front = configuration.surfaces[0]
    turn = np.linspace(0.0, 2.0 * np.pi, 65)
    radius = min(front.semi_diameter, FAR) * np.linspace(0.0, 1.0, 9)[:, None]
    x, y = (radius * np.cos(turn)).ravel(), (radius * np.sin(turn)).ravel()
    seen = beam.coordinates(within_reach(np.stack([x, y, sag(front, x, y)], axis=-1)))
    (u0, v0), (u1, v1) = seen.min(axis=0), seen.max(axis=0)
    return _widened((u0, u1, v0, v1), 0.02)


def _widened(box, share):
    u0, u1, v0, v1 = box
    u, v = share * (u1 - u0), share * (v1 - v0)
    return (u0 - u, u1 + u, v0 - v, v1 + v)


def _search(configuration, beam, box, wavelength_nm):
    """Bounds of what passes inside a box, by grids that close in on it."""
    for _ in range(SEARCHES):
        coordinates, _ = grid_of(box, SEARCH_GRID)
        open_ = coordinates[passing(configuration, beam, coordinates, wavelength_nm)]
        if not len(open_):
            return None
        (u0, v0), (u1, v1) = open_.min(axis=0), open_.max(axis=0)
        # The edge may be anywhere in the next cell, and a thin tip a little beyond it.
        u, v = 2.0 * (box[1] - box[0]) / SEARCH_GRID, 2.0 * (box[3] - box[2]) / SEARCH_GRID
        whole = (box[1] - box[0]) * (box[3] - box[2])
        box = (max(u0 - u, box[0]), min(u1 + u, box[1]), max(v0 - v, box[2]), min(v1 + v, box[3]))
        if (box[1] - box[0]) * (box[3] - box[2]) > SHRINKS * whole:
            break
    return box


def _edge(configuration, beam, centre, reach, directions, wavelength_nm, halvings=HALVINGS):
    """Return the first blocked place in each direction from an open centre."""
    turn = np.linspace(0.0, 2.0 * np.pi, directions, endpoint=False)
    way = np.stack([np.cos(turn), np.sin(turn)], axis=-1)

    def is_open(radii):
        coordinates = centre + radii[..., None] * way
        passed = passing(configuration, beam, coordinates.reshape(-1, 2), wavelength_nm)
        return passed.reshape(radii.shape)

    steps = reach * np.arange(1, MARCH + 1) / MARCH
    open_ = is_open(np.broadcast_to(steps[:, None], (MARCH, directions)))
    closed_at = np.where(open_.all(axis=0), MARCH - 1, np.argmin(open_, axis=0))
    outside = steps[closed_at]
    inside = np.where(closed_at > 0, steps[closed_at - 1], 0.0)
    for _ in range(halvings):
        middle = 0.5 * (inside + outside)
        open_ = is_open(middle)
        inside, outside = np.where(open_, middle, inside), np.where(open_, outside, middle)
    return centre + inside[:, None] * way


def _polygon_area(points):
    u, v = points.T
    return 0.5 * abs(float(np.sum(u * np.roll(v, -1) - v * np.roll(u, -1))))
