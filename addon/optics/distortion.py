"""Radial distortion by a division model of several terms, its inverse, and its fit to a lens.

``u = c + (d - c) / D(s)``, ``D(s) = 1 + K1 s + K2 s^2 + ...`` with ``s = |d - c|^2``: d is the
distorted place, u the undistorted one, c the centre. With one term, K < 0 is a barrel, K > 0 a
pincushion. Lengths are in any one unit; Ki is per its 2i-th power.

References
----------
Fitzgibbon, Simultaneous linear estimation of multiple view geometry and lens distortion, CVPR 2001
(one term).
"""

import numpy as np

from ..errors import InputError

# Terms that a picture's distortion has at most.
TERMS = 4

# Most steps of the inverse; Newton's steps double the digits, and bisection takes its turns.
_STEPS = 60
# Bound of a distorted radius as a multiple of the undistorted one.
_FARTHEST = 100.0
# Relative error at which it ends.
_EXACT = 1e-15
# Samples of the radius between which a mapping is assumed not to turn back.
_RADII = 257


def divisor(square, terms):
    """Return D at squares of distorted radii, shape (...)."""
    found = np.zeros_like(np.asarray(square, dtype=float))
    for term in reversed(terms):
        found = (found + term) * square
    return 1.0 + found


def slope(square, terms):
    """Return ``D^2 du/dd`` along the radius at squares of distorted radii, shape (...)."""
    # D - 2 s D'.
    weighed = [(2 * power - 1) * term for power, term in enumerate(terms, 1)]
    return 2.0 - divisor(square, weighed)


def is_invertible(terms, radius):
    """Whether no two places of a distorted picture up to a radius show the same."""
    squares = np.linspace(0.0, radius, _RADII) ** 2
    return bool((divisor(squares, terms) > 0.0).all() and (slope(squares, terms) > 0.0).all())


def most_magnified(terms):
    """Return the largest ``dd/du`` within the radius 1: how much finer the undistorted must be."""
    squares = np.linspace(0.0, 1.0, _RADII) ** 2
    value = divisor(squares, terms)
    return float(np.maximum(value**2 / slope(squares, terms), value).max())


def undistorted(points, terms, centre=(0.0, 0.0)):
    """Convert points of a distorted picture to undistorted ones.

    Parameters
    ----------
    points : ndarray of shape (..., 2)
    terms : sequence of float
        K1, K2, ...
    centre : tuple of float

    Returns
    -------
    ndarray of shape (..., 2)

    Raises
    ------
    InputError
        If a point lies at or beyond the model's reach, where the picture would fold.
    """
    offset = np.asarray(points, dtype=float) - centre
    square = np.sum(offset**2, axis=-1, keepdims=True)
    reach = float(np.sqrt(square.max(initial=0.0)))
    if not is_invertible(terms, reach):
        told = ", ".join(f"{term:g}" for term in terms)
        raise InputError(
            f"distortion {told} folds the picture within its radius of {reach:.6g} from the centre;"
            " use coefficients nearer to 0"
        )
    return centre + offset / divisor(square, terms)


def distorted(points, terms, centre=(0.0, 0.0)):
    """Convert undistorted points to points of the distorted picture; inverse of `undistorted`.

    Parameters
    ----------
    points : ndarray of shape (..., 2)
    terms : sequence of float
        K1, K2, ...
    centre : tuple of float

    Returns
    -------
    ndarray of shape (..., 2)
        Where a mapping turns back, points beyond have no place in the picture; they get that of
        the nearest one that has.
    """
    offset = np.asarray(points, dtype=float) - centre
    radius = np.sqrt(np.sum(offset**2, axis=-1, keepdims=True))
    found = distorted_radius(radius, terms)
    return centre + offset * (found / np.where(radius > 0.0, radius, 1.0))


def distorted_radius(radius, terms):
    """Return the distorted radii of undistorted ones, shape (...); as `distorted`."""
    radius = np.asarray(radius, dtype=float)
    # Between the axis and where the mapping turns back or ends.
    low, high = np.zeros_like(radius), np.minimum(_reach(terms), _FARTHEST * radius)
    place = np.minimum(radius, 0.999 * high)
    for _ in range(_STEPS):
        square = place**2
        value = divisor(square, terms)
        error = place / value - radius
        if (np.abs(error) <= _EXACT * radius).all():
            break
        low, high = np.where(error < 0.0, place, low), np.where(error > 0.0, place, high)
        rate = slope(square, terms) / value**2
        step = np.divide(error, rate, out=np.zeros_like(error), where=rate > 0.0)
        ahead = place - step
        inside = (ahead > low) & (ahead < high)
        place = np.where(error == 0.0, place, np.where(inside, ahead, 0.5 * (low + high)))
    return place


def _reach(terms):
    """Return the least distorted radius where the mapping turns back or ends; may be infinite."""
    weighed = [(1 - 2 * power) * term for power, term in enumerate(terms, 1)]
    return min(_least_zero(terms), _least_zero(weighed))


def _least_zero(terms):
    """Return the least radius whose square is a zero of 1 + K1 s + K2 s^2 + ..., or infinity."""
    # As zeros of a monic polynomial in 1 / s: then the last terms may be 0.
    roots = np.roots([1.0, *terms])
    real = roots.real[(np.abs(roots.imag) < 1e-9 * np.abs(roots)) & (roots.real > 0.0)]
    return float(1.0 / np.sqrt(real.max())) if len(real) else np.inf


def fitted_terms(undistorted_radii, distorted_radii, count=1, scaled=True):
    """Fit the division model to a lens.

    Least squares on the radii ``scale r_u D(r_d^2) = r_d``.

    Parameters
    ----------
    undistorted_radii, distorted_radii : ndarray of shape (N,)
        Image heights without distortion (focal length times tangent of the field angle) and as
        traced, in one unit; at least one more that is not zero than there are unknowns.
    count : int
        Number of terms.
    scaled : bool
        Leave the scale of the picture free, where its focal length is not known.

    Returns
    -------
    terms : tuple of float
        Per even powers of that unit.
    scale : float
        Factor of the undistorted radii at the centre of the picture.

    Raises
    ------
    InputError
        If the radii do not determine them.
    """
    u = np.asarray(undistorted_radii, dtype=float)
    d = np.asarray(distorted_radii, dtype=float)
    if np.count_nonzero(u * d) < count + scaled:
        raise InputError(
            f"a distortion of {count} terms needs at least {count + scaled} image heights that are"
            " not zero"
        )
    # r_d = scale r_u + sum of (scale Ki) r_u r_d^(2i): linear in all. In shares of the largest
    # radius, so that all columns count alike.
    unit = float(np.abs(d).max())
    powers = np.stack([u * (d / unit) ** (2 * i) for i in range(count + 1)], axis=-1)
    columns, wanted = (powers, d) if scaled else (powers[:, 1:], d - u)
    found, _, rank, _ = np.linalg.lstsq(columns, wanted, rcond=None)
    scale = float(found[0]) if scaled else 1.0
    if rank < columns.shape[1] or scale == 0.0:
        raise InputError("all image heights are alike; a distortion needs different ones")
    products = found[1:] if scaled else found
    return tuple(float(p / scale / unit ** (2 * i)) for i, p in enumerate(products, 1)), scale
