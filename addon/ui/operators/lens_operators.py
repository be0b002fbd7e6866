"""Operators on the lens of a camera and on the library of lenses."""

import math

import bpy
from bpy.props import BoolProperty, StringProperty

from ...engine.shared_resources import real_lens_of, shelf
from ...errors import AplanatError
from ...lens_io import user_lenses
from ...optics.lens_facts import lens_facts, squeeze
from ...scene.camera.lenses import user_folder
from ..jobs import background
from .text_editor import show_text

# Blender's limit of `aperture_blades`.
_MOST_BLADES = 16


def camera_of(context):
    """Return the camera data that a user means: that of the editor, the object or the scene.

    Parameters
    ----------
    context : bpy.types.Context

    Returns
    -------
    bpy.types.Camera or None
    """
    camera = getattr(context, "camera", None)
    if camera is not None:
        return camera
    for obj in (context.object, context.scene.camera):
        if obj is not None and obj.type == "CAMERA":
            return obj.data
    return None


def refresh_cameras(lens_ids=None):
    """Make viewports update the cameras that use certain lenses.

    Parameters
    ----------
    lens_ids : collection of str or None
        None: all cameras with a lens.
    """
    for camera in bpy.data.cameras:
        lens = camera.aplanat.lens
        if lens and (lens_ids is None or lens in lens_ids):
            camera.update_tag()


class CameraOperator:
    """Needs a camera that may be changed."""

    @classmethod
    def poll(cls, context):
        """Whether there is a camera that may be changed."""
        camera = camera_of(context)
        if camera is None:
            cls.poll_message_set("There is no camera; add one or select one")
            return False
        if not camera.is_editable:
            cls.poll_message_set("The camera is linked; make a library override of it")
            return False
        return True


class _LensOperator(CameraOperator):
    @classmethod
    def poll(cls, context):
        """Whether the camera has a lens that can be used."""
        if not super().poll(context):
            return False
        lens = real_lens_of(camera_of(context))
        if lens is None:
            cls.poll_message_set("The camera has no real lens that can be used")
            return False
        return True


class APLANAT_OT_choose_lens(CameraOperator, bpy.types.Operator):
    """Give the camera a lens."""

    bl_idname = "camera.aplanat_choose_lens"
    bl_label = "Choose Lens"
    bl_description = "Give the camera this lens. Its focal length stays as it is"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    lens: StringProperty(
        name="Lens", description="Name in the library; empty for a thin lens", options=set()
    )

    @classmethod
    def description(cls, _context, properties):
        """Return the whole name of the lens, with what a click does."""
        found = shelf().find(properties.lens) if properties.lens else None
        return f"{found.title if found else 'Thin lens'}. {cls.bl_description}"

    def execute(self, context):
        """Set the name."""
        camera_of(context).aplanat.lens = self.lens
        return {"FINISHED"}


class APLANAT_OT_use_focal_length(_LensOperator, bpy.types.Operator):
    """Give the camera the focal length of its lens."""

    bl_idname = "camera.aplanat_use_focal_length"
    bl_label = "Use Lens Focal Length"
    bl_description = "Set the camera's focal length to that of its real lens; this changes framing"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        """Set the focal length."""
        camera = camera_of(context)
        lens = real_lens_of(camera)
        camera.lens = lens_facts(lens.prescription, lens.label).focal_length
        self.report({"INFO"}, f"The camera's focal length is {camera.lens:.4g} mm")
        return {"FINISHED"}


class APLANAT_OT_match_zoom(_LensOperator, bpy.types.Operator):
    """Zoom the lens to the camera."""

    bl_idname = "camera.aplanat_match_zoom"
    bl_label = "Match Zoom to Camera"
    bl_description = "Choose the zoom position nearest to the camera's focal length"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        """Whether the lens is a zoom lens."""
        if not super().poll(context):
            return False
        lens = real_lens_of(camera_of(context))
        if lens.label is None:
            cls.poll_message_set("The lens is not a zoom lens")
            return False
        return True

    def execute(self, context):
        """Set the zoom position."""
        camera = camera_of(context)
        lens = real_lens_of(camera)
        prescription = lens.prescription
        camera.aplanat.zoom_label = min(
            prescription.labels,
            key=lambda label: abs(
                math.log(lens_facts(prescription, label).focal_length / camera.lens)
            ),
        )
        return {"FINISHED"}


class APLANAT_OT_use_iris(_LensOperator, bpy.types.Operator):
    """Give the camera the iris of its lens."""

    bl_idname = "camera.aplanat_use_iris"
    bl_label = "Use Lens Iris"
    bl_description = (
        "Set blades of the camera's iris, their curvature, rotation and ratio to those of its real"
        " lens"
    )
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        """Set blades, curvature, rotation and ratio."""
        camera = camera_of(context)
        lens = real_lens_of(camera)
        iris = lens.prescription.diaphragm
        dof = camera.dof
        dof.aperture_blades = min(iris.blades, _MOST_BLADES)
        dof.aperture_rotation = math.remainder(math.radians(iris.rotation_deg), math.tau)
        dof.aperture_ratio = squeeze(lens.prescription, lens.label)
        camera.aplanat.bokeh.blade_curvature = iris.blade_curvature
        if iris.blades > _MOST_BLADES:
            self.report({"INFO"}, f"The iris has {iris.blades} blades; Blender allows 16")
        return {"FINISHED"}


