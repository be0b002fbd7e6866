"""The box of a field's entrance pupil: where the rays that get through a lens enter.

A beam of direction ``d = (0, sin a, cos a)`` is described by the places where its rays cross the
plane through the vertex of surface 1 and square to d: x, and v along ``(0, cos a, -sin a)``, in mm.
The box is the smallest upright rectangle, symmetric in x, that holds the rays which pass; its rims
are found by interpolating the clearance of the rays, far finer than the distance of rays.
"""

import numpy as np

from ...optics.rays.trace import Rays, RayStatus, trace
from ...optics.surfaces import sag

_SEARCH_RAYS = 33
_FINE_SEARCH_RAYS = 161
_ROUNDS = 2
# A ray is at a rim if it hits within this share of the rim's radius of it.
_NEAR_RIM = 0.06


def beam_axes(angle):
    """Direction of a beam and the axis of its v.

    Parameters
    ----------
    angle : float
        Field angle, radians.

    Returns
    -------
    direction, axis : ndarray of shape (3,)
        The x axis is (1, 0, 0).
    """
    sin, cos = np.sin(angle), np.cos(angle)
    return np.array([0.0, sin, cos]), np.array([0.0, cos, -sin])


def beam_rays(angle, x, v):
    """Parallel rays.

    Parameters
    ----------
    angle : float
        Field angle, radians.
    x, v : ndarray of shape (N,)
        mm.

    Returns
    -------
    Rays
    """
    direction, axis = beam_axes(angle)
    origins = v[:, None] * axis
    origins[:, 0] += x
    return Rays(origins, np.broadcast_to(direction, origins.shape))


def clearances(configuration, hits, rims=()):
    """Clearances of rays inside the rims, relative to each rim's radius.

    Parameters
    ----------
    configuration : Configuration
    hits : ndarray of shape (S, N, 3)
    rims : sequence of int
        Numbers of surfaces that are told apart, from 1; not the stop.

    Returns
    -------
    inside : ndarray of shape (N, len(rims) + 1)
        1 - radius / semi-diameter of each of `rims`, and the smallest of all others but the stop
        (1 if there are none).
    stop : ndarray of shape (N, 2)
        x and y on the stop, in units of its radius.
    """
    radii = np.array([surface.semi_diameter for surface in configuration.surfaces])
    inside = 1.0 - np.hypot(hits[..., 0], hits[..., 1]) / radii[:, None]
    apart = [number - 1 for number in rims]
    stop = configuration.stop - 1
    others = [i for i in range(len(radii)) if i != stop and i not in apart]
    rest = inside[others].min(axis=0, initial=1.0)
    return np.stack([*inside[apart], rest], axis=-1), hits[stop, :, :2] / radii[stop]


def limiting_rims(configuration, beams, wavelength_nm, count):
    """Numbers of the surfaces whose rims cut beams most.

    Parameters
    ----------
    configuration : Configuration
    beams : sequence of (float, tuple of float)
        Field angles and their boxes from `passing_box`.
    wavelength_nm : float
    count : int

    Returns
    -------
    tuple of int
        At most `count`, from 1, rising; the stop is not among them.
    """
    radii = np.array([surface.semi_diameter for surface in configuration.surfaces])
    cuts = np.zeros(len(radii))
    for angle, (half_x, low, high) in beams:
        x, v = np.meshgrid(
            np.linspace(0.0, 1.05 * half_x, _SEARCH_RAYS // 2),
            np.linspace(low, high, _SEARCH_RAYS) * 1.05 - 0.025 * (low + high),
        )
        traced = trace(
            configuration, beam_rays(angle, x.ravel(), v.ravel()), wavelength_nm, clip=False,
            record=True,
        )  # fmt: skip
        inside = 1.0 - np.hypot(traced.hits[..., 0], traced.hits[..., 1]) / radii[:, None]
        edge = traced.reached & (np.abs(inside.min(axis=0)) < _NEAR_RIM)
        cuts += np.bincount(inside[:, edge].argmin(axis=0), minlength=len(radii))
    cuts[configuration.stop - 1] = 0.0
    most = np.argsort(-cuts, kind="stable")[:count]
    return tuple(sorted(int(i) + 1 for i in most if cuts[i] > 0.0))


def passing_box(configuration, angle, wavelength_nm):
    """Box of the rays of a field angle that get through.

    Parameters
    ----------
    configuration : Configuration
    angle : float
        Radians.
    wavelength_nm : float

    Returns
    -------
    tuple of float or None
        Half width in x, lowest and highest v, mm; None if no ray passes.
    """
    half_x, low, high = _first_rim(configuration.surfaces[0], angle)
    box = None
    for rays in (_SEARCH_RAYS, _FINE_SEARCH_RAYS):
        box = _narrowed(configuration, angle, wavelength_nm, (half_x, low, high), rays)
        if box is not None:
            break
    for _ in range(_ROUNDS - 1):
        if box is None:
            return None
        half_x, low, high = box
        # Wider by two rays of the next search, so that the rim lies between rays.
        margin = 2.0 / _SEARCH_RAYS
        wide = (half_x * (1.0 + margin), low - margin * (high - low), high + margin * (high - low))
        box = _narrowed(configuration, angle, wavelength_nm, wide, _SEARCH_RAYS) or box
    return box


def _first_rim(surface, angle):
    """Box of the whole of surface 1 as the beam sees it."""
    r = np.linspace(0.0, surface.semi_diameter, 17)[:, None]
    turn = np.linspace(0.0, 2.0 * np.pi, 49)
    x, y = r * np.cos(turn), r * np.sin(turn)
    v = y * np.cos(angle) - sag(surface, x, y) * np.sin(angle)
    return surface.semi_diameter, float(v.min()), float(v.max())


def _narrowed(configuration, angle, wavelength_nm, box, rays):
    half_x, low, high = box
    x, v = np.linspace(0.0, half_x, rays), np.linspace(low, high, rays)
    grid = np.stack(np.meshgrid(x, v), axis=-1).reshape(-1, 2)
    traced = trace(
        configuration, beam_rays(angle, grid[:, 0], grid[:, 1]), wavelength_nm, clip=False,
        record=True,
    )  # fmt: skip
    passed = traced.passed.reshape(rays, rays)
    if not passed.any():
        return None
    inside, stop = clearances(configuration, traced.hits)
    inside = np.minimum(inside[:, 0], 1.0 - np.hypot(stop[:, 0], stop[:, 1]))
    # A ray that failed inside all rims (total reflection) is as far outside as its neighbour is
    # inside: the rim is taken halfway.
    failed = ~traced.reached | (traced.status >= RayStatus.MISSED)
    inside = np.where(failed, np.nan, inside).reshape(rays, rays)
    return (
        max(_last_crossing(inside.T, passed.T, x), 0.5 * x[1]),
        -_last_crossing(inside[::-1], passed[::-1], -v[::-1]),
        _last_crossing(inside, passed, v),
    )


def _last_crossing(inside, passed, along):
    """Largest place along axis 0 at which any column ends to pass."""
    count = len(along)
    columns = np.flatnonzero(passed.any(axis=0))
    last = count - 1 - np.argmax(passed[::-1, columns], axis=0)
    following = np.minimum(last + 1, count - 1)
    here, there = inside[last, columns], inside[following, columns]
    there = np.where(np.isnan(there) | (there >= 0.0), -here, there)
    share = np.where(here > there, here / np.where(here > there, here - there, 1.0), 0.0)
    ends = along[last] + np.where(following > last, share, 0.0) * (along[following] - along[last])
    return float(ends.max())
