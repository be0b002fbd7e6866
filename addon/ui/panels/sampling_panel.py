"""The Sampling panel of the render properties."""

import bpy

from ...engine.shared_resources import resources
from .panel_bases import EnginePanel, PresetsHeader
from .sentences import draw_sentences, letters_across


class APLANAT_RENDER_PT_sampling(PresetsHeader, EnginePanel, bpy.types.Panel):
    """Sampling: method, presets."""

    bl_label = "Sampling"
    bl_context = "render"
    presets = "sampling"

    def draw(self, context):
        """Draw the method."""
        self.column().prop(context.scene.aplanat, "method")
        column = self.layout.column()
        for line in sampling_as_lines(resources().notes.of(context.scene).sampling):
            draw_sentences(column, line, letters_across(context), icon="INFO")


class _SamplesPanel(EnginePanel):
    """Samples of the viewport or of the final render."""

    bl_context = "render"
    bl_parent_id = "APLANAT_RENDER_PT_sampling"
    prefix = ""

    def draw(self, context):
        """Draw the settings, as Cycles does."""
        settings = context.scene.aplanat
        column = self.column()
        if settings.method == "ADAPTIVE":
            row = column.row(heading="Noise Threshold")
            row.prop(settings, "use_target_error", text="")
            threshold = row.row()
            threshold.active = settings.use_target_error
            threshold.prop(settings, f"{self.prefix}_error", text="")
        if settings.method == "ADAPTIVE" and settings.use_target_error:
            samples = column.column(align=True)
            samples.prop(settings, f"{self.prefix}_max_samples", text="Max Samples")
            samples.prop(settings, f"{self.prefix}_min_samples", text="Min Samples")
        else:
            column.prop(settings, f"{self.prefix}_samples", text="Samples")
        column.prop(settings, f"{self.prefix}_time_limit", text="Time Limit")
        if self.prefix == "preview":
            column.prop(settings, "preview_frame_time", text="Frame Time")
            column.prop(settings, "show_preview_times")


class APLANAT_RENDER_PT_sampling_viewport(_SamplesPanel, bpy.types.Panel):
    """Samples of the Rendered viewport."""

    bl_label = "Viewport"
    prefix = "preview"


class APLANAT_RENDER_PT_sampling_render(_SamplesPanel, bpy.types.Panel):
    """Samples of the final render."""

    bl_label = "Render"
    prefix = "render"


class APLANAT_RENDER_PT_sampling_advanced(EnginePanel, bpy.types.Panel):
    """Sampling settings that viewport and final render share."""

    bl_label = "Advanced"
    bl_context = "render"
    bl_parent_id = "APLANAT_RENDER_PT_sampling"

    def draw(self, context):
        """Draw the settings of the scene."""
        settings = context.scene.aplanat
        column = self.column()
        if settings.method == "ADAPTIVE":
            if not settings.use_target_error:
                column.prop(settings, "subsamples")
            sharing = column.row(heading="Share Drawings")
            sharing.prop(settings, "use_sharing", text="")
            cells = sharing.row()
            cells.active = settings.use_sharing
            cells.prop(settings, "sharing_cells")
        elif settings.method == "LAYERED":
            column.prop(settings, "layers")
            column.prop(settings, "layer_source")
            column.prop(settings, "use_view_dependence", text="View-Dependent")
        column.prop(settings, "seed")
        pixel = column.column()
        pixel.prop(settings, "pixel_filter")
        pixel.prop(context.scene.render, "filter_size", text="Width")


def sampling_as_lines(report):
    """Return the error and samples of a picture, as lines of text.

    Parameters
    ----------
    report : SamplingReport or None
        Of a `PictureNote`.

    Returns
    -------
    list of str
    """
    if report is None or report.error is None:
        return []
    least, mean, most = report.samples
    lines = [
        f"Last picture: error {report.error:.4f} of {report.target:.4f}, {least} to {most} samples"
        f" ({mean:.0f} on the average)"
    ]
    if report.error > report.target:
        lines.append("Stopped above its noise threshold by Max Samples or the time limit.")
    return lines


CLASSES = (
    APLANAT_RENDER_PT_sampling,
    APLANAT_RENDER_PT_sampling_viewport,
    APLANAT_RENDER_PT_sampling_render,
    APLANAT_RENDER_PT_sampling_advanced,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
