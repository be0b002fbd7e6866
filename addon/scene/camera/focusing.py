"""Focusing Blender's camera: on a place, with or without an object that it follows.

The focus is Blender's own (`Camera.dof`), so it holds for every engine. A camera that follows a
focus object goes on following it from the place that was picked: an empty there, a child of the
object, becomes the focus object, and keeps its offset while the object moves. What a driver, a lock
or a library holds is never changed in vain: `why_not_focused` says so first.
"""

import bpy
import numpy as np
from bpy_extras.anim_utils import action_get_channelbag_for_slot
from mathutils import Matrix, Vector

from ...errors import FocusError
from ...sampling.thin_lens import depth_of_field
from .camera import camera_place, read_lens

# Custom property of the empties that are made here.
OFFSET_MARK = "aplanat_focus_offset"
# Of a camera's data.
DISTANCE = "dof.focus_distance"


def depth_along(camera, point):
    """Return how far a place is from a camera along its optical axis.

    Parameters
    ----------
    camera : bpy.types.Object
    point : sequence of 3 float
        In world space.

    Returns
    -------
    float
        In m; negative behind the camera.
    """
    return -(camera_place(camera).inverted() @ Vector(point)).z


def why_not_focused(camera, follow=True):
    """Return why a camera's focus cannot be moved.

    Parameters
    ----------
    camera : bpy.types.Object or None
    follow : bool
        Whether the focus object, if there is one, goes on being followed; then the focus distance
        does not count.

    Returns
    -------
    str
        A sentence without its full stop; empty if the focus can be moved.
    """
    if camera is None or camera.type != "CAMERA":
        return "The scene has no camera; the focus stays"
    data = camera.data
    if not data.is_editable:
        return f"The data of camera '{camera.name}' is linked; make a library override of it"
    followed = data.dof.focus_object if follow else None
    if followed is None:
        if _is_driven(data, DISTANCE):
            return f"A driver sets the focus distance of camera '{camera.name}'; the focus stays"
        if _has_locked_keys(data):
            return f"Keyframes of the focus distance of camera '{camera.name}' are locked or linked"
    elif _is_own_empty(followed, data):
        holder = _holder(followed)
        if holder:
            return f"{holder} holds focus object '{followed.name}'; the focus stays"
    return ""


def _is_driven(block, path):
    drivers = block.animation_data.drivers if block.animation_data else ()
    return any(curve.data_path == path and not curve.mute for curve in drivers)


def _has_locked_keys(data):
    action = data.animation_data and data.animation_data.action
    if not action:
        return False
    bag = action_get_channelbag_for_slot(action, data.animation_data.action_slot)
    curve = bag and bag.fcurves.find(DISTANCE)
    return not action.is_editable or bool(curve and curve.lock)


def _is_own_empty(followed, data):
    # A copied camera has the empty of the first, whose focus must stay.
    others = (other for other in bpy.data.cameras if other != data)
    shared = any(other.dof.focus_object == followed for other in others)
    return OFFSET_MARK in followed and followed.is_editable and not shared


def _holder(empty):
    if any(empty.lock_location):
        return "A lock"
    if _is_driven(empty, "location"):
        return "A driver"
    if any(constraint.enabled and constraint.influence > 0.0 for constraint in empty.constraints):
        return "A constraint"
    return ""


def key_focus(scene, data):
    """Set a key of a camera's focus distance where Blender sets keys by itself.

    Parameters
    ----------
    scene : bpy.types.Scene
    data : bpy.types.Camera
    """
    if scene.tool_settings.use_keyframe_insert_auto and data.dof.focus_object is None:
        data.keyframe_insert(DISTANCE)


def focus_on(scene, camera, point, follow=True):
    """Focus a camera on a place.

    Parameters
    ----------
    scene : bpy.types.Scene
    camera : bpy.types.Object
    point : sequence of 3 float
        In world space.
    follow : bool
        Go on following the focus object, if there is one, from the place; otherwise it is let go.

    Returns
    -------
    float
        The focus distance, m.

    Raises
    ------
    FocusError
        If the place is not in front of the camera, or the focus cannot be moved.
    """
    if why := why_not_focused(camera, follow):
        raise FocusError(why)
    distance = depth_along(camera, point)
    if not distance > 0.0:
        raise FocusError("the place is behind the camera; the focus stays")
    dof = camera.data.dof
    dof.use_dof = True
    followed = dof.focus_object if follow else None
    if followed is None:
        dof.focus_object = None
    elif _is_own_empty(followed, camera.data):
        followed.matrix_world = Matrix.Translation(point)
    else:
        _follow_from(scene, camera, followed, point)
    dof.focus_distance = distance
    return distance


def _follow_from(scene, camera, followed, point):
    dof = camera.data.dof
    empty = bpy.data.objects.new(f"{camera.name} Focus", None)
    empty[OFFSET_MARK] = True
    empty.empty_display_type = "SPHERE"
    empty.empty_display_size = 0.05
    empty.hide_render = True
    home = next((c for c in camera.users_collection if c.is_editable), scene.collection)
    home.objects.link(empty)
    if OFFSET_MARK in followed:
        # Beside the empty of another camera.
        empty.parent, empty.parent_type = followed.parent, followed.parent_type
        empty.parent_bone = followed.parent_bone
    else:
        empty.parent = followed
    if dof.focus_subtarget and followed.pose and dof.focus_subtarget in followed.pose.bones:
        empty.parent_type, empty.parent_bone = "BONE", dof.focus_subtarget
    # Blender solves it for the place within the parent.
    empty.matrix_world = Matrix.Translation(point)
    dof.focus_object, dof.focus_subtarget = empty, ""


def read_depth_of_field(depsgraph, camera, real_lens=None):
    """Return how a camera blurs, in pixels of the scene's picture.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph
    camera : bpy.types.Object
    real_lens : LensSettings or None

    Returns
    -------
    DepthOfField or None
        None without depth of field, or where nothing can be in focus.
    """
    camera = camera.evaluated_get(depsgraph)
    if camera.data.type not in {"PERSP", "ORTHO"}:
        return None
    lens, _ = read_lens(depsgraph, camera, real_lens)
    if lens is None:
        return None
    scene = depsgraph.scene
    corners = np.array(camera.data.view_frame(scene=scene), np.float64)
    orthographic = camera.data.type == "ORTHO"
    if not orthographic:
        corners /= -corners[:, 2:]
    width = scene.render.resolution_x * scene.render.resolution_percentage / 100.0
    return depth_of_field(lens, width / np.ptp(corners[:, 0]), orthographic)
