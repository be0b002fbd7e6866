"""Tiles of the raster that highlights are searched in, so that its memory has a bound."""

import numpy as np

# In sub-pixels of 20 bytes a layer.
_LARGEST_TILE = 1 << 22
# Side, in sub-pixels: any device has room for that.
_LONGEST_TILE = 8192


def tiles_of(part, subpixels):
    """Divide a part of the raster into tiles that are searched one after another.

    Parameters
    ----------
    part : tuple of 4 int
        x, y, width and height, px; without area there are no tiles.
    subpixels : int
        Along each side of a pixel.

    Returns
    -------
    list of tuple of 4 int
        x, y, width and height in pixels; the first is the largest.
    """
    left, below, width, height = part
    if width == 0 or height == 0:
        return []
    most = max(_LARGEST_TILE // subpixels**2, 1)
    longest = max(_LONGEST_TILE // subpixels, 1)
    if width * height > most:
        longest = min(longest, int(np.sqrt(most)))
    w = -(-width // -(-width // longest))
    h = min(max(most // w, 1), height, max(_LONGEST_TILE // subpixels, 1))
    return [
        (left + x, below + y, min(w, width - x), min(h, height - y))
        for y in range(0, height, h)
        for x in range(0, width, w)
    ]
