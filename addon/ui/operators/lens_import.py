"""Importing a lens file into the user's folder, from the file browser."""

import math

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from ...engine.shared_resources import shelf
from ...errors import AplanatError
from ...lens_io import user_lenses
from ...scene.camera.lenses import user_folder
from .lens_operators import camera_of

# How messages of the importers name an option, and how the side panel of the dialog does.
_OPTION_NAMES = {
    "--thickness before|after": "Thickness in the options",
    "--stop N": "Stop in the options",
    "--radii radius|curvature": "Surfaces in the options",
    "--f-number X": "F-Number in the options",
    "--half-field DEG": "Half Field in the options",
    "--glass NAME=ND,VD": "Glasses in the options as NAME=ND,VD",
}


class APLANAT_OT_import_lens(bpy.types.Operator, ImportHelper):
    """Import a lens file."""

    bl_idname = "camera.aplanat_import_lens"
    bl_label = "Import Lens"
    bl_description = (
        "Read a lens file (Aplanat, Zemax, CODE V, pbrt or optical bench) and add it to your lenses"
    )
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(
        default="*.toml;*.zmx;*.seq;*.dat;*.txt", options={"HIDDEN", "SKIP_SAVE"}
    )
    use_for_camera: BoolProperty(
        name="Use for Camera",
        description="Give the lens to the camera",
        default=True,
    )
    thickness: EnumProperty(
        name="Thickness",
        description="pbrt: where the distances of a row belong, if the file leaves it open",
        items=(
            ("FILE", "As the File Tells", "Refuse a file that does not tell"),
            ("BEFORE", "Before", "A row tells the distance before its surface"),
            ("AFTER", "After", "A row tells the distance behind its surface"),
        ),
        default="FILE",
    )
    radii: EnumProperty(
        name="Surfaces",
        description="CODE V: what the first number of a surface is, if the file leaves it open",
        items=(
            ("FILE", "As the File Tells", "Refuse a file that does not tell"),
            ("RADIUS", "Radius", "Radius of curvature"),
            ("CURVATURE", "Curvature", "One over the radius"),
        ),
        default="FILE",
    )
    stop: IntProperty(
        name="Stop",
        description="Number of the stop in the file, from 1, if the file does not tell; 0: it does",
        default=0,
        min=0,
        soft_max=100,
        max=1000,
    )
    f_number: FloatProperty(
        name="F-Number",
        description="Wide open, if the file tells no aperture; 0: it does",
        default=0.0,
        min=0.0,
        soft_max=32.0,
        max=1000.0,
        precision=2,
    )
    half_field: FloatProperty(
        name="Half Field",
        description="Largest angle from the axis, if the file tells no field; 0: it does",
        default=0.0,
        min=0.0,
        max=1.5690,
        subtype="ANGLE",
        unit="ROTATION",
    )
    glasses: StringProperty(
        name="Glasses",
        description="Glasses that are in no catalogue, as NAME=ND,VD, separated by blanks",
        default="",
    )
    camera_name: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def invoke(self, context, event):
        """Open the file browser."""
        camera = camera_of(context)
        self.camera_name = camera.name if camera is not None and camera.is_editable else ""
        return super().invoke(context, event)

    def draw(self, _context):
        """Draw the options at the side of the file browser."""
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        row = layout.row()
        row.active = bool(self.camera_name)
        row.prop(self, "use_for_camera")
        header, body = layout.panel("APLANAT_import_lens_open", default_closed=False)
        header.label(text="If the File Leaves It Open")
        if body is not None:
            for name in ("thickness", "radii", "stop", "f_number", "half_field", "glasses"):
                body.prop(self, name)

    def execute(self, context):
        """Convert the file and add it."""
        try:
            added = user_lenses.import_into(
                user_folder(), self.filepath, shelf().ids(), self._options()
            )
        except AplanatError as error:
            self.report({"ERROR"}, _in_words_of_the_dialog(error))
            return {"CANCELLED"}
        shelf().reload()
        for line in (*added.ignored, *(finding.message for finding in added.warnings)):
            self.report({"INFO"}, f"{added.id}: {line}")
        camera = bpy.data.cameras.get(self.camera_name) if self.camera_name else camera_of(context)
        if self.use_for_camera and camera is not None and camera.is_editable:
            camera.aplanat.lens = added.id
        notes = [
            f"{len(lines)} {what}"
            for what, lines in (("not read", added.ignored), ("warnings", added.warnings))
            if lines
        ]
        more = f" ({', '.join(notes)}: see the Info editor)" if notes else ""
        self.report({"WARNING" if notes else "INFO"}, f"Imported '{added.name}'{more}")
        return {"FINISHED"}

    def _options(self):
        from ...lens_io.importers.draft.options import ImportOptions, glass_option

        return ImportOptions(
            thickness=None if self.thickness == "FILE" else self.thickness.lower(),
            stop=self.stop or None,
            radii=None if self.radii == "FILE" else self.radii.lower(),
            f_number=self.f_number or None,
            half_field_deg=math.degrees(self.half_field) or None,
            glasses=dict(glass_option(text) for text in self.glasses.split()),
        )


def _in_words_of_the_dialog(error):
    message = " ".join(str(error).split())
    for words, name in _OPTION_NAMES.items():
        message = message.replace(f"with {words}", f"with {name}").replace(words, name)
    return message


CLASSES = (APLANAT_OT_import_lens,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
