"""Lengths in the units of a scene."""

import math

import bpy


def in_units(scene, length):
    """Return a length as Blender writes it in a scene.

    Parameters
    ----------
    scene : bpy.types.Scene
    length : float
        In Blender's units, m without a scale; may be infinite.

    Returns
    -------
    str
    """
    if math.isinf(length):
        return "\N{INFINITY}"
    units = scene.unit_settings
    name = "METRIC" if units.system == "NONE" else units.system
    return bpy.utils.units.to_string(name, "LENGTH", length * units.scale_length, precision=4)
