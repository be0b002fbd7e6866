"""Polynomials over the unit disc, orthogonal there (Zernike's): the terms of aberrations.

A place q of the disc is ``r (cos a, sin a)``. A term is ``R(r) cos(m a)`` or ``R(r) sin(m a)``,
with ``R`` Zernike's radial polynomial of order n and frequency m. Turned by an angle, the pair of a
frequency mixes within itself, so that coefficients that were found for a point on one side of a
lens of revolution serve for all azimuths.
"""

from math import factorial

import numpy as np


def disc_orders(degree):
    """Orders and frequencies of the terms up to a degree.

    Parameters
    ----------
    degree : int

    Returns
    -------
    ndarray of int, shape (T, 2)
        Order n and frequency m of each, 0 <= m <= n, n - m even.
    """
    return np.array([(n, m) for n in range(degree + 1) for m in range(n % 2, n + 1, 2)])


def radial_terms(orders, radius):
    """Radial polynomials, 1 at the rim.

    Parameters
    ----------
    orders : ndarray of int, shape (T, 2)
    radius : ndarray of shape (N,)

    Returns
    -------
    ndarray of shape (N, T)
    """
    powers = radius[:, None] ** np.arange(orders[:, 0].max() + 1)
    matrix = np.zeros((powers.shape[1], len(orders)))
    for column, (n, m) in enumerate(orders.tolist()):
        for k in range((n - m) // 2 + 1):
            size = factorial(n - k) // (
                factorial(k) * factorial((n + m) // 2 - k) * factorial((n - m) // 2 - k)
            )
            matrix[n - 2 * k, column] = (-1) ** k * size
    return powers @ matrix


def disc_terms(orders, places):
    """Cosine and sine terms at places of the disc.

    Parameters
    ----------
    orders : ndarray of int, shape (T, 2)
    places : ndarray of shape (N, 2)

    Returns
    -------
    ndarray of shape (N, 2, T)
        The cosine terms, then the sine terms (0 for m = 0).
    """
    radial = radial_terms(orders, np.hypot(places[:, 0], places[:, 1]))
    turn = np.arctan2(places[:, 1], places[:, 0])[:, None] * orders[:, 1]
    return np.stack([radial * np.cos(turn), radial * np.sin(turn)], axis=1)
