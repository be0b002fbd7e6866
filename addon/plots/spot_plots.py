"""Spot diagrams, and the outlines of the real pupil, at some fields."""

import numpy as np

from ..optics.rays.aberrations import best_focus, spot
from ..optics.rays.pupil import pupil_outline
from .style import INK, QUIET, RULE, SMALL_SIZE, SPECTRUM, TEXT_SIZE, frame_picture, length

_GRID = 41
_OUTLINE = 128
# Share of the largest spot's rays that the boxes hold: a few stray ones would shrink all spots.
_HELD = 0.98


def draw_spots(axes_of_fields, configuration, fields_deg):
    """Draw spots of three wavelengths in the plane of best focus on the axis, all to one scale.

    Parameters
    ----------
    axes_of_fields : sequence of matplotlib.axes.Axes
        One for each field.
    configuration : Configuration
    fields_deg : sequence of float

    Returns
    -------
    float
        Side of each box, mm.
    """
    plane = best_focus(configuration)
    spots = [
        [spot(configuration, field, plane, line[0], _GRID) for line in SPECTRUM]
        for field in fields_deg
    ]
    # Around the spot of the middle wavelength, so that lateral colour shows.
    centres = [_centre(colors[1]) for colors in spots]
    reach = [
        np.quantile(np.abs(np.concatenate(colors) - centre), _HELD)
        for colors, centre in zip(spots, centres, strict=True)
        if any(map(len, colors))
    ]
    half = 1.15 * _round_up(max(reach, default=0.01))
    for axes, colors, centre, field in zip(axes_of_fields, spots, centres, fields_deg, strict=True):
        frame_picture(axes, f"{field:.3g}°")
        for points, (_, _, color) in zip(colors, SPECTRUM, strict=True):
            x, y = (points - centre).T
            axes.plot(x, y, ".", markersize=1.6, color=color, alpha=0.55, markeredgewidth=0.0)
        axes.set_aspect("equal")
        axes.set_xlim(-half, half)
        axes.set_ylim(-half, half)
        axes.text(
            *(0.04, 0.04, _size(colors[1], centre)),
            transform=axes.transAxes,
            fontsize=SMALL_SIZE,
            color=QUIET,
        )
    return 2.0 * half


def draw_pupils(axes_of_fields, configuration, fields_deg):
    """Draw the outline of the real pupil at each field over that of the axis, to one scale.

    Parameters
    ----------
    axes_of_fields : sequence of matplotlib.axes.Axes
    configuration : Configuration
    fields_deg : sequence of float
    """
    outlines = [pupil_outline(configuration, field, _OUTLINE).points for field in fields_deg]
    centred = [points - _middle(points) for points in outlines]
    half = 1.15 * max((np.abs(points).max() for points in centred if len(points)), default=1.0)
    axis = _closed(centred[0])
    for axes, points in zip(axes_of_fields, centred, strict=True):
        frame_picture(axes)
        axes.fill(*axis.T, facecolor="none", edgecolor=RULE, linewidth=1.0)
        if len(points):
            axes.fill(*_closed(points).T, facecolor="#b9d3ea", edgecolor=INK, linewidth=0.9)
        else:
            axes.text(
                *(0.5, 0.5, "no light"),
                transform=axes.transAxes,
                ha="center",
                va="center",
                fontsize=TEXT_SIZE,
                color=QUIET,
            )
        axes.set_aspect("equal")
        axes.set_xlim(-half, half)
        axes.set_ylim(-half, half)


def _centre(points):
    return points.mean(axis=0) if len(points) else np.zeros(2)


def _middle(points):
    return 0.5 * (points.min(axis=0) + points.max(axis=0)) if len(points) else np.zeros(2)


def _closed(points):
    return np.concatenate([points, points[:1]])


def _round_up(value):
    """Return the next larger one of 1, 1.5, 2, 3, 5, 7 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(max(value, 1e-9)))
    return (
        next(step for step in (1.0, 1.5, 2.0, 3.0, 5.0, 7.0, 10.0) if step * power >= value) * power
    )


def _size(points, centre):
    if not len(points):
        return "no light"
    return f"half in ⌀ {length(2.0 * np.median(np.hypot(*(points - centre).T)))}"
