"""Image Editor > Sidebar > Aplanat: the captured picture through the lens, live."""

import bpy

from ...engine.refocus.scene_refocus import refocus_camera
from ...engine.shared_resources import real_lens_of
from ..jobs import live_refocus
from ..operators.refocus_operators import (
    APLANAT_OT_refocus_close,
    APLANAT_OT_refocus_open,
    APLANAT_OT_refocus_pick,
    APLANAT_OT_refocus_reload,
    APLANAT_OT_refocus_restore,
    draw_depth_pass,
    in_words_of_panel,
)
from ..operators.refocus_writing import APLANAT_OT_refocus_write
from .sentences import draw_alert, draw_sentences, letters_across


class _RefocusPanel:
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Aplanat"

    def column(self):
        """Return a column that is laid out as Blender lays out properties."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout.column()


class _OpenPanel(_RefocusPanel):
    bl_parent_id = "APLANAT_IMAGE_PT_refocus"

    @classmethod
    def poll(cls, context):
        """Whether depth layers are open."""
        return bool(context.scene.aplanat.refocus.path)


class APLANAT_IMAGE_PT_refocus(_RefocusPanel, bpy.types.Panel):
    """Refocus: which file, and whether it is shown."""

    bl_label = "Refocus"

    def draw(self, context):
        """Draw the file, and how far its picture is."""
        own, column = context.scene.aplanat.refocus, self.column()
        if not own.path:
            column.scale_y = 1.4
            column.operator(
                APLANAT_OT_refocus_open.bl_idname, text="Open Depth Layers...", icon="FILE_FOLDER"
            )
            return
        row = column.row(align=True)
        row.use_property_split = False
        row.prop(own, "path", text="")
        row.operator(APLANAT_OT_refocus_reload.bl_idname, text="", icon="FILE_REFRESH")
        row.operator(APLANAT_OT_refocus_close.bl_idname, text="", icon="X")
        if own.image is None or context.space_data.image != own.image:
            column.separator()
            text = "Show the Picture"
            column.operator(APLANAT_OT_refocus_reload.bl_idname, text=text, icon="IMAGE_DATA")
            return
        live = live_refocus.live_of(context.scene)
        if live is None:
            return
        if live.error:
            draw_alert(column, in_words_of_panel(live.error), letters_across(context))
        elif live.is_reading and live.stack is None:
            column.label(text="Reading the file...", icon="TIME")
        elif live.share is not None:
            text = "Done" if live.share == 1.0 else f"{live.share:.0%}"
            if live.is_tracing:
                text = "Tracing the lens"
            stack = live.stack
            count = len(stack.layers)
            layers = "1 layer" if count == 1 else f"{count} layers"
            text = f"{stack.width} x {stack.height}, {layers}  |  {text}"
            column.progress(text=text, factor=live.share)


class APLANAT_IMAGE_PT_refocus_focus(_OpenPanel, bpy.types.Panel):
    """Focus distance and f-number."""

    bl_label = "Focus"

    def draw(self, context):
        """Draw the settings, each with where it comes from."""
        own, column = context.scene.aplanat.refocus, self.column()
        column.use_property_decorate = True
        column.row().prop(own, "focus_from", expand=True)
        if own.focus_from == "OWN":
            row = column.row(align=True)
            row.prop(own, "focus_distance", text="Distance")
        button = column.row()
        button.scale_y = 1.2
        button.operator(APLANAT_OT_refocus_pick.bl_idname, icon="EYEDROPPER")
        column.separator()
        column.row().prop(own, "fstop_from", expand=True)
        if own.fstop_from == "OWN":
            column.prop(own, "fstop", text="Number")


class APLANAT_IMAGE_PT_refocus_lens(_OpenPanel, bpy.types.Panel):
    """Whose lens, iris, fringes and bokeh."""

    bl_label = "Lens"

    def draw(self, context):
        """Draw the camera, and in a few words what its lens does."""
        own, column = context.scene.aplanat.refocus, self.column()
        column.prop(own, "use_camera_lens")
        camera = refocus_camera(context.scene)
        shown = column.column()
        shown.active = own.use_camera_lens or "CAMERA" in (own.focus_from, own.fstop_from)
        default = context.scene.camera.name if context.scene.camera else ""
        shown.prop(own, "camera", placeholder=default)
        if own.use_camera_lens and camera is not None:
            draw_sentences(
                column, lens_in_words(camera.data), letters_across(context), "CAMERA_DATA"
            )
        column.operator(APLANAT_OT_refocus_restore.bl_idname, icon="LOOP_BACK")
        column.separator()
        column.prop(own, "samples")


class APLANAT_IMAGE_PT_refocus_depth(_RefocusPanel, bpy.types.Panel):
    """How the depth of a picture that is no capture is read."""

    bl_label = "Depth Pass"
    bl_parent_id = "APLANAT_IMAGE_PT_refocus"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        """Whether the file is, or may become, a picture with a depth pass."""
        live = live_refocus.live_of(context.scene)
        return live is None or live.is_flat or live.stack is None

    def draw(self, context):
        """Draw the settings."""
        draw_depth_pass(self.column(), context.scene.aplanat.refocus)


class APLANAT_IMAGE_PT_refocus_output(_OpenPanel, bpy.types.Panel):
    """Where pictures are written, and the buttons that do it."""

    bl_label = "Output"

    def draw(self, context):
        """Draw the file and the buttons."""
        column = self.column()
        row = column.row()
        row.use_property_split = False
        row.prop(context.scene.aplanat.refocus, "output", text="")
        row = column.row(align=True)
        row.operator_context = "INVOKE_DEFAULT"
        name = APLANAT_OT_refocus_write.bl_idname
        row.operator(name, text="Write Picture", icon="RENDER_STILL")
        row.operator(name, text="Animation", icon="RENDER_ANIMATION").animation = True


class APLANAT_IMAGE_PT_refocus_notes(_OpenPanel, bpy.types.Panel):
    """What the file cannot know, and settings that cannot be met."""

    bl_label = "Notes"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        """Whether there are any."""
        live = live_refocus.live_of(context.scene)
        return super().poll(context) and live is not None and bool(live.notes)

    def draw(self, context):
        """Draw each as a sentence."""
        column = self.column()
        for line in live_refocus.live_of(context.scene).notes:
            draw_sentences(column, in_words_of_panel(line), letters_across(context), "DOT")


def lens_in_words(camera):
    """Return in a few words what a camera's lens does to a picture.

    Parameters
    ----------
    camera : bpy.types.Camera

    Returns
    -------
    str
    """
    lens = real_lens_of(camera)
    words = [lens.prescription.name if lens else "Thin lens", _iris_in_words(camera)]
    if camera.aplanat.chromatic.use:
        words.append("fringes")
    if camera.aplanat.bokeh.use:
        words.append("bokeh")
    return ", ".join(words)


def _iris_in_words(camera):
    image, blades = camera.aplanat.bokeh.iris_image, camera.dof.aperture_blades
    if image is not None:
        return f"iris '{image.name}'"
    return f"{blades} blades" if blades > 2 else "round iris"


CLASSES = (
    APLANAT_IMAGE_PT_refocus,
    APLANAT_IMAGE_PT_refocus_focus,
    APLANAT_IMAGE_PT_refocus_lens,
    APLANAT_IMAGE_PT_refocus_depth,
    APLANAT_IMAGE_PT_refocus_output,
    APLANAT_IMAGE_PT_refocus_notes,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
