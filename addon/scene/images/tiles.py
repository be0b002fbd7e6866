"""UDIM tiles of an image, side by side in one picture."""

import math

import bpy
import numpy as np

from .image_pixels import load_file, load_packed


def tile_place(number):
    """Return the column and row of a tile: 1001 is (0, 0), ten a row."""
    row, column = divmod(number - 1001, 10)
    return column, row


def tile_path(image, number):
    """Return the file of a tile."""
    column, row = tile_place(number)
    path = bpy.path.abspath(image.filepath, library=image.library)
    path = path.replace("<UDIM>", str(number))
    return path.replace("<UVTILE>", f"u{column + 1}_v{row + 1}")


def columns_of(count):
    """Return how many tiles stand side by side in the picture of all of them."""
    return math.ceil(math.sqrt(count))


def load_tiles(image):
    """Read the tiles of an image.

    Parameters
    ----------
    image : bpy.types.Image

    Returns
    -------
    pixels : ndarray of shape (height, width, 4)
        As of `load_file`: row by row `columns_of` their number, in cells as large as the largest.
    places : tuple of (int, int, float, float)
        Column and row of the UV plane, width and height as shares of a cell, in the order of the
        tiles in the picture. Tiles that cannot be read are left out.
    """
    found = {}
    for tile in image.tiles:
        pixels = _load(image, tile.number)
        if pixels is not None and pixels.size:
            found[tile_place(tile.number)] = pixels
    if not found:
        return None, ()
    if len({pixels.dtype for pixels in found.values()}) > 1:
        found = {place: _as_float(pixels) for place, pixels in found.items()}
    height, width = np.max([pixels.shape[:2] for pixels in found.values()], axis=0)
    columns = columns_of(len(found))
    rows = -(-len(found) // columns)
    first = next(iter(found.values()))
    atlas = np.zeros((rows * height, columns * width, 4), first.dtype)
    for slot, pixels in enumerate(found.values()):
        row, column = divmod(slot, columns)
        y, x = row * height, column * width
        atlas[y : y + pixels.shape[0], x : x + pixels.shape[1]] = pixels
    sizes = [(p.shape[1] / float(width), p.shape[0] / float(height)) for p in found.values()]
    return atlas, tuple((*place, *size) for place, size in zip(found, sizes, strict=True))


def _as_float(pixels):
    return pixels / np.float32(255.0) if pixels.dtype == np.uint8 else pixels


def _load(image, number):
    for packed in image.packed_files:
        if str(number) in packed.filepath.rpartition("/")[2]:
            return load_packed(packed.data)
    return load_file(tile_path(image, number))
