"""A camera's lens settings of Aplanat as values that a file keeps, and a camera gets back.

They are kept by the names of the properties, as presets keep them: what another version does not
know is left at its default there.
"""

import base64
import contextlib
import zlib

import bpy
import numpy as np

from ...errors import InputError
from ...lens_bokeh.openings.blades import BladedIris
from ...lens_bokeh.openings.pictures import PictureIris
from ...lens_io.lens_shelf import LensShelf
from ...lens_io.recorded_lens import text_of
from ...settings.bokeh_settings import BOKEH, DEBUG
from ...settings.chromatic_settings import CHROMATIC
from ...settings.scene_part_settings import ABERRATIONS, DISTORTION, LENS
from ...settings.setting import settings_of
from .irises import IrisReader
from .lenses import user_folder

_LEVELS = 65535.0
# Properties of the groups, the drawn curves last: into a group that then exists.
_BOKEH = tuple(
    name
    for name, setting in settings_of(*BOKEH).items()
    if setting.default is not None and name not in settings_of(DEBUG)
)
_CHROMATIC = (*settings_of(*CHROMATIC), "curve_text")


def record_lens(camera, shelf=None):
    """Return the settings of a camera.

    Parameters
    ----------
    camera : bpy.types.Camera
        Evaluated.
    shelf : LensShelf, optional
        The library that its lens is of; None: it is read anew.

    Returns
    -------
    dict
        For JSON: ``lens``, ``zoom_label``, ``distortion`` and ``distortion_k``; ``bokeh`` and
        ``chromatic`` by the names of their properties; ``lens_file``, the text of the lens, and
        ``iris``, the picture of the opening, if any.
    """
    own = camera.aplanat
    told = {name: getattr(own, name) for name in settings_of(LENS, ABERRATIONS, DISTORTION)}
    told["bokeh"] = {name: getattr(own.bokeh, name) for name in _BOKEH}
    told["chromatic"] = {name: getattr(own.chromatic, name) for name in _CHROMATIC}
    text = own.lens and text_of(shelf or LensShelf([user_folder()]), own.lens)
    if text:
        told["lens_file"] = text
    image = own.bokeh.iris_image
    if image is not None:
        # One that cannot be read is none: the blades are drawn then, here as there.
        with contextlib.suppress(InputError):
            picture = IrisReader().read(image.original, 0.0).picture
            levels = np.round(np.maximum(picture, 0.0) * (_LEVELS / picture.max()))
            packed = zlib.compress(levels.astype("<u2").tobytes())
            told["iris"] = {
                "name": image.name,
                "size": list(picture.shape[::-1]),
                "texels": base64.b64encode(packed).decode("ascii"),
            }
    return told


def recorded_file(told):
    """Return the id and the text of the lens of settings that were recorded, or None.

    Parameters
    ----------
    told : dict or None
        Of `record_lens`.

    Returns
    -------
    tuple of 2 str, or None
        None for no lens, and where an older version recorded its id alone.
    """
    told = told or {}
    found = told.get("lens"), told.get("lens_file")
    return found if all(part and isinstance(part, str) for part in found) else None


def recorded_opening(told, blades, rotation):
    """Return the opening of settings that were recorded, behind no round stop.

    Parameters
    ----------
    told : dict or None
        Of `record_lens`.
    blades : int
        Below 3 it is round.
    rotation : float
        In radians.

    Returns
    -------
    BladedIris or PictureIris
    """
    told = told or {}
    picture = _picture(told.get("iris"))
    bokeh = told.get("bokeh")
    curvature = bokeh.get("blade_curvature", 0.0) if isinstance(bokeh, dict) else 0.0
    with contextlib.suppress(InputError, TypeError):
        if picture is not None:
            return PictureIris(picture, rotation)
        return BladedIris(blades, float(curvature), rotation) if blades >= 3 else BladedIris()
    return BladedIris(blades, 0.0, rotation) if blades >= 3 else BladedIris()


def apply_lens(told, camera):
    """Give a camera settings that were recorded.

    Parameters
    ----------
    told : dict
        Of `record_lens`; what it does not tell, or not as this version knows it, stays as it is.
    camera : bpy.types.Camera
        An original.

    Returns
    -------
    bpy.types.Image or None
        The picture of the opening that was made.
    """
    own = camera.aplanat
    bokeh = told.get("bokeh")
    if isinstance(bokeh, dict) and "distortion_source" in bokeh:
        # Recorded when distortion was part of the bokeh.
        source = bokeh["distortion_source"] if bokeh.get("use", True) else "NONE"
        told = {"distortion": source, "distortion_k": bokeh.get("distortion"), **told}
    _assign(own, settings_of(LENS, ABERRATIONS, DISTORTION), told)
    _assign(own.bokeh, _BOKEH, told.get("bokeh"))
    _assign(own.chromatic, _CHROMATIC, told.get("chromatic"))
    image = _image(told.get("iris"))
    if image is not None:
        own.bokeh.iris_image = image
    return image


def _assign(group, names, values):
    if not isinstance(values, dict):
        return
    for name in names:
        if name in values:
            # Of another version, or no number at all.
            with contextlib.suppress(TypeError, ValueError):
                setattr(group, name, values[name])


def _picture(told):
    try:
        width, height = told["size"]
        levels = zlib.decompress(base64.b64decode(told["texels"]))
        return np.frombuffer(levels, "<u2").reshape(height, width) / _LEVELS
    except (KeyError, TypeError, ValueError, zlib.error):
        return None


def _image(told):
    grey = _picture(told)
    if grey is None:
        return None
    name, (height, width) = str(told.get("name", "iris")), grey.shape
    image = bpy.data.images.new(name, width, height, float_buffer=True, is_data=True)
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = grey[..., None]
    image.pixels.foreach_set(pixels.ravel())
    return image
