"""The circle of confusion and the distances of the depth of field over 3D views."""

import math

import blf
import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

from ...engine.shared_resources import real_lens_of
from ...errors import AplanatError
from ...scene.camera.camera import camera_place
from ...scene.camera.focusing import read_depth_of_field
from .lengths import in_units

NEAR, FOCUS, FAR = (1.0, 0.3, 0.2), (0.2, 0.95, 0.35), (0.35, 0.55, 1.0)
_FONT, _SIZE = 0, 13
# Numbers are written in pale colours with a dark rim, so that they stand out against the tint.
_PALE, _RIM = 0.55, 6

# What Blender gives for a handler that is added, to remove it.
_handles = []


def shown_blur(context):
    """Return how the scene's camera blurs, as `DepthOfField`; None where nothing is to be shown."""
    scene = context.scene
    camera = scene.camera
    if camera is None or camera.type != "CAMERA" or not camera.data.dof.use_dof:
        return None
    try:
        depsgraph = context.evaluated_depsgraph_get()
        return read_depth_of_field(depsgraph, camera, real_lens_of(camera.data))
    except AplanatError:
        # The panel and the viewport tell why.
        return None


def planes(context, blur):
    """Return the planes to be shown: depth, colour and word of each, the focus plane first."""
    near, far = blur.limits(context.scene.aplanat.acceptable_blur)
    found = [(blur.focus_distance, FOCUS, "Focus")]
    if near > 0.0:
        found.append((near, NEAR, "Near"))
    found.append((far, FAR, "Far"))
    return found


def _draw_colors():
    context = bpy.context
    if not context.scene.aplanat.show_coc or not context.space_data.overlay.show_overlays:
        return
    blur = shown_blur(context)
    if blur is None:
        return
    from ...device import geometry, state
    from ...passes import focus_overlay

    region = context.region_data
    to_camera = np.array(camera_place(context.scene.camera).inverted())
    from_clip = to_camera @ np.linalg.inv(np.array(region.perspective_matrix, np.float64))
    with state.preserved():
        focus_overlay.draw(
            geometry.fullscreen_batch(), from_clip, blur, context.scene.aplanat.acceptable_blur
        )


def _draw_numbers():
    context = bpy.context
    overlay = context.space_data.overlay
    if not context.scene.aplanat.show_focus_planes or not overlay.show_overlays:
        return
    blur = shown_blur(context)
    if blur is None:
        return
    blf.size(_FONT, _SIZE * context.preferences.system.ui_scale)
    found = sorted(planes(context, blur), key=lambda plane: plane[0])
    if context.region_data.view_perspective == "CAMERA":
        _list_numbers(context, found)
    else:
        _place_numbers(context, found)


def _list_numbers(context, found):
    """Write them below one another: through the camera, all planes are the same rectangle."""
    step = 1.6 * _SIZE * context.preferences.system.ui_scale
    for i, (depth, color, word) in enumerate(reversed(found)):
        _write(f"{word}  {in_units(context.scene, depth)}", color, step, (i + 1.5) * step)


def _place_numbers(context, found):
    camera = context.scene.camera
    for depth, color, word in found:
        if math.isinf(depth):
            continue
        # At the left end of the upper rim, in its middle, at its right end: words do not cover
        # one another.
        corners = frame_at(context.scene, camera, depth)
        left, right = (side(corner.x for corner in corners) for side in (min, max))
        top = max(corner.y for corner in corners)
        across = {"Near": left, "Focus": 0.5 * (left + right), "Far": right}[word]
        place = camera_place(camera) @ Vector((across, top, -depth))
        seen = location_3d_to_region_2d(context.region, context.region_data, place)
        if seen is not None:
            _write(f"{word}  {in_units(context.scene, depth)}", color, seen.x, seen.y + 4)


def frame_at(scene, camera, depth):
    """Return the four corners of a camera's picture at a depth, in camera space."""
    corners = camera.data.view_frame(scene=scene)
    if camera.data.type == "ORTHO":
        return [Vector((corner.x, corner.y, -depth)) for corner in corners]
    return [corner * (depth / -corner.z) for corner in corners]


def _write(text, color, x, y):
    blf.enable(_FONT, blf.SHADOW)
    blf.shadow(_FONT, _RIM, 0.0, 0.0, 0.0, 0.9)
    blf.shadow_offset(_FONT, 0, 0)
    blf.color(_FONT, *(_PALE + (1.0 - _PALE) * part for part in color), 1.0)
    blf.position(_FONT, x, y, 0.0)
    blf.draw(_FONT, text)
    blf.disable(_FONT, blf.SHADOW)


def register():
    """Draw in every 3D view."""
    if bpy.app.background:
        return
    add = bpy.types.SpaceView3D.draw_handler_add
    _handles.append(add(_draw_colors, (), "WINDOW", "POST_VIEW"))
    _handles.append(add(_draw_numbers, (), "WINDOW", "POST_PIXEL"))


def unregister():
    """Undo `register`."""
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
