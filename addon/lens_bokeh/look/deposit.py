"""Pictures of a beam on the sensor: the energy of its rays, deposited on texels.

Every ray of a fine grid spreads its energy evenly over a square as wide as its neighbours are
apart, so that a smooth beam gives a smooth picture and a folded one (a caustic) its bright edge.
No energy is lost but what falls outside the picture.
"""

import numpy as np

from ..openings.blades import BladedIris

_FEWEST_RAYS, _MOST_RAYS = 192, 1024
# Largest distance of neighbouring rays on the sensor, in texels, for nearly all of the energy.
_SPACING, _NEARLY_ALL = 0.6, 0.95
# Rays farther apart are laid into pictures of half the resolution, a quarter, and so on.
_LEVELS = 6


def rays_for(beam, shift, texel):
    """Rays along a side of the grid that fills a picture smoothly.

    Parameters
    ----------
    beam : PupilBeam
    shift : float
        Sensor's distance behind the sensor plane of the tables, mm.
    texel : float
        mm.

    Returns
    -------
    int
    """
    stop = np.hypot(beam.stop[..., 0], beam.stop[..., 1]) / beam.stop_scale
    passing = (beam.clearance > 0.0) & (stop < 1.0)
    if not passing.any():
        return _FEWEST_RAYS
    landing = beam.landing(shift)
    apart = np.maximum(spacing(landing[..., 0]), spacing(landing[..., 1]))[passing]
    wide = np.quantile(apart, _NEARLY_ALL) / texel * (beam.weight.shape[0] - 1)
    return int(np.clip(np.ceil(wide / _SPACING), _FEWEST_RAYS, _MOST_RAYS))


def open_weights(fine, iris=None, fresnel=False, stop_rim=True):
    """Energy of the rays of a refined beam behind all rims and the iris.

    Parameters
    ----------
    fine : PupilBeam
        From `PupilBeam.refined`.
    iris : BladedIris or PictureIris or None
        In units of the stopped-down radius, in the frame of the beam; None: round.
    fresnel : bool
        Whether rays lose what the surfaces reflect.
    stop_rim : bool
        False: the caller masks the stop itself.

    Returns
    -------
    ndarray of shape (n, n)
        mm^2; rims and iris antialiased.
    """
    rim = np.min([_edge(each) for each in np.moveaxis(fine.rims, -1, 0)], axis=0)
    energy = fine.weight * fine.transmission if fresnel else fine.weight
    if not stop_rim:
        return energy * rim
    points = fine.stop / fine.stop_scale
    iris = iris or BladedIris()
    width = np.maximum(spacing(points[..., 0]), spacing(points[..., 1]))
    opened = iris.coverage(points, width)
    # The minimum of rim and blades, not their product, which would count a common edge twice.
    both = np.minimum(rim, opened) if isinstance(iris, BladedIris) else rim * opened
    return energy * both


def pattern(beam, shift, size, extent, *, iris=None, centre=None, fresnel=False):
    """Draw the pattern of a beam.

    Parameters
    ----------
    beam : PupilBeam
    shift : float
        Sensor's distance behind the sensor plane of the tables, mm.
    size : int
        Texels along a side.
    extent : float
        Half the width of the picture, mm.
    iris : BladedIris or PictureIris or None
        As in `open_weights`.
    centre : tuple of float or None
        Middle of the picture on the sensor, mm from the axis; None: where the chief ray lands.
    fresnel : bool
        As in `open_weights`.

    Returns
    -------
    ndarray of shape (size, size)
        Energy per texel: area of the pupil in mm^2. Columns along x, rows along y (outwards),
        both rising.
    """
    texel = 2.0 * extent / size
    fine = beam.refined(rays_for(beam, shift, texel))
    weights = open_weights(fine, iris, fresnel)
    if centre is None:
        centre = beam.chief[:2] + beam.chief[2:] * shift
    places = (fine.landing(shift) - np.asarray(centre) + extent) / texel
    return deposit(places, weights, size)


def deposit(places, weights, size):
    """Spread energy over texels.

    Parameters
    ----------
    places : ndarray of shape (n, n, 2)
        x and y of a grid of rays, in texels from the picture's corner.
    weights : ndarray of shape (n, n)
        Energy.
    size : int
        Texels along a side.

    Returns
    -------
    ndarray of shape (size, size)
    """
    lit = weights > 0.0
    x, y, energy = places[..., 0][lit], places[..., 1][lit], weights[lit]
    wide_x, wide_y = spacing(places[..., 0])[lit], spacing(places[..., 1])[lit]
    level = np.ceil(np.log2(np.maximum(np.maximum(wide_x, wide_y), 1.0))).astype(int)
    level = np.minimum(level, _LEVELS - 1)
    picture = np.zeros((size, size))
    for each in np.unique(level):
        at, scale = level == each, 2.0**-each
        coarse = _laid(
            x[at] * scale, y[at] * scale, wide_x[at] * scale, wide_y[at] * scale, energy[at],
            -(-size // 2**each),
        )  # fmt: skip
        share = coarse / 4.0**each
        picture += np.kron(share, np.ones((2**each, 2**each)))[:size, :size]
    return picture


def _laid(x, y, wide_x, wide_y, energy, size):
    columns, left = _shares(x, wide_x)
    rows, low = _shares(y, wide_y)
    picture = np.zeros(size * size)
    for row, in_row in ((rows, low), (rows + 1, 1.0 - low)):
        for column, in_column in ((columns, left), (columns + 1, 1.0 - left)):
            inside = (row >= 0) & (row < size) & (column >= 0) & (column < size)
            picture += np.bincount(
                (row * size + column)[inside],
                (energy * in_row * in_column)[inside],
                minlength=size * size,
            )
    return picture.reshape(size, size)


def _shares(place, width):
    """First texel that an interval touches, and its share; the next texel has the rest."""
    width = np.clip(width, 1e-6, 1.0)
    start = place - 0.5 * width
    first = np.floor(np.clip(start, -1e6, 1e6))
    return first.astype(int), np.clip((first + 1.0 - start) / width, 0.0, 1.0)


def spacing(values):
    """Change of a quantity from ray to ray, along both axes together.

    Parameters
    ----------
    values : ndarray of shape (n, n)

    Returns
    -------
    ndarray of shape (n, n)
        Not negative.
    """
    return np.abs(np.gradient(values, axis=0)) + np.abs(np.gradient(values, axis=1))


def _edge(clearance):
    """Share of each cell inside the zero of a signed function."""
    return np.clip(0.5 + clearance / np.maximum(spacing(clearance), 1e-12), 0.0, 1.0)
