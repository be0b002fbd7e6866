"""Camera > Chromatic Aberration: strengths, glass, field maps, and the spectral equalizer."""

import bpy

from ...engine.shared_resources import real_lens_of
from ...scene.camera.chromatic import describe_chromatic, read_field_map
from ...scene.camera.drawn_curves import EQUALIZER, MAP_CURVES, find_mapping
from ..operators.chromatic_operators import APLANAT_OT_make_curves
from ..previews import chromatic_previews
from ..previews.spectrum_bar import draw_spectrum
from .panel_bases import CameraPanel, PresetsHeader, SwitchHeader
from .sentences import draw_alert, draw_sentences, letters_across

# In units of Blender's buttons.
_MAP_SCALE = 7.0


class _ChromaticPanel(CameraPanel):
    group = "chromatic"


class APLANAT_CAMERA_PT_chromatic(_ChromaticPanel, SwitchHeader, PresetsHeader, bpy.types.Panel):
    """Strength, glass and mode of the chromatic aberration."""

    bl_label = "Chromatic Aberration"
    bl_options = {"DEFAULT_CLOSED"}
    presets = "chromatic"

    def draw(self, context):
        """Draw the settings, and warnings about those that cannot be met."""
        settings, column = self.begin(context)
        column.row().prop(settings, "mode", expand=True)
        strengths = column.column(align=True)
        strengths.prop(settings, "axial")
        strengths.prop(settings, "lateral")
        column.row().prop(settings, "dispersion", expand=True)
        if settings.dispersion == "GLASS":
            glass = column.row()
            glass.use_property_decorate = False
            glass.prop(settings, "glass", icon="MATERIAL")
            column.prop(settings, "focus_light")
        if settings.mode == "SPECTRAL":
            wavelengths = column.column(align=True)
            wavelengths.label(text="Wavelengths")
            wavelengths.prop(settings, "wavelength_min", text="From (nm)")
            wavelengths.prop(settings, "wavelength_max", text="To (nm)")
        self._draw_notes(context, column.column(align=True))

    def _draw_notes(self, context, column):
        camera = context.camera
        letters = letters_across(context)
        lens = real_lens_of(camera)
        aberration, problems = describe_chromatic(camera, lens)
        if camera.dof.use_dof:
            text = f"The focus distance is meant for light of {aberration.reference_nm:.0f} nm."
        else:
            text = "Axial aberration is seen with Depth of Field only."
        draw_sentences(column, text, letters, icon="INFO")
        for problem in problems:
            draw_alert(column, f"{problem[0].upper()}{problem[1:]}.", letters)


class _FieldMapPanel(_ChromaticPanel):
    bl_parent_id = "APLANAT_CAMERA_PT_chromatic"
    bl_options = {"DEFAULT_CLOSED"}
    which = None

    def draw(self, context):
        """Draw the two atoms, the curves that are drawn, and the map."""
        settings, column = self.begin(context)
        if _has_own_colors(context.camera):
            draw_sentences(
                column,
                "The colors are those of the real lens, over the whole picture, without a map.",
                letters_across(context),
                icon="INFO",
            )
            column.active = False
        for step, name in enumerate((f"{self.which}_first", f"{self.which}_then")):
            column.prop(settings, name)
            if getattr(settings, name) == "CURVE":
                _draw_curve(column, settings, MAP_CURVES[self.which, step])
        share = chromatic_previews.share_of_strength(
            self.which, read_field_map(settings, self.which)
        )
        render = context.scene.render
        width = render.resolution_x * render.pixel_aspect_x
        height = render.resolution_y * render.pixel_aspect_y
        curve, disc = chromatic_previews.map_icons(
            context.camera, self.which, share, width / height
        )
        pictures = column.row()
        pictures.alignment = "CENTER"
        pictures.template_icon(icon_value=curve, scale=_MAP_SCALE)
        pictures.template_icon(icon_value=disc, scale=_MAP_SCALE)
        low, high = chromatic_previews.shown_range(share)
        text = (
            f"How much of the {self.which} strength is left, from the middle of the picture to its"
            f" corners: {share.text}, drawn from {low:.3g} to {high:.3g}."
        )
        draw_sentences(column.column(align=True), text, letters_across(context))


class APLANAT_CAMERA_PT_chromatic_axial(_FieldMapPanel, bpy.types.Panel):
    """Field map of the axial aberration."""

    bl_label = "Axial Field Map"
    which = "axial"


class APLANAT_CAMERA_PT_chromatic_lateral(_FieldMapPanel, bpy.types.Panel):
    """Field map of the lateral aberration."""

    bl_label = "Lateral Field Map"
    which = "lateral"


class APLANAT_CAMERA_PT_chromatic_equalizer(_ChromaticPanel, SwitchHeader, bpy.types.Panel):
    """Spectral equalizer: the weight of each wavelength."""

    bl_label = "Spectral Equalizer"
    bl_parent_id = "APLANAT_CAMERA_PT_chromatic"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "use_equalizer"

    @classmethod
    def poll(cls, context):
        """Whether the mode has a spectrum."""
        return super().poll(context) and context.camera.aplanat.chromatic.mode == "SPECTRAL"

    def draw_header_preset(self, _context):
        """Draw the button of the curves that come with Aplanat."""
        row = self.layout.row()
        row.emboss = "NONE"
        row.menu("APLANAT_MT_equalizer_presets", text="", icon="PRESET")

    def draw(self, context):
        """Draw the curve and its spectrum."""
        settings, column = self.begin(context)
        column.active = settings.use and settings.use_equalizer
        if _draw_curve(column, settings, EQUALIZER):
            draw_spectrum(column, settings.spectrum)


def _has_own_colors(camera):
    """Whether a real lens' own colors are drawn, which have no maps."""
    if camera.aplanat.chromatic.dispersion != "LENS" or not camera.dof.use_dof:
        return False
    return real_lens_of(camera) is not None


def _draw_curve(column, settings, name):
    """Draw Blender's curve widget; return whether there is a curve."""
    group = settings.curves
    if find_mapping(group, name) is None:
        column.operator(APLANAT_OT_make_curves.bl_idname, icon="ADD")
        return False
    widget = column.column()
    widget.enabled = group.is_editable
    widget.template_curve_mapping(group.nodes[name], "mapping")
    if not group.is_editable:
        column.operator(APLANAT_OT_make_curves.bl_idname, text="Make Local Curves", icon="LINKED")
    return True


CLASSES = (
    APLANAT_CAMERA_PT_chromatic,
    APLANAT_CAMERA_PT_chromatic_axial,
    APLANAT_CAMERA_PT_chromatic_lateral,
    APLANAT_CAMERA_PT_chromatic_equalizer,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
