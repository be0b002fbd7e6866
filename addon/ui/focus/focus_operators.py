"""Focusing on what is under the cursor, and pulling focus between two places."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.anim_utils import action_get_channelbag_for_slot

from ...engine.focus_pick import point_under
from ...errors import AplanatError
from ...scene.camera.focusing import DISTANCE, depth_along, focus_on, key_focus, why_not_focused
from .lengths import in_units

# By the name of the choice: Blender's interpolation of the first key.
_EASINGS = {"SMOOTH": "SINE", "STRONG": "CUBIC", "LINEAR": "LINEAR"}


class _PickOperator:
    """Waits for clicks in 3D views; a subclass tells where to (`begin`), and takes the places.

    There is no `poll`: a key whose operator is refused there tells nothing.
    """

    bl_options = {"REGISTER", "UNDO"}

    def invoke(self, context, event):
        """Wait for a click if the camera can be focused."""
        if self.is_refused(context):
            return {"CANCELLED"}
        context.window.cursor_modal_set("EYEDROPPER")
        self.begin(context)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def is_refused(self, context):
        """Whether the camera cannot be focused; the user is told why."""
        why = why_not_focused(self.camera_of(context.scene), self.follow)
        if why:
            self.report({"WARNING"}, why)
        return bool(why)

    def camera_of(self, scene):
        """Return the camera that is focused, or None."""
        return scene.camera

    def modal(self, context, event):
        """Wait; views can be moved and zoomed meanwhile."""
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            self.finish(context)
            return {"CANCELLED"}
        if event.type == "Z" and (event.ctrl or event.oskey):
            # Undone or redone, there would be nothing of what the first click has noted.
            return {"RUNNING_MODAL"}
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}
        return self._take(context, event)

    def _take(self, context, event):
        view = _view_under(context.window, event.mouse_x, event.mouse_y)
        if view is None:
            # The sidebar, a header, another editor.
            return {"PASS_THROUGH"}
        if self.is_refused(context):
            # Between the clicks the camera can have been deleted.
            self.finish(context)
            return {"CANCELLED"}
        point = self.look(context, *view)
        if point is None:
            return {"RUNNING_MODAL"}
        done = self.take(context, point)
        if done != {"RUNNING_MODAL"}:
            self.finish(context)
        return done

    def look(self, context, area, region, x, y):
        """Return the place under a pixel of a view; tell the user where there is none."""
        space = area.spaces.active
        try:
            with context.temp_override(area=area, region=region):
                depsgraph = context.evaluated_depsgraph_get()
                point = point_under(depsgraph, space, region, space.region_3d, x, y)
        except AplanatError as error:
            self.report({"ERROR"}, " ".join(str(error).split()))
            return None
        if point is None:
            self.report({"WARNING"}, "There is nothing at this place; the focus stays")
        elif depth_along(self.camera_of(context.scene), point) <= 0.0:
            self.report({"WARNING"}, "This place is behind the camera; the focus stays")
            return None
        return point

    def cancel(self, context):
        """Leave the window as it was when Blender ends or opens another file."""
        self.finish(context)

    def finish(self, context):
        """Leave the window as it was."""
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)
        self.show_again()

    def show_again(self):
        """Show what was shown before the first click; a subclass that changes it says how."""


def _view_under(window, x, y):
    """Return area, region and pixel of the 3D view under a place of a window, or None."""
    for area in window.screen.areas:
        if area.type != "VIEW_3D":
            continue
        inside = [
            region
            for region in area.regions
            if region.x <= x < region.x + region.width
            and region.y <= y < region.y + region.height
            and region.width > 1
        ]
        # Others lie over that of the view.
        if inside and all(region.type == "WINDOW" for region in inside):
            return area, inside[0], x - inside[0].x, y - inside[0].y
    return None


class APLANAT_OT_focus_pick(_PickOperator, bpy.types.Operator):
    """Focus the scene's camera on what is clicked in a 3D view."""

    bl_idname = "view3d.aplanat_focus_pick"
    bl_label = "Pick Focus"
    bl_description = (
        "Click on what the scene's camera is to focus on, in any 3D view. A camera that follows a"
        " focus object goes on following it, from the place that is clicked"
    )

    follow: BoolProperty(
        name="Follow Focus Object",
        description="Go on following the focus object, if there is one, from the place that was"
        " picked; without this the camera keeps the distance",
        default=True,
    )
    point: bpy.props.FloatVectorProperty(
        name="Place", description="In focus, in world space", subtype="XYZ", unit="LENGTH"
    )
    at_cursor: BoolProperty(
        name="At Cursor",
        description="Focus on what is under the mouse at once, without a click",
        options={"SKIP_SAVE", "HIDDEN"},
    )

    def invoke(self, context, event):
        """Take what is under the mouse, or wait for a click."""
        if not self.at_cursor:
            return super().invoke(context, event)
        if self.is_refused(context):
            return {"CANCELLED"}
        view = _view_under(context.window, event.mouse_x, event.mouse_y)
        point = view and self.look(context, *view)
        return {"CANCELLED"} if point is None else self.take(context, point)

    def begin(self, context):
        """Tell what to click on."""
        context.workspace.status_text_set("Click: focus there  |  Esc, right mouse button: cancel")

    def take(self, context, point):
        """Focus there."""
        self.point = point
        return self.execute(context)

    def execute(self, context):
        """Focus on the place; a key is set where Blender sets keys by itself."""
        scene = context.scene
        camera = scene.camera
        try:
            distance = focus_on(scene, camera, self.point, self.follow)
        except AplanatError as error:
            self.report({"WARNING"}, str(error))
            return {"CANCELLED"}
        key_focus(scene, camera.data)
        self.report({"INFO"}, f"'{camera.name}' focuses at {in_units(scene, distance)}")
        return {"FINISHED"}


