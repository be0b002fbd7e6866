"""Pictures of lenses that are drawn once and kept beside the lenses' tables."""

import contextlib
import hashlib

import numpy as np

from ..errors import OutputError
from ..files.whole_file import whole_file
from ..lens_bokeh.openings.blades import BladedIris
from ..lens_io.profile_cache import content_hash, profile_folder


def kept_picture(name, shape, folder, draw):
    """Return a picture from disk, or draw and keep it.

    Parameters
    ----------
    name : str or None
        Says all of what the picture is; None: it is not kept.
    shape : tuple of int
        Of the picture.
    folder : Path or None
        None: `profile_folder`.
    draw : callable
        Returns the picture, uint8.

    Returns
    -------
    ndarray of that shape
        float32, 0 to 1.
    """
    folder = profile_folder() if folder is None else folder
    path = None if name is None else folder / f"{name}.npy"
    if path is not None:
        with contextlib.suppress(OSError, ValueError):
            kept = np.load(path, allow_pickle=False)
            if kept.shape == tuple(shape) and kept.dtype == np.uint8:
                return kept.astype(np.float32) / np.float32(255.0)
    pixels = draw()
    if path is not None:
        # Without a cache it is drawn again next time, and that is all.
        with contextlib.suppress(OSError, OutputError):
            folder.mkdir(parents=True, exist_ok=True)
            with whole_file(path) as place, open(place, "wb") as file:
                np.save(file, pixels, allow_pickle=False)
    return pixels.astype(np.float32) / np.float32(255.0)


def state_name(kind, *states):
    """Return the name of a picture of lenses in some state.

    Parameters
    ----------
    kind : str
        Of the picture, with the version of its drawing.
    *states : tuple of (Prescription, str or None, float, BladedIris or PictureIris)
        Lens, zoom position, f-number, iris.

    Returns
    -------
    str or None
        None for an iris that is a picture: it has no short name that says what it is.
    """
    if not all(isinstance(opening, BladedIris) for *_, opening in states):
        return None
    parts = [(content_hash(lens, label), *how) for lens, label, *how in states]
    return f"{kind}-{hashlib.sha256(repr(parts).encode()).hexdigest()[:40]}"
