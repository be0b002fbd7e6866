"""Camera > Bokeh: which highlights are drawn one by one, and what they look like."""

import math

import bpy

from ...engine.shared_resources import real_lens_of, resources
from ...scene.camera.bokeh import corner_tangent, describe_bokeh
from ..previews import bokeh_previews
from .panel_bases import CameraPanel, PresetsHeader, SwitchHeader
from .sentences import draw_alert, draw_sentences, letters_across

# In units of Blender's buttons.
_DISC_SCALE = 5.0
# Fates of a source: label, and the icon of Blender nearest to the colour of its marks.
LEGEND = {
    "SHARP": ("Sharp: the lens samples draw it", "STRIP_COLOR_09"),
    "OUTSIDE": ("Disc outside the picture", "STRIP_COLOR_07"),
    "HIDDEN": ("Out of sight", "STRIP_COLOR_01"),
    "VISIBLE": ("Nothing in front of it", "STRIP_COLOR_04"),
    "FREE": ("Nothing between it and the lens", "STRIP_COLOR_05"),
    "MASKED": ("Partly hidden: has a mask", "STRIP_COLOR_02"),
    "IN_SPLAT": ("Partly hidden: rays per pixel", "STRIP_COLOR_06"),
}


class _BokehPanel(CameraPanel):
    group = "bokeh"


class APLANAT_CAMERA_PT_bokeh(_BokehPanel, SwitchHeader, bpy.types.Panel):
    """Highlights as discs."""

    bl_label = "Bokeh"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw the settings, the counts of highlights by fate, and warnings."""
        settings, column = self.begin(context)
        column.row().prop(settings, "highlights", expand=True)
        light = column.column(align=True)
        if settings.highlights == "THRESHOLD":
            light.prop(settings, "threshold")
        light.prop(settings, "gain")
        column.row().prop(settings, "model", expand=True)
        if settings.model == "CLUSTERED":
            clusters = column.column(align=True)
            clusters.prop(settings, "cluster_levels")
            clusters.prop(settings, "similarity")
            column.prop(settings, "use_global_merge")
        notes = column.column(align=True)
        letters = letters_across(context)
        _draw_counts(notes, context.scene, letters)
        _draw_notes(notes, context, letters)


def _draw_counts(column, scene, letters):
    counts = resources().notes.of(scene).counts
    if counts is None:
        return
    note = resources().notes.of(scene)
    for i, line in enumerate(counts_as_lines(counts, note.thresholds)):
        draw_sentences(column, line, letters, icon="BLANK1" if i else "OUTLINER_OB_LIGHT")


def counts_as_lines(counts, thresholds=None):
    """Return the counts of a picture's highlights by fate, as lines of text.

    Parameters
    ----------
    counts : dict of str to int
        Of a `PictureNote`.
    thresholds : tuple of 2 float, optional
        Of a `PictureNote`.

    Returns
    -------
    list of str
    """
    found, drawn = counts["found"], counts["splatted"]
    if not found:
        return ["No highlights in the last picture"]
    lines = [f"{found:,} highlights found, {drawn:,} discs drawn"]
    blurred = found - counts["culled_size"]
    if 0 < counts["clustered"] < blurred:
        lines.append(f"{blurred:,} merged into {counts['clustered']:,}")
    parts = [
        f"{number:,} {text}"
        for number, text in (
            (counts["culled_size"], "sharp"),
            (counts["culled_occlusion"], "out of sight"),
            (counts["masked"], "partly hidden"),
        )
        if number
    ]
    if parts:
        lines.append(", ".join(parts))
    if thresholds:
        least, largest = (f"{number:.3g}" for number in thresholds)
        span = least if least == largest else f"{least} to {largest}"
        lines.append(f"Threshold found: {span}")
    return lines


def _draw_notes(column, context, letters):
    camera, sampling = context.camera, context.scene.aplanat
    if not camera.dof.use_dof:
        text = "Bokeh is seen with Depth of Field only."
        draw_sentences(column, text, letters, icon="INFO")
    elif sampling.method == "REFERENCE" and not sampling.use_reference_bokeh:
        text = "The reference method samples highlights as everything else."
        draw_sentences(column, text, letters, icon="INFO")
    _, problems = _described(camera, real_lens_of(camera), corner_tangent(camera, context.scene))
    # Warnings that only drawing finds are those of the last picture.
    for problem in (*problems, *resources().notes.of(context.scene).problems):
        draw_alert(column, f"{problem[0].upper()}{problem[1:]}.", letters)


def _described(camera, lens, tangent):
    return describe_bokeh(camera, lens, tangent, resources().panels.sources.irises)


class APLANAT_CAMERA_PT_bokeh_search(_BokehPanel, bpy.types.Panel):
    """Settings of the search for highlights, and of their visibility."""

    bl_label = "Search and Visibility"
    bl_parent_id = "APLANAT_CAMERA_PT_bokeh"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw the settings."""
        settings, column = self.begin(context)
        column.prop(settings, "visibility")
        search = column.column(align=True)
        search.prop(settings, "layers")
        search.prop(settings, "lens_views")
        column.prop(settings, "overscan", slider=True)
        world = column.column(heading="Highlights of the")
        world.prop(settings, "use_world")


