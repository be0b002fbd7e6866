"""Chromatic displacement of points, as the vertex shaders do it."""

import numpy as np

from addon.sampling.chromatic import chromatic_focus
from addon.sampling.field_maps import field_coordinates


def displaced(points, lens_xy, wavelength_nm, aberration, focus, corner, orthographic=False):
    """Return where points appear from a place on the lens, at a wavelength.

    Scaled about the axis by the lateral aberration, then displaced by the circle of confusion of
    the distance that the wavelength has in focus; the field is that of the point itself.

    Parameters
    ----------
    points : ndarray of shape (..., 3)
        In camera space, which looks along -z; in m.
    lens_xy : ndarray of shape (..., 2)
        In m.
    wavelength_nm : array_like of shape (...)
    aberration : ChromaticAberration
    focus : float
        In m.
    corner : float
        See `sampling.field_maps.field_corner`; of the whole picture.
    orthographic : bool

    Returns
    -------
    ndarray of shape (..., 3)
    """
    points = np.asarray(points, np.float64)
    t, theta = field_coordinates(points, corner, orthographic)
    at = aberration.focal_lengths(wavelength_nm, t, theta)
    focus_at = chromatic_focus(focus, aberration.focal_length, at)
    scale = aberration.lateral_scales(wavelength_nm, t, theta)
    defocus = (1.0 + points[..., 2] / focus_at)[..., None]
    xy = points[..., :2] * scale[..., None] - np.asarray(lens_xy) * defocus
    z = np.broadcast_to(points[..., 2:], (*xy.shape[:-1], 1))
    return np.concatenate([xy, z], axis=-1)
