"""Pictures of the node groups for the asset browser."""

import numpy as np

from ..lens_bokeh.look.appearance import Appearance
from ..lens_bokeh.look.sprite import sprite
from ..lens_bokeh.openings.blades import BladedIris
from .node_groups import FRINGE, MIX, SPRITE

SIZE = 128
_NIGHT = (0.03, 0.05, 0.10)
# Where discs are in the picture of the Mix, how large, and in what colour.
_LAMPS = (
    (24, 30, 56, (1.0, 0.75, 0.4)),
    (66, 62, 44, (0.5, 0.8, 1.0)),
    (8, 76, 36, (1.0, 0.45, 0.3)),
    (78, 12, 34, (0.9, 0.95, 0.8)),
)


def preview_pixels(name):
    """Draw the picture of a group.

    Parameters
    ----------
    name : str
        `MIX`, `FRINGE` or `SPRITE`.

    Returns
    -------
    ndarray of float32, shape (SIZE, SIZE, 4)
        Display referred, bottom row first.
    """
    picture = {MIX: _lamps, FRINGE: _fringes, SPRITE: _disc}[name]()
    pixels = np.ones((SIZE, SIZE, 4), np.float32)
    pixels[..., :3] = np.clip(picture, 0.0, 1.0) ** (1.0 / 2.2)
    return pixels


def _light(size, blades=7, edge=0.5):
    light = sprite(Appearance(iris=BladedIris(blades, 0.4, 0.2), edge=edge), size, extent=1.1)
    return light[..., 0] / np.percentile(light[light > 0.0], 60)


def _disc():
    return 0.5 * np.repeat(_light(SIZE)[..., None], 3, axis=-1)


def _lamps():
    picture = np.full((SIZE, SIZE, 3), _NIGHT)
    for x, y, size, color in _LAMPS:
        picture[y : y + size, x : x + size] += 0.4 * _light(size)[..., None] * color
    return picture


def _fringes():
    picture = np.full((SIZE, SIZE, 3), _NIGHT)
    light = _light(88, blades=0, edge=0.0)
    for channel, shift in enumerate((-7, 0, 7)):
        low = (SIZE - len(light)) // 2 + shift
        picture[low : low + len(light), low : low + len(light), channel] += 0.6 * light
    return picture
