"""Reads the opening of a camera's lens: its blades, or an image of an iris."""

import math
from functools import lru_cache

import numpy as np

from ...errors import InputError
from ...lens_bokeh.openings.blades import BladedIris
from ...lens_bokeh.openings.pictures import PictureIris
from ..images.images import ANIMATED, ImageReader

# Largest side of an iris image, in texels: finer than the table of the largest disc.
_LARGEST_IRIS = 1024
# Most images, and irises made of them, that a reader keeps.
_MOST_KEPT = 16
# Least number of blades; with fewer the iris is round, as in Cycles.
_FEWEST_BLADES = 3


def read_opening(camera, real_lens, irises):
    """Return the opening of a camera's lens, and warnings about settings that cannot be met.

    Lens samples and discs alike have this shape, whether bokeh is switched on or off.

    Parameters
    ----------
    camera : bpy.types.Camera
        Evaluated in the frame that is drawn.
    real_lens : LensSettings or None
        As read from the same camera; it knows how far it opens.
    irises : IrisReader
        Reads the picture of an iris.

    Returns
    -------
    opening : BladedIris or PictureIris
    problems : tuple of str
        One sentence each, without the camera's name.
    """
    settings, dof = camera.aplanat.bokeh, camera.dof
    problems = ()
    if settings.iris_image is not None:
        image = settings.iris_image.original
        try:
            opening = irises.read(image, dof.aperture_rotation, real_lens is not None)
            if image.source in ANIMATED:
                problems = (
                    f"iris image '{image.name}' is animated; the picture in its file name, or the"
                    " first one, is the opening in every frame",
                )
            return opening, problems
        except InputError as error:
            problems = (f"iris image '{image.name}': {error}; the blades are drawn instead",)
    if dof.aperture_blades < _FEWEST_BLADES:
        # A round opening is the same however it is turned.
        return BladedIris(), problems
    closing = None
    if real_lens is not None and settings.use_round_stop:
        closing = real_lens.closing
    opening = BladedIris(
        dof.aperture_blades, settings.blade_curvature, dof.aperture_rotation, closing
    )
    return opening, problems


class IrisReader:
    """Reads iris images, each again only when it has changed.

    Belongs to one session and is used by one thread at a time.
    """

    def __init__(self):
        # Each image has its own reader, which notices when the image changes.
        self._reader_of = lru_cache(_MOST_KEPT)(lambda _uid: ImageReader(still=True))
        self._iris_of = lru_cache(_MOST_KEPT)(_iris_of_pixels)

    def read(self, image, rotation, stop=False):
        """Return the iris of an image.

        Parameters
        ----------
        image : bpy.types.Image
            The original, not an evaluated copy.
        rotation : float
            In radians, anticlockwise.
        stop : bool
            Behind the round stop of a real lens.

        Returns
        -------
        PictureIris
            The same object until one of them changes.

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
        # Colours that are not multiplied by alpha are here: what is transparent is no light.
        alpha = not use.associated and image.alpha_mode != "CHANNEL_PACKED"
        return self._iris_of(_Pixels((use.uid, alpha), reader.images[use.uid]), rotation, stop)


class _Pixels:
    """Pixels of an image, known by their number and whether alpha counts."""

    def __init__(self, uid, image):
        self.uid = uid
        self.image = image

    def __eq__(self, other):
        return self.uid == other.uid

    def __hash__(self):
        return hash(self.uid)


def _iris_of_pixels(pixels, rotation, stop):
    image = pixels.image
    picture = image.linear_colors().astype(np.float64).mean(axis=-1)
    if pixels.uid[1]:
        alpha = image.pixels[..., 3].astype(np.float64)
        picture *= alpha / 255.0 if image.pixels.dtype == np.uint8 else alpha
    return PictureIris(_reduced(picture), rotation, stop)


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