class APLANAT_OT_reload_lenses(bpy.types.Operator):
    """Read the library of lenses again."""

    bl_idname = "wm.aplanat_reload_lenses"
    bl_label = "Reload Lenses"
    bl_description = "Look for new lens files, and read those again that have changed"
    bl_options = {"REGISTER"}

    def execute(self, _context):
        """Read new and changed lens files."""
        found = shelf().reload()
        background.resume()
        refresh_cameras({*found.added, *found.removed, *found.changed})
        parts = [
            f"{len(ids)} {what}"
            for what in ("added", "removed", "changed")
            if (ids := getattr(found, what))
        ]
        self.report({"INFO"}, f"{len(shelf().ids())} lenses: {', '.join(parts) or 'no changes'}")
        return {"FINISHED"}


class _FileOperator:
    """Works on the file of the camera's lens."""

    @classmethod
    def poll(cls, context):
        """Whether the camera names a lens of the library."""
        camera = camera_of(context)
        if camera is None or not camera.aplanat.lens:
            cls.poll_message_set("The camera has no real lens")
            return False
        if shelf().find(camera.aplanat.lens) is None:
            cls.poll_message_set("The lens is not in the library")
            return False
        return True


class APLANAT_OT_edit_lens(_FileOperator, bpy.types.Operator):
    """Open the file of the lens in the text editor."""

    bl_idname = "camera.aplanat_edit_lens"
    bl_label = "Edit Lens File"
    bl_description = (
        "Open the lens file in the text editor. Of a lens that came with Aplanat a copy of your own"
        " is made, which the camera then uses. Save the text, then reload the lenses"
    )
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        """Open the file, or a copy."""
        camera = camera_of(context)
        found = shelf().find(camera.aplanat.lens)
        path = found.path
        if found.shipped:
            if not camera.is_editable:
                self.report({"ERROR"}, "The camera is linked: it cannot use a copy of this lens")
                return {"CANCELLED"}
            try:
                copy = user_lenses.copy_into(user_folder(), path, shelf().ids())
            except AplanatError as error:
                self.report({"ERROR"}, _one_line(error))
                return {"CANCELLED"}
            shelf().reload()
            camera.aplanat.lens, path = copy.id, copy.path
            self.report({"INFO"}, f"Made a copy to edit: '{copy.name}'")
        show_text(context, path)
        return {"FINISHED"}


class APLANAT_OT_remove_lens(_FileOperator, bpy.types.Operator):
    """Delete the file of a lens of the user's own."""

    bl_idname = "camera.aplanat_remove_lens"
    bl_label = "Remove Lens"
    bl_description = "Delete the file of this lens from your folder; this cannot be undone"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context):
        """Whether the lens is one of the user's own."""
        if not super().poll(context):
            return False
        if shelf().find(camera_of(context).aplanat.lens).path.parent != user_folder():
            cls.poll_message_set("Only lenses of your own folder can be removed")
            return False
        return True

    def invoke(self, context, event):
        """Ask first."""
        found = shelf().find(camera_of(context).aplanat.lens)
        return context.window_manager.invoke_confirm(
            self,
            event,
            title=f"Delete '{found.name}'?",
            message="The file is deleted. Cameras that use it are drawn with a thin lens.",
            confirm_text="Delete",
            icon="WARNING",
        )

    def execute(self, context):
        """Delete the file."""
        found = shelf().find(camera_of(context).aplanat.lens)
        try:
            user_lenses.remove(found.path)
        except AplanatError as error:
            self.report({"ERROR"}, _one_line(error))
            return {"CANCELLED"}
        shelf().reload()
        refresh_cameras({found.id})
        self.report({"INFO"}, f"Deleted {found.path.name}")
        return {"FINISHED"}


class APLANAT_OT_background_work(bpy.types.Operator):
    """Stop the work in the background, or let it go on."""

    bl_idname = "wm.aplanat_background_work"
    bl_label = "Lens Pictures and Tables"
    bl_description = "Stop making pictures and tables of lenses, or go on with it"
    bl_options = {"INTERNAL"}

    stop: BoolProperty(
        name="Stop", description="Stop, instead of going on", default=True, options=set()
    )

    def execute(self, _context):
        """Stop or go on."""
        if self.stop:
            background.stop()
        else:
            background.resume()
        return {"FINISHED"}


def _one_line(error):
    return " ".join(str(error).split())


CLASSES = (
    APLANAT_OT_choose_lens,
    APLANAT_OT_use_focal_length,
    APLANAT_OT_match_zoom,
    APLANAT_OT_use_iris,
    APLANAT_OT_reload_lenses,
    APLANAT_OT_edit_lens,
    APLANAT_OT_remove_lens,
    APLANAT_OT_background_work,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
