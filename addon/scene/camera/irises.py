"""Reads the iris images of cameras into `PictureIris`."""

import math
from functools import lru_cache

import numpy as np

from ...errors import InputError
from ...lens_bokeh.look.iris_mask import PictureIris
from ..images.images import ImageReader

# Largest side of an iris image, in texels: finer than the table of the largest disc.
_LARGEST_IRIS = 1024
# Most images, and irises made of them, that a reader keeps.
_MOST_KEPT = 16


class IrisReader:
    """Reads iris images, each again only when it has changed.

    Belongs to one session and is used by one thread at a time.
    """

    def __init__(self):
        # Each image has its own reader, which notices when the image changes.
        self._reader_of = lru_cache(_MOST_KEPT)(lambda _session_uid: ImageReader())
        self._iris_of = lru_cache(_MOST_KEPT)(_iris_of_pixels)

    def read(self, image, rotation):
        """Return the iris of an image.

        Parameters
        ----------
        image : bpy.types.Image
            The original, not an evaluated copy.
        rotation : float
            In radians, anticlockwise.

        Returns
        -------
        PictureIris
            The same object until image or rotation changes.

        Raises
        ------
        InputError
            If the image cannot be read or lets no light through.
        """
        reader = self._reader_of(image.session_uid)
        reader.begin()
        use = reader.read(image)
        if use is None:
            raise InputError("it cannot be read; choose another file")
        return self._iris_of(_Pixels(use.uid, reader.images[use.uid]), rotation)


class _Pixels:
    """Pixels of an image, known by their number."""

    def __init__(self, uid, image):
        self.uid = uid
        self.image = image

    def __eq__(self, other):
        return self.uid == other.uid

    def __hash__(self):
        return self.uid


def _iris_of_pixels(pixels, rotation):
    picture = pixels.image.linear_colors().astype(np.float64)
    return PictureIris(_reduced(picture.mean(axis=-1)), rotation)


def _reduced(picture):
    """Return a picture of no more than `_LARGEST_IRIS` texels a side, by means over squares."""
    step = math.ceil(max(picture.shape) / _LARGEST_IRIS)
    if step == 1:
        return picture
    height, width = (-(-length // step) * step for length in picture.shape)
    # The margin that is added is opaque, as everything outside of the picture is.
    padded = np.zeros((height, width))
    padded[: picture.shape[0], : picture.shape[1]] = picture
    return padded.reshape(height // step, step, width // step, step).mean(axis=(1, 3))
