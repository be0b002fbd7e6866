"""Lenses beside one another, as a photographer looks at them before choosing.

Their bokeh over field and distance, and two diagrams from the middle of the picture to its corner:
how much contrast fine lines keep, and how much light is lost. Lines are as fine in the picture for
all lenses, whatever the size of what they cover: as 30 pairs of lines per mm on 36 x 24 mm.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..lens_bokeh.openings.blades import BladedIris
from ..optics.lens_facts import lens_facts
from ..optics.prescription import Configuration, Prescription
from ..optics.rays.contrast import contrast
from .aberration_plots import passing_shares
from .cross_section import draw_cross_section
from .kept_pictures import kept_picture, state_name
from .lens_pictures import SHEET_LIGHTS, bokeh_sheet, watched
from .style import (
    INK,
    QUIET,
    SMALL_SIZE,
    TEXT_SIZE,
    TITLE_SIZE,
    Panel,
    frame_diagram,
    frame_picture,
)

# Inches of the sheet; 100 pixels each make 1600 x 1200.
SHEET_INCHES = (16.0, 12.0)
# Pixels on a side of a diagram in a panel.
DIAGRAM_SIZE = 256
# Pairs of lines over the diagonal of the picture: 30 per mm on 36 x 24 mm.
_LINES = 30.0 * math.hypot(36.0, 24.0)
# Places from the middle to the corner.
_FIELDS = 13
# Stops of lost light that a diagram shows at least.
_LEAST_STOPS = 2.0
_COLORS_ON_WHITE = ("#c8641e", "#1f6fb0")
_COLORS_ON_BLACK = ("#ffb561", "#6fd0e8")
_BLACK, _PALE, _DIM = "#1b1d20", "#d8dde2", "#4a5058"
_PANEL_POINTS = 15.0
_DASHED = (0, (4, 2))


@dataclass(frozen=True)
class LensState:
    """A lens as a camera has it.

    Parameters
    ----------
    prescription : Prescription
    label : str or None
        Zoom position.
    f_number : float
        Not below that of the lens.
    opening : BladedIris or PictureIris
        Of the iris.
    """

    prescription: Prescription
    label: str | None
    f_number: float
    opening: object

    @property
    def configuration(self) -> Configuration:
        """The lens at its zoom position."""
        return self.prescription.configuration(self.label)

    @property
    def title(self):
        """Name, zoom position, and the f-number where it is stopped down, as text."""
        place = f" at {self.label}" if self.label else ""
        stopped = self.f_number > 1.01 * self.configuration.f_number
        return f"{self.prescription.name}{place}" + f", f/{self.f_number:.3g}" * stopped


def own_state(prescription, label=None):
    """Return a lens wide open with the iris that it has.

    Parameters
    ----------
    prescription : Prescription
    label : str or None

    Returns
    -------
    LensState
    """
    configuration, iris = prescription.configuration(label), prescription.diaphragm
    # Wide open, the blades are behind the round stop.
    rotation = math.radians(iris.rotation_deg)
    opening = BladedIris(iris.blades, iris.blade_curvature, rotation, closing=1.0)
    return LensState(prescription, configuration.label, configuration.f_number, opening)


def diagrams(states, progress=None, cancelled=None, folder=None):
    """Draw the two diagrams for a panel, of all lenses in one.

    Parameters
    ----------
    states : sequence of LensState
        One or two.
    progress, cancelled, folder
        As for `lens_pictures.bokeh_sheet`.

    Returns
    -------
    tuple of 2 ndarray of shape (DIAGRAM_SIZE, DIAGRAM_SIZE, 4)
        Of sharpness and of light; float32, display colours, first row at the top.

    Raises
    ------
    RenderCancelledError
        If it was cancelled.
    PrescriptionError
        If a lens cannot be traced.
    """
    given = [(each.prescription, each.label, each.f_number, each.opening) for each in states]
    both = kept_picture(
        state_name("diagrams-1", *given),
        (2 * DIAGRAM_SIZE, DIAGRAM_SIZE, 4),
        folder,
        lambda: _draw_diagrams(states, watched(progress, cancelled)),
    )
    return both[:DIAGRAM_SIZE], both[DIAGRAM_SIZE:]


def _draw_diagrams(states, step):
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    pictures = []
    for order, (draw, title) in enumerate(((_sharpness, "Sharpness"), (_light, "Light"))):
        step(0.5 * order)
        inches = DIAGRAM_SIZE / 100.0
        figure = Figure(figsize=(inches, inches), dpi=100, facecolor=_BLACK)
        canvas = FigureCanvasAgg(figure)
        axes = figure.add_axes((0.2, 0.13, 0.75, 0.72))
        draw(axes, states, _COLORS_ON_BLACK)
        axes.set_title(title, fontsize=_PANEL_POINTS, color=_PALE, pad=4.0)
        axes.set_facecolor(_BLACK)
        axes.grid(True, color=_DIM, linewidth=0.8)
        axes.tick_params(labelsize=_PANEL_POINTS - 3.0, colors=_PALE, length=0.0)
        axes.set_xticks([0.0, 1.0], ["middle", "corner"])
        for label, side in zip(axes.get_xticklabels(), ("left", "right"), strict=True):
            label.set_horizontalalignment(side)
        for spine in axes.spines.values():
            spine.set_color(_DIM)
        canvas.draw()
        pictures.append(np.array(canvas.buffer_rgba()))
    return np.concatenate(pictures)


def draw_comparison(figure, states, step=lambda: None):
    """Draw two lenses side by side on a sheet.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        Of `SHEET_INCHES`, or of that shape.
    states : sequence of 2 LensState
    step : callable
        Called between the drawings.

    Raises
    ------
    PrescriptionError
        If a lens cannot be traced.
    """
    figure.set_facecolor("white")
    for order, state in enumerate(states):
        left = 0.04 + 0.5 * order
        color = _COLORS_ON_WHITE[order]
        figure.text(left, 0.962, state.title, fontsize=16, weight="bold", color=color, va="center")
        figure.text(left, 0.936, _facts(state), fontsize=TEXT_SIZE, color=QUIET, va="center")
        section = Panel(left, 0.66, 0.42, 0.25).axes(figure)
        half = state.configuration.half_field_deg
        draw_cross_section(section, state.configuration, fields_deg=[0.0, 0.7 * half, half])
        section.axis("off")
        step()
        _draw_bokeh(figure, state, left)
        step()
    axes = Panel(0.06, 0.06, 0.4, 0.2).axes(figure)
    frame_diagram(axes, "Sharpness: contrast of 30 pairs of lines per mm on 36 x 24 mm", "", "%")
    _sharpness(axes, states, _COLORS_ON_WHITE)
    axes.set_xticks(np.linspace(0.0, 1.0, 6), ["middle", "20 %", "40 %", "60 %", "80 %", "corner"])
    axes.text(
        *(0.99, 0.96, "solid: lines that point to the middle; dashed: across"),
        **{"transform": axes.transAxes, "ha": "right", "va": "top"},
        **{"fontsize": SMALL_SIZE, "color": QUIET},
    )
    step()
    axes = Panel(0.56, 0.06, 0.4, 0.2).axes(figure)
    frame_diagram(axes, "Light that rims take away", "", "stops")
    _light(axes, states, _COLORS_ON_WHITE)
    axes.set_xticks(np.linspace(0.0, 1.0, 6), ["middle", "20 %", "40 %", "60 %", "80 %", "corner"])
    step()


def _facts(state):
    facts, configuration = lens_facts(state.prescription, state.label), state.configuration
    parts = (
        f"{facts.focal_length:.4g} mm",
        f"{2.0 * configuration.half_field_deg:.3g}°",
        f"image circle {facts.image_circle_diameter:.3g} mm",
        f"{facts.elements} elements in {facts.groups} groups",
        f"length {configuration.rear_vertex:.3g} mm",
        str(state.prescription.year or ""),
    )
    return "  ·  ".join(part for part in parts if part)


def _draw_bokeh(figure, state, left):
    axes = Panel(left + 0.06, 0.325, 0.3, 0.31).axes(figure)
    frame_picture(axes)
    if not state.configuration.of_revolution:
        text = "no sheet of discs: a lens with cylinders"
        axes.text(0.5, 0.5, text, ha="center", color=QUIET, fontsize=TEXT_SIZE)
        return
    picture = bokeh_sheet(state.prescription, state.label, state.f_number, state.opening)
    axes.imshow(picture, extent=(0.0, 4.0, 4.0, 0.0), interpolation="bilinear")
    names = [f"{light:g} x focus" if math.isfinite(light) else "far away" for light in SHEET_LIGHTS]
    axes.set_xticks([0.5, 1.5, 2.5, 3.5], names, fontsize=SMALL_SIZE, color=QUIET)
    rows = ("middle", "35 %", "70 %", "corner")
    axes.set_yticks([0.5, 1.5, 2.5, 3.5], rows, fontsize=SMALL_SIZE, color=QUIET)
    axes.tick_params(length=0.0)
    axes.set_title("Points of light", loc="left", fontsize=TITLE_SIZE, color=INK, weight="bold")


def _sharpness(axes, states, colors):
    places = np.linspace(0.0, 1.0, _FIELDS)
    for state, color in zip(states, colors, strict=False):
        configuration = state.configuration
        diameter = lens_facts(state.prescription, state.label).image_circle_diameter
        fields = places * configuration.half_field_deg
        kept = 100.0 * contrast(configuration, fields, _LINES / diameter, state.f_number)
        axes.plot(places, kept[:, 0], color=color, linewidth=2.0)
        axes.plot(places, kept[:, 1], color=color, linewidth=2.0, linestyle=_DASHED)
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, 100.0)
    axes.set_yticks([0, 25, 50, 75, 100])


def _light(axes, states, colors):
    places, most = np.linspace(0.0, 1.0, _FIELDS), _LEAST_STOPS
    for state, color in zip(states, colors, strict=False):
        fields = places * state.configuration.half_field_deg
        shares = passing_shares(state.configuration, fields, [state.f_number])[:, 0]
        stops = np.log2(np.maximum(shares, 1e-6))
        axes.plot(places, stops, color=color, linewidth=2.0)
        most = max(most, min(-float(stops.min()), 6.0))
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(-1.05 * most, 0.3)
