"""Operators of the refocused picture: open and close a capture, read it again, pick the focus."""

import math
from pathlib import Path

import bpy

from ...engine.refocus.scene_refocus import as_sequence, flat_options, refocus_camera
from ...errors import AplanatError
from ...files.frame_path import frame_path
from ...layers.picking import depth_at
from ..jobs import live_refocus
from .restored_lens import restore_lens

# What the command line calls a setting, and what the panel does.
_WORDS = (
    ("--depth-range NEAR,FAR", "Depth Pass > Values: Normalized"),
    ("--depth-scale 1", "Depth Pass > Values: Scaled"),
    ("--depth-channel", "Depth Pass > Depth Channel"),
    ("--color-layer", "Depth Pass > Color Layer"),
)


def in_words_of_panel(text):
    """Return a message in one line, with settings called as the panel calls them.

    Parameters
    ----------
    text : str

    Returns
    -------
    str
    """
    for option, name in _WORDS:
        text = text.replace(option, name)
    return " ".join(text.split())


def draw_depth_pass(layout, own):
    """Draw the settings of pictures with a depth pass.

    Parameters
    ----------
    layout : bpy.types.UILayout
    own : AplanatRefocusSettings
    """
    column = layout.column()
    column.prop(own, "depth_values")
    if own.depth_values == "SCALED":
        column.prop(own, "depth_scale")
    elif own.depth_values == "NORMALISED":
        column.prop(own, "depth_near")
        column.prop(own, "depth_far")
    column.prop(own, "use_inverted_depth")
    column.prop(own, "use_ray_depth")
    column = layout.column()
    column.prop(own, "depth_channel")
    column.prop(own, "color_layer")


