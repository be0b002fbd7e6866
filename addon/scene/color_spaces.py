"""Pixels of any colour space to scene linear, with Blender's OpenColorIO configuration."""

import os
import sys
from functools import cache

import numpy as np

SRGB = "sRGB"
# Spaces whose numbers are used as they are, and the scene-linear one that Blender starts with.
DATA_SPACES = frozenset({"Non-Color", "Raw"})
REC709 = "Linear Rec.709"


def working_space():
    """Return the name of the open file's scene-linear space."""
    import bpy

    return getattr(getattr(bpy.data, "colorspace", None), "working_space", REC709)


@cache
def _processor(source, target):
    import bpy

    local = bpy.utils.resource_path("LOCAL")
    try:
        import PyOpenColorIO
    except ImportError:
        # As a Python module, Blender leaves its bundled packages off the path.
        version = f"python{sys.version_info.major}.{sys.version_info.minor}"
        folder = os.path.join(local, "python", "lib", version, "site-packages")
        if not os.path.isdir(folder):
            return None
        sys.path.append(folder)
        try:
            import PyOpenColorIO
        except ImportError:
            return None
        finally:
            sys.path.remove(folder)
    path = os.environ.get("OCIO") or os.path.join(
        local, "datafiles", "colormanagement", "config.ocio"
    )
    if not os.path.isfile(path):
        path = os.path.join(
            bpy.utils.resource_path("SYSTEM"), "datafiles", "colormanagement", "config.ocio"
        )
    try:
        config = PyOpenColorIO.Config.CreateFromFile(path)
        return config.getProcessor(source, target).getDefaultCPUProcessor()
    except PyOpenColorIO.Exception:
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
