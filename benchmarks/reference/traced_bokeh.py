"""Bokeh by tracing every ray of the very configuration: the oracle of the bokeh profile.

Nothing is tabulated, interpolated or mapped: the lens is focused and stopped down, rays leave the
object point in equal solid angles, the tracer ends those that meet a rim, and the others are
counted where they meet the sensor. Two ways:

- `traced_rings`: rays of one meridian, each standing for a ring, for lenses of revolution; a
  quarter of a million of them leave no noise that a picture would show;
- `traced_picture`: rays over the whole pupil, counted in pixels; noisier, and free of any
  assumption of symmetry.

Distances of objects and focus are from the first principal plane, mm.
"""

import functools
from dataclasses import dataclass

import numpy as np

from addon.optics.focus import focused
from addon.optics.glass import REFERENCE_WAVELENGTH_NM
from addon.optics.paraxial import first_order
from addon.optics.rays.trace import Rays, trace

RAYS = 1 << 18
# Rings to a pixel of the pictures that are compared.
RINGS_PER_PIXEL = 8
# Of the search for the cone that gets through.
_SEARCH_RAYS = 2048


@dataclass(frozen=True)
class RingPattern:
    """A pattern as energy in rings of equal width.

    Parameters
    ----------
    extent : float
        Outer radius of the last ring, mm.
    energy : ndarray of shape (rings,)
        Sums to 1.
    """

    extent: float
    energy: np.ndarray


@dataclass(frozen=True)
class TracedCone:
    """Rays of an axial point that got through a lens.

    Parameters
    ----------
    points, directions : ndarray of shape (N, 3)
        Behind the lens. Each ray carries the same energy.
    """

    points: np.ndarray
    directions: np.ndarray

    def radii(self, plane):
        """Distance from the axis at a plane, mm."""
        x, y = self.at(plane)
        return np.hypot(x, y)

    def at(self, plane):
        """Where the rays meet a plane, two arrays in mm."""
        distance = (plane - self.points[:, 2]) / self.directions[:, 2]
        across = self.points[:, :2] + distance[:, None] * self.directions[:, :2]
        return across[:, 0], across[:, 1]


def focused_lens(configuration, focus_distance, focus_group=None):
    """Return the lens focused at a distance from its own first principal plane.

    Parameters
    ----------
    configuration : Configuration
    focus_distance : float
        mm; inf is allowed.
    focus_group : FocusGroup or None

    Returns
    -------
    Configuration
    """
    lens = configuration
    for _ in range(8 if focus_group else 1):
        lens = focused(configuration, focus_distance - first_order(lens).h, focus_group)
    return lens


def traced_cone(
    configuration, object_distance, f_number, wavelength_nm=REFERENCE_WAVELENGTH_NM, rays=RAYS
):
    """Trace rays of one meridian in equal solid angles, and keep those that get through.

    Parameters
    ----------
    configuration : Configuration
        Wide open.
    object_distance : float
    f_number : float
    wavelength_nm : float
    rays : int

    Returns
    -------
    TracedCone
    """
    order = first_order(configuration)
    closed = configuration.stopped_down(f_number)
    object_z = order.h - object_distance
    share = (np.arange(_SEARCH_RAYS) + 0.5) / _SEARCH_RAYS
    reach = _whole_pupil(order)
    wide = _launch(object_z, order, reach, share, np.zeros(_SEARCH_RAYS))
    passed = trace(closed, wide, wavelength_nm).passed
    # The last that passes, and a step more.
    reach *= np.sqrt(min(1.0, (np.flatnonzero(passed)[-1] + 2) / _SEARCH_RAYS))
    share = (np.arange(rays) + 0.5) / rays
    return _through(closed, _launch(object_z, order, reach, share, np.zeros(rays)), wavelength_nm)


def traced_rings(cone, plane, extent=None, rings=1024):
    """Count rays of one meridian in rings.

    Parameters
    ----------
    cone : TracedCone
    plane : float
        The z of the sensor, mm from surface 1.
    extent : float or None
        mm; None: what holds all rays.
    rings : int

    Returns
    -------
    RingPattern
    """
    radii = cone.radii(plane)
    extent = float(radii.max()) * (1.0 + 1.0e-9) if extent is None else extent
    index = np.minimum((radii / extent * rings).astype(np.int64), rings - 1)
    counts = np.bincount(index, minlength=rings)
    return RingPattern(extent, counts / counts.sum())


