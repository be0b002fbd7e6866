"""Pictures of discs as icons: made when a panel is drawn with a new appearance."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from ...lens_bokeh.look.grain import transmission
from ...lens_bokeh.look.sprite import sprite
from ...lens_bokeh.openings.masks import texel_centres
from .picture_icons import PictureIcons

_SIZE = 96
# Displayed brightness of an even disc.
_GREY = 0.55

icons = PictureIcons()
register, unregister = icons.register, icons.unregister


def disc_icons(camera, appearance, corner):
    """Return the icons that show discs: in front of the focus, behind it, and in the corner.

    Parameters
    ----------
    camera : bpy.types.Camera
        Each has icons of its own.
    appearance : Appearance
        Its diffraction is left out: that depends on the depth.
    corner : tuple of 2 float
        Tangents of the field angle of the upper right corner.

    Returns
    -------
    tuple of 3 int
        0 in a Blender without windows.
    """
    inputs = (replace(appearance, diffraction=None), corner)
    name = str(camera.session_uid)
    return icons.icon_ids(name, inputs, lambda: disc_pictures(*inputs), 3)


# Memo of its arguments alone: cameras that look alike share their pictures.
@lru_cache(maxsize=8)
def disc_pictures(appearance, corner):
    """Draw discs in front of the focus, behind it, and behind it in the corner of the picture.

    Parameters
    ----------
    appearance : Appearance
    corner : tuple of 2 float
        Tangents of the field angle.

    Returns
    -------
    tuple of 3 ndarray of shape (size, size, 4)
        float32, display referred with alpha, bottom row first; all for the same point of light.
    """
    pictures = []
    extent = 1.06 * max(1.0, 1.0 / appearance.anamorphic_ratio)
    texel = 2.0 * extent / _SIZE
    center = (0.0, 0.0)
    places = texel_centres(_SIZE, extent)
    speckles = _speckles(appearance.grain, appearance.anamorphic_ratio, extent)
    appearance = replace(appearance, grain=None)
    whole = appearance.transmission(places, texel, center).sum()
    for upright, chief in ((False, center), (True, center), (True, corner)):
        light = sprite(appearance, _SIZE, upright=upright, chief=chief, extent=extent)[..., 0]
        # A sprite has all of the light, even where little passes.
        passed = appearance.transmission(places, texel, chief).sum() / whole
        grain = speckles if upright else speckles[::-1, ::-1]
        # Over the light of an even round disc.
        value = np.sqrt(light * grain * passed * np.pi / texel**2) * _GREY
        picture = np.ones((_SIZE, _SIZE, 4), np.float32)
        picture[..., :3] = np.clip(value, 0.0, 1.0)[..., None]
        # Dark where nothing is, on any theme.
        picture[..., :3] = np.maximum(picture[..., :3], 0.02)
        pictures.append(picture)
    return tuple(pictures)


# Memo of its arguments alone: three discs have the same dust.
@lru_cache(maxsize=8)
def _speckles(grain, ratio, extent):
    """Return the transmittance of grain and dust, drawn once for all discs."""
    if grain is None:
        return np.ones((_SIZE, _SIZE))
    return transmission(grain, texel_centres(_SIZE, extent) * (ratio, 1.0))
