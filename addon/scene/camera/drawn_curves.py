"""Curves that a user draws for a camera: kept as nodes of a hidden node group.

Blender has no curve property. A Float Curve node is one: it has Blender's own curve widget, is
saved, appended and linked with the camera that points to its group, is evaluated with it, and its
points take keyframes and drivers.
"""

from collections import OrderedDict
from threading import Lock

import numpy as np

from ...sampling.chromatic import SPECTRAL_RANGE_NM
from ...sampling.field_maps import CURVE_POINTS

EQUALIZER = "Equalizer"
# Wavelengths, nm, at the ends of the equalizer's curve, whatever range the settings use.
EQUALIZER_RANGE_NM = SPECTRAL_RANGE_NM
# Two atoms for each of the two field maps.
MAP_CURVES = {
    ("axial", 0): "Axial First",
    ("axial", 1): "Axial Then",
    ("lateral", 0): "Lateral First",
    ("lateral", 1): "Lateral Then",
}
# Custom property that marks the node group; Blender may change its name to keep names unique.
_MARK = "aplanat_curves"
CURVE_NAMES = (*MAP_CURVES.values(), EQUALIZER)

# Number of values of a curve, evenly spaced over its width, both ends included.
SAMPLES = CURVE_POINTS
_MOST_KEPT = 128

# A memo by the points of a curve, of which its values are a function.
_kept = OrderedDict()
# Viewport and final render may extract at the same time.
_lock = Lock()


def mark_curve_group(group):
    """Note in a node group that it holds a camera's curves and nothing that is drawn itself."""
    group[_MARK] = True


def is_curve_group(block):
    """Whether a data-block holds a camera's curves.

    Parameters
    ----------
    block : bpy.types.ID

    Returns
    -------
    bool
    """
    return block.id_type == "NODETREE" and bool(block.get(_MARK))


def curve_points(mapping):
    """Return the points of a curve.

    Parameters
    ----------
    mapping : bpy.types.CurveMapping
        Its first curve.

    Returns
    -------
    tuple of (float, float, str)
        Place, value and kind of handle.
    """
    return tuple((*point.location, point.handle_type) for point in mapping.curves[0].points)


def find_mapping(group, name):
    """Return the curve mapping of a name in a camera's node group, or None.

    Parameters
    ----------
    group : bpy.types.NodeTree or None
    name : str
        One of `CURVE_NAMES`.

    Returns
    -------
    bpy.types.CurveMapping or None
    """
    node = group.nodes.get(name) if group is not None else None
    return getattr(node, "mapping", None)


def curve_values(group, name):
    """Return the values of a drawn curve over its width.

    Parameters
    ----------
    group : bpy.types.NodeTree or None
    name : str
        One of `CURVE_NAMES`.

    Returns
    -------
    tuple of float or None
        `SAMPLES` values at places from 0 to 1; the identical tuple as long as the points stay. None
        if there is no such curve.
    """
    mapping = find_mapping(group, name)
    if mapping is None:
        return None
    bounds = (mapping.clip_min_x, mapping.clip_max_x, mapping.clip_min_y, mapping.clip_max_y)
    key = curve_points(mapping), mapping.extend, mapping.use_clip, bounds
    with _lock:
        values = _kept.get(key)
        if values is None:
            values = _kept[key] = _sampled(mapping)
            while len(_kept) > _MOST_KEPT:
                _kept.popitem(last=False)
        else:
            _kept.move_to_end(key)
    return values


def _sampled(mapping):
    # Animation moves the points, but leaves Blender's table of the curve as it was.
    mapping.update()
    mapping.initialize()
    curve = mapping.curves[0]
    places = np.linspace(0.0, 1.0, SAMPLES).tolist()
    return tuple(mapping.evaluate(curve, place) for place in places)