def traced_picture(configuration, object_distance, f_number, extent, pixels=64, rays=1 << 20):
    """Count rays over the whole pupil in pixels.

    Parameters
    ----------
    configuration : Configuration
        Wide open and focused; its sensor takes the picture.
    object_distance, f_number : float
    extent : float
        Half the width of the picture, mm.
    pixels : int
    rays : int
        About as many are traced.

    Returns
    -------
    ndarray of shape (pixels, pixels)
        Energy in each pixel; sums to 1 if the picture holds the whole pattern.
    """
    order = first_order(configuration)
    closed = configuration.stopped_down(f_number)
    # A rank-1 lattice: even at every scale, and no two rays in one direction.
    count = np.arange(rays)
    share, turn = (count + 0.5) / rays, np.modf(count * 0.6180339887498949)[0]
    bundle = _launch(
        order.h - object_distance, order, _whole_pupil(order), share, 2.0 * np.pi * turn
    )
    cone = _through(closed, bundle, REFERENCE_WAVELENGTH_NM)
    x, y = cone.at(configuration.sensor)
    span = (-extent, extent)
    picture, _, _ = np.histogram2d(y, x, bins=pixels, range=(span, span))
    return picture / len(x)


def picture_of_rings(energy, pixels):
    """Put a pattern of rings into pixels, each the exact share that falls in it.

    Parameters
    ----------
    energy : ndarray of shape (rings,)
        Rings of equal width out to half the picture's width.
    pixels : int
        Even.

    Returns
    -------
    ndarray of shape (pixels, pixels)
    """
    rings = len(energy)
    density = energy / (np.pi * np.diff((np.linspace(0.0, 1.0, rings + 1) * pixels / 2) ** 2))
    index, fold, fine = _pixel_rings(pixels, rings)
    sums = np.bincount(fold, np.append(density, 0.0)[index], minlength=(pixels // 2) ** 2)
    quarter = sums.reshape(pixels // 2, pixels // 2) / fine**2
    upper = np.hstack([quarter[:, ::-1], quarter])
    return np.vstack([upper[::-1], upper])


def rings_of_row(row, extent, rings):
    """Energy of a profile's row in other rings, each exactly what falls in it.

    Parameters
    ----------
    row : PatternRow
        Of one channel or more; the first counts.
    extent : float
        Of the wanted rings, mm.
    rings : int

    Returns
    -------
    ndarray of shape (rings,)
    """
    edges = row.edges**2
    areas = np.pi * np.diff(np.linspace(0.0, 1.0, len(edges)) ** 2)
    inside = np.concatenate([[0.0], np.cumsum(row.density[:, 0] * areas)])
    wanted = (extent * np.linspace(0.0, 1.0, rings + 1)) ** 2
    return np.diff(np.interp(wanted, edges, inside))


def psnr(picture, reference):
    """Peak signal to noise in dB; the peak is the largest value of the reference."""
    error = float(np.mean((picture - reference) ** 2))
    return float(10.0 * np.log10(reference.max() ** 2 / max(error, 1.0e-300)))


def _whole_pupil(order):
    """Radius in the entrance pupil that holds every ray that may get through."""
    return 1.1 * order.enp_diameter


def _launch(object_z, order, reach, share, angle):
    """Rays towards the disk of radius `reach` in the entrance pupil, even in solid angle."""
    if np.isinf(object_z):
        height, slope = reach * np.sqrt(share), np.zeros_like(share)
        start = -10.0 * order.enp_diameter
    else:
        distance = order.enp_z - object_z
        cosine = 1.0 - share * (1.0 - 1.0 / np.hypot(1.0, reach / distance))
        slope = np.sqrt(1.0 - cosine**2) / cosine
        height, start = np.zeros_like(share), object_z
    across = np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    origins = np.concatenate([height[:, None] * across, np.full((len(share), 1), start)], axis=1)
    directions = np.concatenate([slope[:, None] * across, np.ones((len(share), 1))], axis=1)
    return Rays(origins, directions / np.linalg.norm(directions, axis=1, keepdims=True))


def _through(configuration, rays, wavelength_nm):
    traced = trace(configuration, rays, wavelength_nm)
    return TracedCone(traced.points[traced.passed], traced.directions[traced.passed])


@functools.lru_cache(maxsize=4)
def _pixel_rings(pixels, rings, fine=12):
    """Ring and pixel of each sub-pixel of a quarter picture."""
    places = (np.arange(pixels // 2 * fine) + 0.5) / fine
    radius = np.hypot(places[:, None], places) / (pixels / 2) * rings
    index = np.minimum(radius.astype(np.int64), rings).ravel()
    pixel = np.arange(pixels // 2).repeat(fine)
    fold = (pixel[:, None] * (pixels // 2) + pixel).ravel()
    return index, fold, fine
