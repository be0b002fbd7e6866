"""Chromatic displacement of points, as the shaders do it, and what represents all wavelengths."""

import numpy as np

from addon.sampling.chromatic import chromatic_focus


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


def field_coordinates(points, corner, orthographic=False):
    """Return where points lie in the field.

    Parameters
    ----------
    points : ndarray of shape (..., 3)
        In camera space, which looks along -z; in m.
    corner : float
        As `field_corner` returns it.
    orthographic : bool

    Returns
    -------
    t, theta : ndarray of shape (...)
        t is at most 1; theta in radians from -pi to pi, 0 on the axis.
    """
    points = np.asarray(points, np.float64)
    away = np.hypot(points[..., 0], points[..., 1])
    tilt = away if orthographic else np.arctan2(away, -points[..., 2])
    t = np.minimum(tilt / corner, 1.0)
    return t, np.arctan2(points[..., 1], points[..., 0])


def typical_coc(plan, eye, coc_scale):
    """Return the circles of confusion that represent all wavelengths.

    The share of light that is splatted depends on them, so that it is the same at every
    wavelength.

    Parameters
    ----------
    plan : ChromaticPlan
    eye : ndarray of shape (..., 3)
    coc_scale : float
        See `FramePlan`.

    Returns
    -------
    ndarray of shape (...)
        Radius in px: the root of about their mean square.
    """
    axial = plan.strengths(eye)[..., 0]
    depth = -eye[..., 2]
    squares = 0.0
    for error in plan.typical_errors:
        focus = plan.inverse_focus_at(error, axial)
        coc = depth * focus - 1.0 if plan.parallel else focus - 1.0 / depth
        squares = squares + 0.5 * (coc_scale * coc) ** 2
    return np.sqrt(squares)
