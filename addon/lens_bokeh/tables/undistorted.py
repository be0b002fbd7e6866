"""What a lens does to straight lines, taken away from places on its sensor."""

import numpy as np

from .spline import spline_values


def undistorted(distorted, places):
    """Return the field of each distance from the axis on the sensor; odd, and linear far out.

    Parameters
    ----------
    distorted : ndarray of shape (M, 2)
        Fields (tangents), and where the ray through the middle of the iris lands of a point in
        focus there, over the scale of the picture; both rising from 0.
    places : ndarray of shape (P,)

    Returns
    -------
    ndarray of shape (P,)
    """
    fields, landing = distorted.T
    nodes, values = (np.concatenate([-each[:0:-1], each]) for each in (landing, fields))
    last = landing[-1]
    inner = spline_values(nodes, values, np.minimum(places, last))
    (end,) = spline_values(nodes, values, np.array([last * (1.0 - 1e-4)]))
    slope = (fields[-1] - end) / (1e-4 * last)
    return inner + slope * np.maximum(places - last, 0.0)
