"""Radial distortion by the division model, its inverse, and the coefficient of a real lens.

``u = c + (d - c) / (1 + K |d - c|^2)``: d is the distorted place, u the undistorted one, c the
centre. K < 0 is barrel, K > 0 pincushion. Lengths are in any one unit; K is per its square.
The inverse on the radius is ``r_d = 2 r_u / (1 + sqrt(1 - 4 K r_u^2))``.

References
----------
Fitzgibbon, Simultaneous linear estimation of multiple view geometry and lens distortion, CVPR 2001.
"""

import numpy as np

from ...errors import InputError


def undistorted(points, k, centre=(0.0, 0.0)):
    """Convert points of a distorted picture to undistorted ones.

    Parameters
    ----------
    points : ndarray of shape (..., 2)
    k : float
        Coefficient; negative for barrel.
    centre : tuple of float

    Returns
    -------
    ndarray of shape (..., 2)

    Raises
    ------
    InputError
        If a point lies at or beyond the model's reach, radius 1 / sqrt(|k|).
    """
    offset = np.asarray(points, dtype=float) - centre
    divisor = 1.0 + k * np.sum(offset**2, axis=-1, keepdims=True)
    # Beyond |k| r^2 = 1 the model folds (k > 0) or has a pole (k < 0).
    if np.any(np.abs(divisor - 1.0) >= 1.0):
        raise InputError(
            f"distortion {k:g} reaches to a radius of {1.0 / np.sqrt(abs(k)):.6g} from the centre,"
            " the picture goes farther; use a coefficient nearer to 0"
        )
    return centre + offset / divisor


def distorted(points, k, centre=(0.0, 0.0)):
    """Convert undistorted points to points of the distorted picture; inverse of `undistorted`.

    Parameters
    ----------
    points : ndarray of shape (..., 2)
    k : float
        Coefficient; negative for barrel.
    centre : tuple of float

    Returns
    -------
    ndarray of shape (..., 2)
        For k > 0, points beyond radius 1 / (2 sqrt(k)) have no place in the picture; they get
        the place of the nearest one that has.
    """
    offset = np.asarray(points, dtype=float) - centre
    square = np.sum(offset**2, axis=-1, keepdims=True)
    if k > 0.0:
        over = np.maximum(4.0 * k * square, 1.0)
        offset = offset / np.sqrt(over)
        square = square / over
    return centre + 2.0 * offset / (1.0 + np.sqrt(np.maximum(1.0 - 4.0 * k * square, 0.0)))


def fitted_coefficient(undistorted_radii, distorted_radii):
    """Fit the coefficient of the division model to a lens.

    Least squares on the radii ``r_u (1 + K r_d^2) = r_d``, with the scale of the picture left
    free, as the focal length of a distorted picture is a matter of convention.

    Parameters
    ----------
    undistorted_radii, distorted_radii : ndarray of shape (N,)
        Image heights without distortion (focal length times tangent of the field angle) and as
        traced, in one unit; at least two that are not zero.

    Returns
    -------
    k : float
        Per square of that unit.
    scale : float
        Factor of the undistorted radii at the centre of the picture.

    Raises
    ------
    InputError
        If the radii do not determine a coefficient.
    """
    u = np.asarray(undistorted_radii, dtype=float)
    d = np.asarray(distorted_radii, dtype=float)
    if np.count_nonzero(u * d) < 2:
        raise InputError("a distortion needs at least two image heights that are not zero")
    # r_d = s r_u + s K (r_u r_d^2): linear in s and s K.
    columns = np.stack([u, u * d**2], axis=-1)
    (scale, product), _, rank, _ = np.linalg.lstsq(columns, d, rcond=None)
    if rank < 2 or scale == 0.0:
        raise InputError("all image heights are alike; a distortion needs different ones")
    return float(product / scale), float(scale)
