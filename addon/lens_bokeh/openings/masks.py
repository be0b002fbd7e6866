"""Openings as masks.

Coordinates: x to the right, y up, in units of the radius of the opening. Arrays of masks have row 0
at the bottom (y = -1 side), so that index and coordinate grow together.
"""

import numpy as np


def texel_centres(size, extent=1.0):
    """Centres of the texels of a square picture.

    Parameters
    ----------
    size : int
        Texels along a side.
    extent : float
        The picture spans -extent to extent.

    Returns
    -------
    ndarray of shape (size, size, 2)
        x along columns, y along rows, rising.
    """
    axis = (np.arange(size) + 0.5) * (2.0 * extent / size) - extent
    return np.stack(np.meshgrid(axis, axis), axis=-1)


def iris_mask(iris, size, extent=1.0, supersampling=4):
    """Draw an opening, antialiased by area.

    Parameters
    ----------
    iris : BladedIris or PictureIris
    size : int
        Texels along a side.
    extent : float
        The mask spans -extent to extent in units of the radius of the opening.
    supersampling : int
        Each texel is the mean of this number squared of squares, within which the rim of blades
        counts as straight and square to the axes. A picture has its own means and needs none.

    Returns
    -------
    ndarray of shape (size, size)
        Open share of each texel, 0 to 1.
    """
    if iris.has_means:
        supersampling = 1
    fine = size * supersampling
    covered = iris.coverage(texel_centres(fine, extent), 2.0 * extent / fine)
    return covered.reshape(size, supersampling, size, supersampling).mean(axis=(1, 3))
