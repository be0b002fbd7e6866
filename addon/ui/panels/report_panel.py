"""Render > Report: what the last pictures lack, of which data-block, and whether F12 lacks it."""

import bpy

from ...engine.report import subject_of
from ...engine.shared_resources import resources
from ...scene.reported_blocks import is_rendered, is_there
from ..operators.report_operators import SELECTABLE, APLANAT_OT_select_reported
from .panel_bases import EnginePanel
from .sentences import draw_alert, draw_sentences, letters_across

_ICONS = {
    "object": "OBJECT_DATA",
    "camera": "CAMERA_DATA",
    "material": "MATERIAL",
    "image": "IMAGE_DATA",
    "world": "WORLD",
    "scene": "SCENE_DATA",
    "view layer": "RENDERLAYERS",
}
# Beyond, their number is told.
_MOST_LINES = 30
# Letters that the button and its gap take.
_BUTTON_LETTERS = 6
BOTH, RENDER, VIEWPORT = "Viewport and F12", "F12 only", "Viewport only"


class APLANAT_RENDER_PT_report(EnginePanel, bpy.types.Panel):
    """Everything that the viewport and the last final render could not draw as it is set."""

    bl_label = "Report"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header_preset(self, context):
        """Draw how many things are told, so that a closed panel tells, too."""
        number = len(findings_of(context.scene))
        if number:
            self.layout.label(text=str(number), icon="ERROR")

    def draw(self, context):
        """Draw a failure first, then each warning with its button."""
        column, letters = self.layout.column(), letters_across(context)
        findings, failures = findings_of(context.scene), _failures(context.scene)
        for line, where in findings[:_MOST_LINES]:
            kind, name = subject_of(line, is_there)
            row = column.box().row()
            text = row.column(align=True)
            if line in failures:
                draw_alert(text, _sentence(line), letters - _BUTTON_LETTERS)
            else:
                icon = _ICONS.get(kind, "INFO")
                draw_sentences(text, _sentence(line), letters - _BUTTON_LETTERS, icon=icon)
            reach = text.row()
            reach.active = False
            reach.label(text=where, icon="BLANK1")
            if kind in SELECTABLE:
                button = row.operator(
                    APLANAT_OT_select_reported.bl_idname, text="", icon="RESTRICT_SELECT_OFF"
                )
                button.kind, button.name = kind, name
        if len(findings) > _MOST_LINES:
            column.label(text=f"and {len(findings) - _MOST_LINES} more")
        viewport = resources().notes.of(context.scene).viewport
        if viewport and viewport.levels < 1.0:
            text = "Levels of detail are being made. F12 waits for them."
            column.progress(text=f"{viewport.levels:.0%}", factor=viewport.levels)
            draw_sentences(column, text, letters, icon="MOD_DECIM")
        elif not findings:
            draw_sentences(column, _all_is_well(context.scene), letters, icon="CHECKMARK")


def _sentence(line):
    return f"{line[0].upper()}{line[1:]}"


def _failures(scene):
    note = resources().notes.of(scene)
    return {found.error for found in (note.viewport, note.render) if found and found.error}


def _all_is_well(scene):
    note = resources().notes.of(scene)
    if note.viewport is None and note.render is None:
        return "Nothing was drawn yet: switch the viewport to Rendered, or press F12."
    return "Everything is drawn as it is set."


def findings_of(scene):
    """Return what the last pictures of a scene lack.

    Parameters
    ----------
    scene : bpy.types.Scene

    Returns
    -------
    list of (str, str)
        Failures first, then warnings, each with where it counts: in `BOTH`, `RENDER` or `VIEWPORT`.
    """
    note = resources().notes.of(scene)
    in_view, in_render = (_lines(found) for found in (note.viewport, note.render))
    failures = (line for line in (*in_view, *in_render) if line in _failures(scene))
    told = dict.fromkeys([*failures, *in_render, *in_view])
    return [(line, _reach(scene, line, in_view, in_render)) for line in told]


def _lines(found):
    if found is None:
        return ()
    return (found.error, *found.warnings) if found.error else found.warnings


def _reach(scene, line, in_view, in_render):
    if line not in in_view:
        return RENDER
    # What is shown in the viewport is rendered, too, unless it is switched off for renders.
    return (
        BOTH if line in in_render or is_rendered(scene, *subject_of(line, is_there)) else VIEWPORT
    )


CLASSES = (APLANAT_RENDER_PT_report,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
