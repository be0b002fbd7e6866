"""A lens on one sheet, as makers' data sheets show it."""

import textwrap

from ..optics.lens_facts import lens_facts
from ..optics.paraxial import first_order
from .aberration_plots import draw_axial_focus, draw_field_curves, draw_vignetting
from .bokeh_plots import DISK_LIGHTS, draw_bokeh_table, draw_disks, draw_field_disks
from .cross_section import draw_cross_section
from .spot_plots import draw_pupils, draw_spots
from .style import INK, QUIET, RULE, TEXT_SIZE, TITLE_SIZE, Panel, length

# Inches; 100 pixels each make the usual 1600 x 1200.
SHEET_INCHES = (16.0, 12.0)
FIELD_SHARES = (0.0, 0.35, 0.7, 1.0)
_SECTION_FIELDS = (0.0, 0.7, 1.0)

_SECTION = Panel(0.035, 0.575, 0.64, 0.33)
_FACTS = Panel(0.715, 0.575, 0.25, 0.33)
_DIAGRAMS = Panel(0.06, 0.348, 0.905, 0.172)
_SPOTS = Panel(0.035, 0.118, 0.415, 0.128)
_PUPILS = Panel(0.035, 0.018, 0.415, 0.09)
_TABLE = Panel(0.505, 0.055, 0.175, 0.2)
_DISKS = Panel(0.715, 0.132, 0.25, 0.103)
_FIELD_DISKS = Panel(0.715, 0.022, 0.25, 0.09)
# Where the lines between the parts are, and the headings under the last one.
_RULES = (0.917, 0.557, 0.297)
_HEADING = 0.267


def draw_sheet(figure, prescription, configuration, profile, step=lambda: None):
    """Draw the data sheet of a lens at one zoom position.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        Of `SHEET_INCHES`, or of that shape.
    prescription : Prescription
    configuration : Configuration
        Of it.
    profile : LensProfile or None
        Of that; None for a lens that is not one of revolution.
    step : callable
        Called between the drawings.

    Raises
    ------
    PrescriptionError
        If the lens cannot be traced.
    """
    figure.set_facecolor("white")
    half = configuration.half_field_deg
    fields = [share * half for share in FIELD_SHARES]
    _draw_title(figure, prescription, configuration)
    section = _SECTION.axes(figure)
    draw_cross_section(
        section, configuration, fields_deg=[share * half for share in _SECTION_FIELDS]
    )
    section.axis("off")
    _draw_facts(figure, prescription, configuration)
    step()
    focus, curves, distortion, vignetting = (
        _DIAGRAMS.column(i, 4, 0.045).axes(figure) for i in range(4)
    )
    draw_axial_focus(focus, configuration)
    draw_field_curves(curves, distortion, configuration, prescription.projection)
    step()
    draw_vignetting(vignetting, configuration)
    step()
    columns = range(len(fields))
    spots = [_SPOTS.column(i, len(fields), 0.01).axes(figure) for i in columns]
    side = draw_spots(spots, configuration, fields)
    _heading(figure, _SPOTS.x, f"Spots in best focus, box {length(side)}; pupils below")
    step()
    draw_pupils(
        [_PUPILS.column(i, len(fields), 0.01).axes(figure) for i in columns], configuration, fields
    )
    step()
    _draw_bokeh(figure, configuration, profile, fields[1:], step)


def _draw_bokeh(figure, configuration, profile, fields, step):
    _heading(figure, _TABLE.x, "Bokeh table: a point at 1 m")
    _heading(figure, _DISKS.x, f"Points of light at f/{configuration.f_number:.2g}")
    if profile is None:
        figure.text(
            *(_TABLE.x, _HEADING - 0.03, "a lens with cylinders has none over the radius"),
            fontsize=TEXT_SIZE,
            color=QUIET,
        )
    else:
        draw_bokeh_table(_TABLE.axes(figure), configuration, profile)
    step()
    count = len(DISK_LIGHTS)
    disks = [_DISKS.column(i, count, 0.01).axes(figure) for i in range(count)]
    draw_disks(disks, configuration, profile)
    step()
    disks = [_FIELD_DISKS.column(i, len(fields), 0.01).axes(figure) for i in range(len(fields))]
    draw_field_disks(disks, configuration, fields)


def _draw_title(figure, prescription, configuration):
    title = prescription.name
    if configuration.label:
        title += f", at {configuration.label}"
    figure.text(0.035, 0.962, title, fontsize=20, weight="bold", color=INK, va="center")
    source = " · ".join(
        part
        for part in (prescription.designer, str(prescription.year or ""), prescription.source)
        if part
    )
    figure.text(
        *(0.035, 0.932, textwrap.shorten(source, 180, placeholder=" ...")),
        fontsize=TEXT_SIZE,
        color=QUIET,
        va="center",
    )
    figure.text(0.965, 0.962, "Aplanat", fontsize=12, color=QUIET, va="center", ha="right")
    for height in _RULES:
        figure.add_artist(_rule(height))


def _draw_facts(figure, prescription, configuration):
    facts, values = lens_facts(prescription, configuration.label), first_order(configuration)
    # From the last vertex that refracts.
    behind = configuration.vertices[-1] - configuration.rear_vertex
    focal_length = f"{facts.focal_length:.2f} mm"
    if facts.horizontal_focal_length is not None:
        focal_length += f" (horizontally {facts.horizontal_focal_length:.2f} mm)"
    iris = prescription.diaphragm
    exit_pupil = "at infinity"
    if values.exp_z is not None:
        exit_pupil = f"{values.exp_diameter:.2f} mm at {values.exp_z + behind:.2f} mm"
    rows = [
        ("Focal length", focal_length),
        ("f-number", f"{values.f_number:.2f}"),
        ("Field", f"{2.0 * configuration.half_field_deg:.3g}°, {prescription.projection}"),
        ("Image circle", f"{facts.image_circle_diameter:.3g} mm"),
        ("Elements / groups", f"{facts.elements} / {facts.groups}"),
        ("Length", f"{configuration.rear_vertex:.2f} mm"),
        ("Back focus", f"{values.bfl + behind:.2f} mm"),
        ("Entrance pupil", f"{values.enp_diameter:.2f} mm at {values.enp_z:.2f} mm"),
        ("Exit pupil", exit_pupil),
        ("Principal planes", f"{values.h:.2f} mm, {values.h_prime + behind:.2f} mm"),
        ("Iris", f"{iris.blades} blades" if iris.blades else "round"),
    ]
    if prescription.zoom:
        rows.append(("Zoom", ", ".join(prescription.labels)))
    line = _FACTS.height / 13.0
    for number, (name, value) in enumerate(rows):
        y = _FACTS.y + _FACTS.height - (number + 0.9) * line
        figure.text(_FACTS.x, y, name, fontsize=TITLE_SIZE, color=QUIET, va="center")
        figure.text(
            *(_FACTS.x + _FACTS.width, y, textwrap.shorten(value, 46, placeholder=" ...")),
            fontsize=TITLE_SIZE,
            color=INK,
            va="center",
            ha="right",
        )
        end = y - 0.5 * line
        figure.add_artist(_rule(end, _FACTS.x, _FACTS.x + _FACTS.width))


def _rule(height, start=0.035, end=0.965):
    from matplotlib.lines import Line2D

    return Line2D([start, end], [height, height], color=RULE, linewidth=0.9)


def _heading(figure, x, text):
    figure.text(x, _HEADING, text, fontsize=TITLE_SIZE, weight="bold", color=INK)
