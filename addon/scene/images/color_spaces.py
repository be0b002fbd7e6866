"""Conversion of pixels to scene linear, with Blender's OpenColorIO configuration."""

import importlib
import os
import sys
from functools import cache

import numpy as np

from ...snapshot.surface_graph import REC709_LUMINANCE

SRGB = "sRGB"
# Spaces that are used without conversion (data), and Blender's default scene-linear space.
DATA_SPACES = frozenset({"Non-Color", "Raw"})
REC709 = "Linear Rec.709"
# A role of Blender's configuration: CIE XYZ with the white of D65.
_XYZ = "cie_xyz_d65_interchange"
# From CIE 1931 XYZ (white of D65) to linear Rec.709.
_XYZ_TO_REC709 = (
    (3.2404542, -1.5371385, -0.4985314),
    (-0.9692660, 1.8760108, 0.0415560),
    (0.0556434, -0.2040259, 1.0572252),
)


def working_space():
    """Return the name of the open file's scene-linear space."""
    import bpy

    return getattr(getattr(bpy.data, "colorspace", None), "working_space", REC709)


def luminance_weights():
    """Return the weights with which the open file's colours become a value, as in Cycles.

    Returns
    -------
    tuple of 3 float
        Their sum is 1.
    """
    return _luminance_weights(working_space())


# Memo of the space alone: Blender's configuration is that of the process.
@cache
def _luminance_weights(space):
    if space == REC709:
        return REC709_LUMINANCE
    primaries = np.ones((1, 3, 4), np.float32)
    primaries[0, :, :3] = np.eye(3)
    xyz = convert(primaries, space, _XYZ)
    if xyz is None:
        return REC709_LUMINANCE
    weights = xyz[0, :, 1].astype(np.float64)
    return tuple(float(w) for w in weights / weights.sum())


# Memo of the name alone: what comes with this Blender.
@cache
def bundled_module(name):
    """Import one of the packages that come with Blender.

    Parameters
    ----------
    name : str

    Returns
    -------
    module or None
        None where this Blender was built without it.
    """
    import bpy

    try:
        return importlib.import_module(name)
    except ImportError:
        pass
    # As a Python module, Blender leaves its bundled packages off the path.
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    local = bpy.utils.resource_path("LOCAL")
    folder = os.path.join(local, "python", "lib", version, "site-packages")
    if not os.path.isdir(folder):
        return None
    sys.path.append(folder)
    try:
        return importlib.import_module(name)
    except ImportError:
        return None
    finally:
        sys.path.remove(folder)


# Memo of the two names alone: Blender's configuration is that of the process.
@cache
def _processor(source, target):
    import bpy

    ocio = bundled_module("PyOpenColorIO")
    if ocio is None:
        return None
    local = bpy.utils.resource_path("LOCAL")
    path = os.environ.get("OCIO") or os.path.join(
        local, "datafiles", "colormanagement", "config.ocio"
    )
    if not os.path.isfile(path):
        path = os.path.join(
            bpy.utils.resource_path("SYSTEM"), "datafiles", "colormanagement", "config.ocio"
        )
    try:
        config = ocio.Config.CreateFromFile(path)
        return config.getProcessor(source, target).getDefaultCPUProcessor()
    except ocio.Exception:
        return None


def convert(pixels, source, target):
    """Convert pixels between two colour spaces of Blender's configuration.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 4)
        float32; not changed.
    source, target : str
        Names as in Blender's colour space menus.

    Returns
    -------
    ndarray or None
        None where there is no such conversion.
    """
    processor = _processor(source, target)
    if processor is None:
        return None
    converted = np.ascontiguousarray(pixels, np.float32).copy()
    processor.applyRGBA(converted)
    return converted


def from_xyz(xyz, space):
    """Convert CIE 1931 XYZ (white of D65) to a scene-linear space; negative light is left out.

    Parameters
    ----------
    xyz : ndarray of shape (height, width, 3)
    space : str
        As of `working_space`.

    Returns
    -------
    ndarray of shape (height, width, 4)
        float32; the fourth channel is 1.
    """
    pixels = np.ones((*xyz.shape[:2], 4), np.float32)
    pixels[..., :3] = xyz @ np.array(_XYZ_TO_REC709, xyz.dtype).T
    if space != REC709:
        converted = convert(pixels, REC709, space)
        pixels = pixels if converted is None else converted
    return np.maximum(pixels, 0.0)
