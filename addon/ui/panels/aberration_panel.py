"""Camera > Lens > Aberrations: those of a lens without a prescription, by their strengths."""

import bpy

from ..previews.aberration_previews import ABERRATIONS, aberration_icons
from .panel_bases import CameraPanel, PresetsHeader
from .sentences import draw_sentences, letters_across

# In units of Blender's buttons.
_SPOT_SCALE = 2.5


class APLANAT_CAMERA_PT_aberrations(CameraPanel, PresetsHeader, bpy.types.Panel):
    """Spherical aberration, coma, astigmatism, field curvature and swirl of a thin lens."""

    bl_label = "Aberrations"
    bl_parent_id = "DATA_PT_lens"
    bl_options = {"DEFAULT_CLOSED"}
    presets = "aberrations"

    def draw(self, context):
        """Draw each strength beside what it does in the middle and in the corner."""
        camera, letters = context.camera, letters_across(context)
        settings, column = camera.aplanat, self.column()
        column.use_property_decorate = True
        used = not settings.lens and camera.type == "PERSP"
        column.active = used and camera.dof.use_dof
        for name in ABERRATIONS:
            row = column.row()
            # Beside two pictures a name has room in the field alone.
            row.use_property_split = False
            text = "Curvature" if name == "field_curvature" else None
            row.prop(settings, name, text=text, slider=name == "swirl")
            middle, corner = aberration_icons(camera, name)
            row.template_icon(icon_value=middle, scale=_SPOT_SCALE)
            row.template_icon(icon_value=corner, scale=_SPOT_SCALE)
        if settings.lens:
            text = "The real lens has its own aberrations; these are a thin lens'."
        elif camera.type != "PERSP":
            text = "They need a perspective camera."
        elif not camera.dof.use_dof:
            text = "They are seen with Depth of Field only."
        else:
            text = "A point behind the focus, in the middle of the picture and at its corner."
        draw_sentences(column, text, letters, icon="INFO")


CLASSES = (APLANAT_CAMERA_PT_aberrations,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
