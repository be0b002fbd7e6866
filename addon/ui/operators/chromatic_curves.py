"""The node group that holds a camera's drawn curves: made when one is needed, never shared."""

import json

import bpy
from bpy.app.handlers import persistent

from ...scene.camera.drawn_curves import (
    CURVE_NAMES,
    EQUALIZER,
    curve_points,
    find_mapping,
    mark_curve_group,
)

# A name that starts with a dot is left out of Blender's lists.
_GROUP_NAME = ".Aplanat Curves"
_HANDLES = frozenset({"AUTO", "AUTO_CLAMPED", "VECTOR"})
_IDENTITY = ((0.0, 0.0, "AUTO"), (1.0, 1.0, "AUTO"))
_FLAT = ((0.0, 1.0, "AUTO"), (1.0, 1.0, "AUTO"))
# Blender keeps no more points in a curve.
_MOST_POINTS = 256


def make_group(settings):
    """Return the node group of settings, made or completed if need be.

    Parameters
    ----------
    settings : AplanatChromaticSettings
        Of a camera that may be changed.

    Returns
    -------
    bpy.types.NodeTree
    """
    group = settings.curves
    if group is None:
        group = settings.curves = bpy.data.node_groups.new(_GROUP_NAME, "ShaderNodeTree")
        mark_curve_group(group)
    elif not group.is_editable:
        # Linked with a camera of which this is an override.
        group = settings.curves = group.copy()
    for number, name in enumerate(CURVE_NAMES):
        if find_mapping(group, name) is None:
            stray = group.nodes.get(name)
            if stray is not None:
                group.nodes.remove(stray)
            node = group.nodes.new("ShaderNodeFloatCurve")
            node.name = node.label = name
            node.location = 0.0, -320.0 * number
            _prepare(node.mapping, name)
    return group


def set_points(mapping, points):
    """Draw a curve.

    Parameters
    ----------
    mapping : bpy.types.CurveMapping
    points : sequence of (float, float, str)
        At least two, as of `curve_points`; the places must rise.
    """
    existing = mapping.curves[0].points
    while len(existing) > 2:
        existing.remove(existing[1])
    while len(existing) < len(points):
        existing.new(0.5, 0.5)
    for point, (x, y, handle) in zip(existing, points, strict=True):
        point.location = x, y
        point.handle_type = handle
    mapping.update()
    mapping.id_data.update_tag()


def curves_as_text(settings):
    """Return all drawn curves as JSON, or an empty text if there is no group."""
    group = settings.curves
    if group is None:
        return ""
    found = {name: find_mapping(group, name) for name in CURVE_NAMES}
    return json.dumps(
        {name: _rounded(mapping) for name, mapping in found.items() if mapping is not None}
    )


def curves_from_text(settings, text):
    """Draw the curves of a text that `curves_as_text` made; others go back to their start.

    An empty text, or what is no such text, leaves the curves as they are.
    """
    wanted = _parsed(text)
    if not wanted:
        return
    group = make_group(settings)
    for name in CURVE_NAMES:
        mapping = find_mapping(group, name)
        points = [list(point) for point in wanted.get(name, _first_points(name))]
        if _rounded(mapping) != points:
            set_points(mapping, points)


def _rounded(mapping):
    return [[round(x, 6), round(y, 6), handle] for x, y, handle in curve_points(mapping)]


def _parsed(text):
    try:
        curves = json.loads(text) if text else {}
    except ValueError:
        return {}
    if not isinstance(curves, dict):
        return {}
    return {name: points for name, points in curves.items() if _are_points(points)}


def _are_points(points):
    if not isinstance(points, list) or not 2 <= len(points) <= _MOST_POINTS:
        return False
    for point in points:
        if not isinstance(point, list) or len(point) != 3 or point[2] not in _HANDLES:
            return False
        if not all(isinstance(value, int | float) and abs(value) < 1e6 for value in point[:2]):
            return False
    places = [point[0] for point in points]
    return places == sorted(places)


def _first_points(name):
    return _FLAT if name == EQUALIZER else _IDENTITY


def _prepare(mapping, name):
    mapping.extend = "HORIZONTAL"
    mapping.use_clip = True
    mapping.clip_min_x, mapping.clip_max_x = 0.0, 1.0
    # A negative map turns the colours round; a negative weight means nothing.
    mapping.clip_min_y, mapping.clip_max_y = (0.0, 1.0) if name == EQUALIZER else (-1.0, 1.0)
    set_points(mapping, _first_points(name))
    mapping.reset_view()


def separate_curves():
    """Give each camera curves of its own: copies of a camera point to those of the first."""
    owners = {}
    for camera in bpy.data.cameras:
        group = camera.aplanat.chromatic.curves
        if group is None:
            continue
        if owners.setdefault(group, camera) is not camera and camera.is_editable:
            camera.aplanat.chromatic.curves = group.copy()


@persistent
def _separate_after_update(_scene, depsgraph):
    if depsgraph.id_type_updated("CAMERA"):
        separate_curves()


@persistent
def _separate_after_load(*_):
    separate_curves()


def register():
    """Look after the curves of copied cameras."""
    bpy.app.handlers.depsgraph_update_post.append(_separate_after_update)
    bpy.app.handlers.load_post.append(_separate_after_load)


def unregister():
    """Undo `register`."""
    bpy.app.handlers.load_post.remove(_separate_after_load)
    bpy.app.handlers.depsgraph_update_post.remove(_separate_after_update)
