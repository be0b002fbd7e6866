"""Coordinates of a raster in the lens' field, and the field maps tabulated over the field."""

import numpy as np

from ...sampling.field_maps import field_corner

# Columns of the field table, for radial maps and for maps that depend on the angle; the error of
# linear interpolation is below 1e-4 of a map's change, except where it is clamped.
_COLUMNS, _COLUMNS_TURNING = 2048, 512
_ROWS_TURNING = 256


def picture_radius(projection, orthographic):
    """Return the distance from the axis, in the field, of a picture's outermost corner."""
    corner = field_corner(projection, orthographic)
    return corner if orthographic else float(np.tan(corner))


def field_of_clip(clip, projection):
    """Convert places of the picture to places of the field.

    Parameters
    ----------
    clip : ndarray of shape (..., 2)
        From -1 to 1.
    projection : ndarray of shape (4, 4)

    Returns
    -------
    ndarray of shape (..., 2)
    """
    parallel = projection[3, 3] != 0.0
    offset = -projection[:2, 3] if parallel else projection[:2, 2]
    return (clip + offset) / np.diag(projection)[:2]


def field_of_raster(projection, film):
    """Return scale and offset from pixels of the region to the field, shape (4,).

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
        Of the whole picture.
    film : Film
    """
    size = np.array([film.width, film.height])
    first = np.array(film.region[:2])
    low, high = (field_of_clip(2.0 * p / size - 1.0, projection) for p in (first, first + size))
    return np.concatenate([(high - low) / size, low])


def diamond_turn(place):
    """Return the angle of places round the axis as a diamond angle, from 0 to 4.

    Parameters
    ----------
    place : ndarray of shape (..., 2)

    Returns
    -------
    ndarray of shape (...)
        In [0, 4]; 1 is the y axis, 2 the negative x axis.
    """
    x, y = np.moveaxis(place, -1, 0)
    side = y / np.maximum(np.abs(x) + np.abs(y), 1e-30)
    return np.where(x < 0.0, 2.0 - side, np.where(side < 0.0, 4.0 + side, side))


def diamond_angles(rows):
    """Return the angles, in radians, of the rows of a field table, shape (rows,)."""
    turn = 4.0 * np.arange(rows) / rows
    y = np.where(turn <= 3.0, 1.0 - np.abs(turn - 1.0), turn - 4.0)
    x = np.abs(turn - 2.0) - 1.0
    return np.arctan2(y, x)


def field_table(aberration, radius, parallel):
    """Tabulate the two field maps; see `ChromaticPlan`.

    Parameters
    ----------
    aberration : sampling.chromatic.ChromaticAberration
    radius : float
    parallel : bool

    Returns
    -------
    ndarray of shape (R, C, 2)
        float32.
    """
    maps = aberration.axial_map, aberration.lateral_map
    turning = any(field_map.is_angular for field_map in maps)
    rows, columns = (_ROWS_TURNING, _COLUMNS_TURNING) if turning else (1, _COLUMNS)
    away = np.linspace(0.0, 1.0, columns)[None]
    t = away if parallel else np.arctan(away * radius) / np.arctan(radius)
    theta = diamond_angles(rows)[:, None]
    values = [np.broadcast_to(field_map(t, theta), (rows, columns)) for field_map in maps]
    return np.stack(values, axis=-1).astype(np.float32)
