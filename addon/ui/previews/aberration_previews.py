"""Pictures of what an artist's lens does to a point behind the focus, as icons."""

from dataclasses import fields, replace
from functools import lru_cache

import numpy as np

from ...lens_bokeh.tables.artist_lens import UNIT, ArtistLens, opening_at
from .picture_icons import PictureIcons

_SIZE, _RAYS = 64, 256
# Radius of the disc without aberrations, in hundredths of the distance to the picture's corner.
_DISC = 3.0
# Displayed brightness of an even disc, and of nothing, on any theme.
_GREY, _DARK = 0.55, 0.02
_MARGIN = 1.15

# Names of the strengths.
ABERRATIONS = tuple(each.name for each in fields(ArtistLens))

icons = PictureIcons()
register, unregister = icons.register, icons.unregister


def aberration_icons(camera, name):
    """Return the icons of one aberration's effect: in the middle and in the corner.

    Parameters
    ----------
    camera : bpy.types.Camera
        Each has icons of its own.
    name : str
        Of the setting.

    Returns
    -------
    tuple of 2 int
        0 in a Blender without windows.
    """
    inputs = (name, round(getattr(camera.aplanat, name), 4), camera.dof.aperture_fstop)
    found = f"{camera.session_uid}:{name}"
    return icons.icon_ids(found, inputs, lambda: aberration_pictures(*inputs), 2)


# Memo of its arguments alone: cameras that look alike share their pictures.
@lru_cache(maxsize=32)
def aberration_pictures(name, strength, f_number):
    """Draw the disc of a point behind the focus, in the middle and at the right of the picture.

    Parameters
    ----------
    name : str
        Of `ABERRATIONS`.
    strength, f_number : float

    Returns
    -------
    tuple of 2 ndarray of shape (size, size, 4)
        float32, display referred with alpha, bottom row first; at one scale.
    """
    lens = replace(ArtistLens(), **{name: strength})
    axis = (np.arange(_RAYS) + 0.5) / _RAYS * 2.0 - 1.0
    place = np.stack(np.meshgrid(axis, axis))
    place = place[:, np.hypot(*place) <= 1.0]
    spots = []
    for share in (0.0, 1.0):
        moves, squeeze = lens.moves(share, place, opening_at(f_number))
        thin = place * np.array([1.0, 1.0 - squeeze])[:, None] * _DISC
        across, away = thin + moves / UNIT
        # Away from the middle of the picture is to the right.
        spots.append((away, -across))
    reach = _MARGIN * max(_DISC, max(np.abs(spot).max() for spot in spots))
    even = place.shape[1] / (np.pi * (_DISC / reach * _SIZE / 2.0) ** 2)
    return tuple(_picture(x, y, reach, even) for x, y in spots)


def _picture(x, y, reach, even):
    edges = np.linspace(-reach, reach, _SIZE + 1)
    light, _, _ = np.histogram2d(y, x, bins=(edges, edges))
    value = np.maximum(np.sqrt(light / even) * _GREY, _DARK)
    picture = np.ones((_SIZE, _SIZE, 4), np.float32)
    picture[..., :3] = np.clip(value, 0.0, 1.0)[..., None]
    return picture