class APLANAT_CAMERA_PT_bokeh_appearance(_BokehPanel, PresetsHeader, bpy.types.Panel):
    """Appearance of the discs."""

    bl_label = "Appearance"
    bl_parent_id = "APLANAT_CAMERA_PT_bokeh"
    bl_options = {"DEFAULT_CLOSED"}
    presets = "bokeh"

    def draw(self, context):
        """Draw discs, and what shapes all of them."""
        settings, column = self.begin(context)
        camera = context.camera
        lens = real_lens_of(camera)
        # The three discs of a lens with cylinders are a thin lens'.
        self._draw_discs(context, column, lens if lens and lens.shapes_bokeh else None)
        if lens is None:
            column.prop(settings, "hardness", slider=True)
        else:
            column.prop(settings, "profile_strength", slider=True)
        text = "The opening: Lens > Iris, and Depth of Field > Aperture."
        draw_sentences(column.column(align=True), text, letters_across(context), icon="INFO")

    def _draw_discs(self, context, column, lens):
        camera = context.camera
        tangent = corner_tangent(camera, context.scene)
        bokeh, _ = _described(camera, lens, tangent)
        render = context.scene.render
        width = render.resolution_x * render.pixel_aspect_x
        height = render.resolution_y * render.pixel_aspect_y
        diagonal = math.hypot(width, height)
        corner = (tangent * width / diagonal, tangent * height / diagonal)
        discs = column.row()
        discs.alignment = "CENTER"
        icons = bokeh_previews.disc_icons(camera, bokeh.appearance, corner)
        for icon, text in zip(icons, ("In front", "Behind", "In the corner"), strict=True):
            disc = discs.column(align=True)
            disc.template_icon(icon_value=icon, scale=_DISC_SCALE)
            caption = disc.row()
            caption.alignment = "CENTER"
            caption.label(text=text)
        if lens is not None:
            text = "Without the lens itself: see Real Lens > Bokeh."
            draw_sentences(column, text, letters_across(context))


class _AppearancePanel(_BokehPanel):
    bl_parent_id = "APLANAT_CAMERA_PT_bokeh_appearance"
    bl_options = {"DEFAULT_CLOSED"}


class APLANAT_CAMERA_PT_bokeh_field(_AppearancePanel, bpy.types.Panel):
    """Optical vignetting (cat's eyes)."""

    bl_label = "Vignetting"

    def draw(self, context):
        """Draw the settings."""
        settings, column = self.begin(context)
        column.prop(settings, "vignetting")
        if settings.vignetting == "ANALYTIC":
            eye = column.column(align=True)
            eye.prop(settings, "vignetting_strength", slider=True)
            eye.prop(settings, "vignetting_softness", slider=True)


class APLANAT_CAMERA_PT_bokeh_texture(_AppearancePanel, bpy.types.Panel):
    """Grain and dust."""

    bl_label = "Grain and Dust"

    def draw(self, context):
        """Draw the settings."""
        settings, column = self.begin(context)
        grain = column.column(align=True)
        grain.prop(settings, "grain", slider=True)
        size = grain.column()
        size.active = settings.grain > 0.0
        size.prop(settings, "grain_size")
        dust = column.column(align=True)
        dust.prop(settings, "dust")
        spots = dust.column(align=True)
        spots.active = settings.dust > 0
        spots.prop(settings, "dust_size")
        spots.prop(settings, "dust_depth", slider=True)
        column.prop(settings, "texture_seed")


class APLANAT_CAMERA_PT_bokeh_rings(_AppearancePanel, bpy.types.Panel):
    """Diffraction and onion rings."""

    bl_label = "Rings"

    def draw(self, context):
        """Draw the settings."""
        settings, column = self.begin(context)
        column.prop(settings, "diffraction", slider=True)
        onion = column.column(align=True)
        onion.prop(settings, "onion", slider=True)
        rings = onion.column(align=True)
        rings.active = settings.onion > 0.0
        rings.prop(settings, "onion_pitch")
        rings.prop(settings, "onion_irregularity", slider=True)


class APLANAT_CAMERA_PT_bokeh_debug(_BokehPanel, bpy.types.Panel):
    """Debug view: marks of sources and their fates."""

    bl_label = "Debug View"
    bl_parent_id = "APLANAT_CAMERA_PT_bokeh"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw the choice, and what the colours mean."""
        settings, column = self.begin(context)
        column.prop(settings, "debug_view")
        if settings.debug_view != "VISIBILITY":
            return
        numbers = resources().notes.of(context.scene).fates
        legend = column.column(align=True)
        for fate, (text, icon) in LEGEND.items():
            row = legend.split(factor=0.75)
            row.label(text=text, icon=icon)
            number = row.row()
            number.alignment = "RIGHT"
            number.label(text=f"{numbers[fate]:,}" if numbers else "")


CLASSES = (
    APLANAT_CAMERA_PT_bokeh,
    APLANAT_CAMERA_PT_bokeh_search,
    APLANAT_CAMERA_PT_bokeh_appearance,
    APLANAT_CAMERA_PT_bokeh_field,
    APLANAT_CAMERA_PT_bokeh_texture,
    APLANAT_CAMERA_PT_bokeh_rings,
    APLANAT_CAMERA_PT_bokeh_debug,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
