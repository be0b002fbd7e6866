"""Planes of the depth of field in the 3D view; that of the focus can be dragged."""

import math

import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Matrix, Vector

from ...scene.camera.camera import camera_place
from ...scene.camera.focusing import key_focus, why_not_focused
from .focus_overlay import frame_at, planes, shown_blur
from .lengths import in_units

_SQUARE = ((-1, -1), (1, -1), (1, 1), (-1, 1))
_FACE = tuple((*_SQUARE[i], 0) for i in (0, 1, 2, 0, 2, 3))
_RIM = tuple((*_SQUARE[i % 4], 0) for j in range(4) for i in (j, j + 1))
# A cross on the optical axis: the handle in the camera's own view.
_CROSS = ((-0.08, 0, 0), (0.08, 0, 0), (0, -0.08, 0), (0, 0.08, 0))
# Of the plane of the focus and of the limits.
_FACE_ALPHA = 0.25, 0.12
_RIM_ALPHA = 0.7
# In the camera's view the distance grows by e where the mouse moves up by so many pixels.
_PIXELS_OF_E = 300.0


class APLANAT_GT_focus_plane(bpy.types.Gizmo):
    """A plane across the camera's view."""

    bl_idname = "APLANAT_GT_focus_plane"
    __slots__ = ("_before", "_data", "_grabbed", "_shapes", "face_alpha", "movable")

    def setup(self):
        """Make the shapes."""
        self.movable, self.face_alpha = False, 0.0
        self._shapes = {
            "face": self.new_custom_shape("TRIS", _FACE),
            "rim": self.new_custom_shape("LINES", _RIM),
            "handle": self.new_custom_shape("LINES", (*_RIM, *_CROSS)),
        }

    def draw(self, context):
        """Draw face and rim; through the camera the rim alone."""
        if context.region_data.view_perspective != "CAMERA":
            self.alpha = self.alpha_highlight = self.face_alpha
            self.draw_custom_shape(self._shapes["face"])
        self.alpha = self.alpha_highlight = 1.0 if self.is_highlight else _RIM_ALPHA
        self.draw_custom_shape(self._shapes["handle" if self.movable else "rim"])

    def draw_select(self, _context, select_id):
        """Draw what can be grabbed."""
        if self.movable:
            self.draw_custom_shape(self._shapes["handle"], select_id=select_id)

    def invoke(self, context, event):
        """Remember where the focus was."""
        self._data = context.scene.camera.data
        self._before = self._data.dof.focus_distance
        self._grabbed = event.mouse_region_x, event.mouse_region_y
        return {"RUNNING_MODAL"}

    def modal(self, context, event, tweak):
        """Move the plane along the optical axis with the mouse."""
        mouse = Vector((event.mouse_region_x, event.mouse_region_y))
        moved = mouse - Vector(self._grabbed)
        if "PRECISE" in tweak:
            moved *= 0.1
        camera = context.scene.camera
        distance = self._distance(context, camera, moved)
        camera.data.dof.focus_distance = max(distance, 1e-3)
        where = in_units(context.scene, camera.data.dof.focus_distance)
        context.area.header_text_set(f"Focus Distance: {where}")
        return {"RUNNING_MODAL"}

    def _distance(self, context, camera, moved):
        region, view = context.region, context.region_data
        if view.view_perspective != "CAMERA":
            place, axis = camera_place(camera), Vector((0.0, 0.0, -1.0))
            step = 0.01 * self._before
            ends = [
                location_3d_to_region_2d(region, view, place @ (axis * depth))
                for depth in (self._before, self._before + step)
            ]
            if None not in ends:
                along = ends[1] - ends[0]
                # Seen along the axis there is no way to go.
                if along.length > 0.02:
                    return self._before + step * moved.dot(along) / along.length_squared
        return self._before * math.exp(moved.y / _PIXELS_OF_E)

    def exit(self, context, cancel):
        """Keep the focus, and key it where Blender sets keys by itself; or put it back."""
        context.area.header_text_set(None)
        if cancel:
            self._data.dof.focus_distance = self._before
        else:
            key_focus(context.scene, self._data)
            bpy.ops.ed.undo_push(message="Focus Distance")


def is_movable(camera):
    """Whether the plane of the focus can be dragged: no object, driver or library holds it."""
    return camera.data.dof.focus_object is None and not why_not_focused(camera)


class APLANAT_GGT_focus(bpy.types.GizmoGroup):
    """The planes of the scene's camera."""

    bl_idname = "APLANAT_GGT_focus"
    bl_label = "Depth of Field"
    bl_space_type = "VIEW_3D"
    bl_region_type = "WINDOW"
    bl_options = {"3D", "DEPTH_3D", "PERSISTENT", "SHOW_MODAL_ALL"}

    @classmethod
    def poll(cls, context):
        """Whether there are planes to be shown."""
        if not context.scene.aplanat.show_focus_planes:
            return False
        return context.space_data.overlay.show_overlays and shown_blur(context) is not None

    def setup(self, _context):
        """Make a gizmo for each plane."""
        for _ in range(3):
            plane = self.gizmos.new(APLANAT_GT_focus_plane.bl_idname)
            plane.use_draw_scale = False
            plane.use_draw_modal = True

    def draw_prepare(self, context):
        """Put the planes where they are now."""
        scene, blur = context.scene, shown_blur(context)
        if blur is None:
            return
        camera = scene.camera
        found = planes(context, blur)
        through_camera = context.region_data.view_perspective == "CAMERA"
        if through_camera:
            # All are the same rectangle, and nothing may hide the handle.
            found = found[:1]
        for i, plane in enumerate(self.gizmos):
            plane.hide = i >= len(found) or math.isinf(found[i][0])
            if plane.hide:
                continue
            depth, plane.color, _ = found[i]
            plane.color_highlight = plane.color
            plane.movable = i == 0 and is_movable(camera)
            plane.hide_select = not plane.movable
            plane.face_alpha = _FACE_ALPHA[i > 0]
            corners = frame_at(
                scene, camera, 2.0 * camera.data.clip_start if through_camera else depth
            )
            middle = sum(corners, Vector()) / 4.0
            half = (corners[0] - corners[2]) / 2.0
            size = Matrix.Diagonal((abs(half.x), abs(half.y), 1.0, 1.0))
            plane.matrix_basis = camera_place(camera) @ Matrix.Translation(middle) @ size


CLASSES = (APLANAT_GT_focus_plane, APLANAT_GGT_focus)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
