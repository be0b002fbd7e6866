"""Lenses to choose from, all at once; and in a panel what one does, beside another."""

import re

import bpy

from ...engine.shared_resources import real_lens_of, resources, shelf
from ...scene.camera.irises import read_opening
from ...scene.camera.lenses import read_compared_lens
from ..operators.lens_operators import APLANAT_OT_choose_lens, CameraOperator, camera_of
from ..previews import lens_thumbnails
from .lens_panel import KnownLensPanel
from .sentences import draw_alert, draw_sentences, letters_across, wrapped

# Pixels of one of Blender's units at a scale of 1, and of what a panel keeps free on both sides.
_UNIT, _MARGINS = 20.0, 24.0
# Units of a picture, and between two of them.
_LARGEST, _GAP = 10.0, 0.4
# Of the popup: pixels, columns, units and letters of a cell. 32 lenses fit into 1280 x 800.
_POPUP_WIDTH, _COLUMNS, _CELL, _CELL_LETTERS = 920, 7, 4.4, 16
# What a name says of focal length and f-number.
_FIGURE = re.compile(r"[\d.,-]*mm|f/[\d.]+,?|[\d.-]+|\(.*|.*\)")
_BOKEH = (
    "Points of light, the focus at 40 focal lengths. From left to right: at 0.5, 0.75 and 2 times"
    " that distance and far away; from top to bottom: in the middle of the picture, at 35 % and"
    " 70 % of the way to its corner and in the corner."
)
_DIAGRAMS = (
    "Sharpness: contrast in % of lines as fine as 30 pairs per mm on 36 x 24 mm; solid where they"
    " point to the middle, dashed across. Light: stops that rims take away."
)


class APLANAT_OT_browse_lenses(CameraOperator, bpy.types.Operator):
    """All lenses with their pictures."""

    bl_idname = "camera.aplanat_browse_lenses"
    bl_label = "Browse Lenses"
    bl_description = (
        "Show all lenses with cross-section and bokeh; a click puts one on the camera, and the"
        " popup stays until the mouse leaves it"
    )
    bl_options = {"INTERNAL"}

    def invoke(self, context, _event):
        """Open the popup."""
        return context.window_manager.invoke_popup(self, width=_POPUP_WIDTH)

    def execute(self, _context):
        """Nothing: the buttons of the popup choose."""
        return {"FINISHED"}

    def draw(self, context):
        """Draw a cell for each lens; the one of the camera is pressed."""
        chosen = camera_of(context).aplanat.lens
        layout = self.layout
        grid = layout.grid_flow(row_major=True, columns=_COLUMNS, even_columns=True)
        cell = grid.column(align=True)
        cell.template_icon(icon_value=0, scale=_CELL)
        _draw_choice(cell, "", ("Thin Lens", "ideal, any f-stop"), not chosen)
        for lens_id in shelf().ids():
            found = shelf().find(lens_id)
            if found is None:
                continue
            cell = grid.column(align=True)
            cell.template_icon(icon_value=lens_thumbnails.reserved_icon_id(found), scale=_CELL)
            _draw_choice(cell, lens_id, _two_lines(found), lens_id == chosen)


def _two_lines(found):
    """Return name and figures of a lens, each short enough for a cell."""
    if found.lens is None:
        return found.id, "cannot be used"
    made = found.lens.prescription
    figures = f"{made.focal_length:.3g} mm f/{made.f_number:.3g}"
    if made.zoom:
        figures = f"zoom {figures}"
    words = [word for word in found.name.split() if not _FIGURE.fullmatch(word)]
    return wrapped(" ".join(words), _CELL_LETTERS)[0], figures


def _draw_choice(cell, lens_id, lines, chosen):
    cell.label(text=lines[0])
    button = cell.operator(APLANAT_OT_choose_lens.bl_idname, text=lines[1], depress=chosen)
    button.lens = lens_id


class APLANAT_CAMERA_PT_lens_pictures(KnownLensPanel, bpy.types.Panel):
    """Pictures of the lens and of another one: bokeh over distance and field, diagrams."""

    bl_label = "Pictures"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw the pictures, which are made in the background."""
        camera, letters = context.camera, letters_across(context)
        column = self.column()
        column.prop(camera.aplanat, "compared_lens", text="Compare", placeholder="Another Lens")
        lenses = [real_lens_of(camera), read_compared_lens(camera, shelf())]
        lenses = [lens for lens in lenses if lens is not None]
        if camera.aplanat.compared_lens and len(lenses) < 2:
            text = f"'{camera.aplanat.compared_lens}' cannot be used."
            draw_alert(column, text, letters)
        irises = resources().panels.sources.irises
        states = tuple(
            lens_thumbnails.state_of(lens, read_opening(camera, lens, irises)[0]) for lens in lenses
        )
        row = column.row()
        for place, (lens, state) in enumerate(zip(lenses, states, strict=True)):
            _draw_lens(row.column(), camera, lens, (state, place), _scale(context, len(lenses)))
        row = column.row()
        for icon in lens_thumbnails.diagram_icon_ids(camera, states):
            row.template_icon(icon_value=icon, scale=_scale(context, 2))
        if len(lenses) > 1:
            text = "Orange is the camera's lens, blue the other."
            draw_sentences(column, text, letters)
            use = column.operator(
                APLANAT_OT_choose_lens.bl_idname, text="Use the Other Lens", icon="CHECKMARK"
            )
            use.lens = lenses[1].id
        small = column.column(align=True)
        draw_sentences(small, _BOKEH, letters)
        draw_sentences(small, _DIAGRAMS, letters)


def _draw_lens(column, camera, lens, which, scale):
    error = lens_thumbnails.bokeh_error(camera, *which)
    letters = int(scale * _UNIT / 6.5)
    # Titles of two lines, so that pictures side by side begin at the same height.
    lines = wrapped(f"{lens.prescription.name}, at f/{lens.f_number:.3g}", letters)
    for line in (*lines, "", "")[: max(2, len(lines))]:
        column.label(text=line)
    if error:
        draw_alert(column, error, letters)
    else:
        icon = lens_thumbnails.bokeh_icon_id(camera, *which)
        column.template_icon(icon_value=icon, scale=scale)


def _scale(context, count):
    """Return the size of each of so many pictures in a row, in units."""
    scale = context.preferences.system.ui_scale
    units = (context.region.width / scale - _MARGINS) / _UNIT
    return min(_LARGEST, (units - _GAP * (count - 1)) / count)


CLASSES = (APLANAT_OT_browse_lenses, APLANAT_CAMERA_PT_lens_pictures)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