class APLANAT_OT_focus_pull(_PickOperator, bpy.types.Operator):
    """Key a focus pull between two places."""

    bl_idname = "view3d.aplanat_focus_pull"
    bl_label = "Focus Pull"
    bl_description = (
        "Click on what is in focus now, then on what is in focus when the pull ends: the focus"
        " distance gets a keyframe for each. The second place is picked in the frame in which the"
        " pull ends. The camera no longer follows a focus object"
    )

    start: IntProperty(name="Start", description="Frame in which the pull begins")
    length: IntProperty(name="Frames", description="Frames that it takes", default=24, min=1)
    easing: EnumProperty(
        name="Easing",
        description="How the pull begins and ends",
        items=(
            ("SMOOTH", "Smooth", "Begin and end slowly"),
            ("STRONG", "Strong", "Rest long at both ends, and pass quickly between them"),
            ("LINEAR", "Linear", "At the same speed all the time"),
        ),
    )
    first: FloatProperty(name="From", description="First distance", unit="LENGTH", min=0.0)
    second: FloatProperty(name="To", description="Second distance", unit="LENGTH", min=0.0)
    camera: StringProperty(
        name="Camera",
        description="Whose focus is pulled, with its library; empty: the scene's camera",
        options={"SKIP_SAVE", "HIDDEN"},
    )
    # The keys are of the camera's own distance.
    follow = False

    def camera_of(self, scene):
        """Return the camera of the first click: markers may show another one in the last frame."""
        if not self.camera:
            return scene.camera
        return next((obj for obj in scene.objects if obj.name_full == self.camera), None)

    def begin(self, context):
        """Tell what to click on first."""
        scene = context.scene
        self._before = scene.name_full, scene.frame_current, scene.frame_subframe
        self.start = scene.frame_current
        self.camera = scene.camera.name_full
        self.first = self.second = 0.0
        self._tell(context, "in focus when the pull begins", self.start)

    def take(self, context, point):
        """Take the first distance and show the last frame, or take the second."""
        scene = context.scene
        camera = self.camera_of(scene)
        distance = depth_along(camera, point)
        if not self.first:
            self.first = distance
            end = self.start + self.length
            _show(scene, end, 0.0, camera)
            self._tell(context, "in focus when it ends", end)
            return {"RUNNING_MODAL"}
        self.second = distance
        return self.execute(context)

    def _tell(self, context, what, frame):
        context.workspace.status_text_set(
            f"Click on what is {what}, frame {frame}  |  Esc, right mouse button: cancel"
        )

    def show_again(self):
        """Show the frame and the camera of before."""
        name, frame, subframe = self._before
        scene = next((found for found in bpy.data.scenes if found.name_full == name), None)
        if scene is not None:
            _show(scene, frame, subframe, self.camera_of(scene))

    def execute(self, context):
        """Set the two keys."""
        if not (self.first > 0.0 and self.second > 0.0):
            self.report({"WARNING"}, "A focus pull needs two distances in front of the camera")
            return {"CANCELLED"}
        if self.is_refused(context):
            return {"CANCELLED"}
        scene = context.scene
        camera = self.camera_of(scene).data
        dof = camera.dof
        let_go, dof.focus_object = dof.focus_object, None
        dof.use_dof = True
        end = self.start + self.length
        for distance, frame in ((self.first, self.start), (self.second, end)):
            dof.focus_distance = distance
            camera.keyframe_insert(DISTANCE, frame=frame)
        self._ease(camera)
        _show(scene, scene.frame_current, scene.frame_subframe, scene.camera)
        told = " to ".join(in_units(scene, d) for d in (self.first, self.second))
        gone = f"; '{let_go.name}' is no longer followed" if let_go else ""
        self.report({"INFO"}, f"Focus pull from {told}, frames {self.start} to {end}{gone}")
        return {"FINISHED"}

    def _ease(self, camera):
        animation = camera.animation_data
        bag = action_get_channelbag_for_slot(animation.action, animation.action_slot)
        for key in bag.fcurves.find(DISTANCE).keyframe_points:
            # Keys before and behind the pull stay as they are.
            if self.start <= key.co.x < self.start + self.length:
                key.interpolation = _EASINGS[self.easing]
                key.easing = "EASE_IN_OUT"


def _show(scene, frame, subframe, camera):
    """Show a frame through a camera, whatever markers say; without one, through theirs."""
    scene.frame_set(frame, subframe=subframe)
    if camera is not None:
        scene.camera = camera


CLASSES = (APLANAT_OT_focus_pick, APLANAT_OT_focus_pull)

_register, _unregister = bpy.utils.register_classes_factory(CLASSES)
# Free in Blender's own keys of the 3D view.
_KEY = {"type": "F", "value": "PRESS", "shift": True, "ctrl": True}


def _keymap():
    # In the background there are no key configurations of add-ons.
    keys = bpy.context.window_manager.keyconfigs.addon
    return keys and keys.keymaps.new("3D View", space_type="VIEW_3D")


def register():
    """Register the operators, and the key that focuses on what is under the mouse."""
    _register()
    if keymap := _keymap():
        item = keymap.keymap_items.new(APLANAT_OT_focus_pick.bl_idname, **_KEY)
        item.properties.at_cursor = True


def unregister():
    """Undo `register`."""
    if keymap := _keymap():
        for item in list(keymap.keymap_items):
            if item.idname == APLANAT_OT_focus_pick.bl_idname:
                keymap.keymap_items.remove(item)
    _unregister()