class APLANAT_OT_refocus_open(bpy.types.Operator):
    """Open captured depth layers, and see them through the lens."""

    bl_idname = "image.aplanat_refocus_open"
    bl_label = "Open Depth Layers"
    bl_description = (
        "Open captured depth layers, or an EXR picture with a depth pass, and see it through the"
        " lens in the Image editor"
    )
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(subtype="FILE_PATH", options={"SKIP_SAVE"})
    filter_glob: bpy.props.StringProperty(default="*.exr", options={"HIDDEN"})
    relative_path: bpy.props.BoolProperty(
        name="Relative Path",
        description="Select the file relative to the blend file",
        default=True,
    )
    use_sequence: bpy.props.BoolProperty(
        name="Detect Sequences",
        description="Where there are captures of several frames, show that of the scene's frame",
        default=True,
    )

    @classmethod
    def poll(cls, context):
        """Whether there is a scene."""
        return context.scene is not None

    def invoke(self, context, _event):
        """Ask for the file."""
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def draw(self, context):
        """Draw the options beside the files."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "relative_path")
        layout.prop(self, "use_sequence")
        layout.separator()
        layout.label(text="Pictures with a Depth Pass")
        draw_depth_pass(layout, context.scene.aplanat.refocus)

    def execute(self, context):
        """Read the file; nothing changes if it cannot be used."""
        scene, path = context.scene, Path(bpy.path.abspath(self.filepath))
        flat = flat_options(scene)
        try:
            stack, is_flat = live_refocus.read_file(path, flat)
        except AplanatError as error:
            self.report({"ERROR"}, in_words_of_panel(str(error)))
            return {"CANCELLED"}
        own = scene.aplanat.refocus
        pattern = self._pattern(path, scene)
        own.path = str(pattern)
        if self.relative_path and bpy.data.filepath:
            own.path = bpy.path.relpath(str(pattern))
        own.focus_distance = stack.camera.focus_distance
        own.fstop = stack.camera.f_stop
        own.image = live_refocus.make_image(own.image, stack.width, stack.height)
        space = context.space_data
        if space is not None and space.type == "IMAGE_EDITOR":
            space.image = own.image
        if not bpy.app.background:
            shown = frame_path(pattern, scene.frame_current)
            live_refocus.begin(scene).take(shown, flat, stack, is_flat)
        for line in stack.report if is_flat else ():
            self.report({"INFO"}, line)
        return {"FINISHED"}

    def _pattern(self, path, scene):
        if not self.use_sequence:
            return path
        pattern = as_sequence(path)
        if frame_path(pattern, scene.frame_current) == path:
            return pattern
        if pattern != path:
            self.report(
                {"WARNING"},
                f"'{path.name}' is not of frame {scene.frame_current}: opened as a still",
            )
        return path


class APLANAT_OT_refocus_close(bpy.types.Operator):
    """Close the captured depth layers, and remove the image that shows them."""

    bl_idname = "image.aplanat_refocus_close"
    bl_label = "Close Depth Layers"
    bl_description = "Close the depth layers, and remove the image that shows them"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        """Whether there are any."""
        return bool(context.scene and context.scene.aplanat.refocus.path)

    def execute(self, context):
        """Close."""
        own = context.scene.aplanat.refocus
        image, own.image, own.path = own.image, None, ""
        if image is not None:
            for screen in bpy.data.screens:
                for area in screen.areas:
                    for space in area.spaces:
                        if space.type == "IMAGE_EDITOR" and space.image == image:
                            space.image = None
            # Somebody else may have found a use for it.
            if image.users == 0:
                bpy.data.images.remove(image)
        live_refocus.wake()
        return {"FINISHED"}


class APLANAT_OT_refocus_reload(bpy.types.Operator):
    """Read the file again."""

    bl_idname = "image.aplanat_refocus_reload"
    bl_label = "Reload Depth Layers"
    bl_description = "Read the depth layers from their file again, and show them"

    @classmethod
    def poll(cls, context):
        """Whether there are any."""
        return bool(context.scene and context.scene.aplanat.refocus.path)

    def execute(self, context):
        """Forget what was read, and bring the image back if it is gone."""
        scene = context.scene
        own = scene.aplanat.refocus
        if own.image is None:
            own.image = live_refocus.make_image(None, 1, 1)
        if context.space_data is not None and context.space_data.type == "IMAGE_EDITOR":
            context.space_data.image = own.image
        live = live_refocus.live_of(scene)
        if live is not None:
            live.forget_file()
        live_refocus.wake()
        return {"FINISHED"}


class APLANAT_OT_refocus_pick(bpy.types.Operator):
    """Focus on what is clicked in the image."""

    bl_idname = "image.aplanat_refocus_pick"
    bl_label = "Pick Focus"
    bl_description = (
        "Click on what is to be in focus: the foremost layer that covers the place sets the focus"
        " distance. Esc or the right mouse button cancels"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        """Whether a window shows a picture."""
        live = context.scene and live_refocus.live_of(context.scene)
        if not live or live.stack is None:
            cls.poll_message_set("No depth layers are shown")
            return False
        return True

    def invoke(self, context, _event):
        """Wait for the click."""
        context.window.cursor_modal_set("EYEDROPPER")
        self._tell(context, None)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        """Follow the mouse; views can be moved and zoomed meanwhile."""
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            self._finish(context)
            return {"CANCELLED"}
        if event.type == "MOUSEMOVE":
            self._tell(context, depth_under(context, event.mouse_x, event.mouse_y))
            return {"PASS_THROUGH"}
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}
        depth = depth_under(context, event.mouse_x, event.mouse_y)
        self._finish(context)
        if depth is None or not math.isfinite(depth):
            what = "nothing" if depth is None else "only the world, infinitely far away"
            self.report({"WARNING"}, f"There is {what} at this place; the focus stays")
            return {"CANCELLED"}
        set_focus(context.scene, depth)
        return {"FINISHED"}

    def cancel(self, context):
        """Leave the window as it was when Blender ends or opens another file."""
        self._finish(context)

    def _tell(self, context, depth):
        where = ""
        if depth is not None and math.isfinite(depth):
            system = context.scene.unit_settings
            length = depth * system.scale_length
            name = "METRIC" if system.system == "NONE" else system.system
            unit = bpy.utils.units.to_string(name, "LENGTH", length, precision=3)
            where = f"  |  {unit} away"
        context.workspace.status_text_set(
            f"Click: focus there  |  Esc, right mouse button: cancel{where}"
        )

    def _finish(self, context):
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)


class APLANAT_OT_refocus_restore(bpy.types.Operator):
    """Give focus, f-number and the camera's lens the values of the capture."""

    bl_idname = "image.aplanat_refocus_restore"
    bl_label = "Restore as Captured"
    bl_description = (
        "Set focus and f-number to what they were when the layers were captured, and lens, iris,"
        " fringes and bokeh of the camera, too, if its lens is used"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        """Whether a window shows a picture."""
        return APLANAT_OT_refocus_pick.poll(context)

    def execute(self, context):
        """Set them."""
        scene = context.scene
        own, captured = scene.aplanat.refocus, live_refocus.live_of(scene).stack.camera
        own.focus_from = own.fstop_from = "OWN"
        own.focus_distance, own.fstop = captured.focus_distance, captured.f_stop
        camera = refocus_camera(scene)
        if own.use_camera_lens and camera is not None:
            try:
                added = restore_lens(captured, camera.data)
            except AplanatError as error:
                self.report({"WARNING"}, str(error))
            else:
                if added:
                    self.report({"INFO"}, f"Lens '{added}' is in your library now")
        live_refocus.wake()
        return {"FINISHED"}


def depth_under(context, mouse_x, mouse_y):
    """Return the depth of what an Image editor shows under the mouse.

    Parameters
    ----------
    context : bpy.types.Context
    mouse_x, mouse_y : int
        In pixels of the window.

    Returns
    -------
    float or None
        As `depth_at`; None where no editor shows the scene's refocused picture.
    """
    scene = context.scene
    live = live_refocus.live_of(scene)
    if live is None or live.stack is None:
        return None
    for window, area in live_refocus.shown(scene):
        region = next((region for region in area.regions if region.type == "WINDOW"), None)
        x, y = mouse_x - region.x, mouse_y - region.y
        if window != context.window or not (0 <= x < region.width and 0 <= y < region.height):
            continue
        across, up = region.view2d.region_to_view(x + 0.5, y + 0.5)
        return depth_at(live.stack, across * live.stack.width, up * live.stack.height)
    return None


def set_focus(scene, distance):
    """Focus a scene's refocused picture at a distance.

    Parameters
    ----------
    scene : bpy.types.Scene
    distance : float
        In m along the optical axis.
    """
    own = scene.aplanat.refocus
    own.focus_from, own.focus_distance = "OWN", distance
    if scene.tool_settings.use_keyframe_insert_auto:
        own.keyframe_insert("focus_distance")
    live_refocus.wake()


def _draw_menu(self, _context):
    layout = self.layout
    layout.separator()
    layout.operator_context = "INVOKE_DEFAULT"
    layout.operator(APLANAT_OT_refocus_open.bl_idname, text="Open Depth Layers...")
    layout.operator(APLANAT_OT_refocus_pick.bl_idname)


CLASSES = (
    APLANAT_OT_refocus_open,
    APLANAT_OT_refocus_close,
    APLANAT_OT_refocus_reload,
    APLANAT_OT_refocus_pick,
    APLANAT_OT_refocus_restore,
)

_register, _unregister = bpy.utils.register_classes_factory(CLASSES)


def register():
    """Register the operators, and put two into the Image menu."""
    _register()
    bpy.types.IMAGE_MT_image.append(_draw_menu)


def unregister():
    """Undo `register`."""
    bpy.types.IMAGE_MT_image.remove(_draw_menu)
    _unregister()
