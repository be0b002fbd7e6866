"""Diagrams of aberrations over pupil and field: foci, distortion, vignetting."""

import numpy as np

from ..optics.glass import REFERENCE_WAVELENGTH_NM
from ..optics.rays.aberrations import axial_focus, best_focus, field_curves, paraxial_focus
from ..optics.rays.pupil import pupil_rays
from ..optics.rays.trace import trace
from .style import INK, QUIET, SPECTRUM, VIOLET, frame_diagram, legend, symmetric_limits

_RHO = np.linspace(0.0, 1.0, 51)
_FIELDS = 19
# Enough rays for lines: areas are good to half a per cent, stopped down to one.
_PUPIL_GRID = 151
# Stops of the vignetting diagram, in f-numbers from wide open.
_STOPS_DOWN = (0, 1, 2, 3)
# The least scale of a diagram: below this a lens is as good as its prescription's digits.
_LEAST_MM, _LEAST_PERCENT = 0.02, 0.1


def draw_axial_focus(axes, configuration):
    """Draw longitudinal aberration: where rays from infinity cross the axis, over their height.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    configuration : Configuration
    """
    frame_diagram(axes, "Longitudinal aberration", "focus, mm", "height in the entrance pupil")
    shifts = []
    for wavelength, name, color in (*SPECTRUM, VIOLET):
        found = axial_focus(configuration, _RHO, wavelength)
        axes.plot(found.shift, found.rho, color=color, linewidth=1.3, label=name)
        shifts.extend(found.shift)
    best = best_focus(configuration) - paraxial_focus(configuration)
    axes.axvline(best, color=QUIET, linewidth=0.8, linestyle=(0, (4, 3)))
    axes.axvline(0.0, color=INK, linewidth=0.6)
    axes.set_ylim(0.0, 1.0)
    axes.set_xlim(symmetric_limits([*shifts, best], _LEAST_MM))
    legend(axes, loc="best")


def draw_field_curves(axes, distortion_axes, configuration, projection):
    """Draw field curvature with astigmatism, and distortion beside it, over the field.

    Parameters
    ----------
    axes, distortion_axes : matplotlib.axes.Axes
    configuration : Configuration
    projection : {"rectilinear", "fisheye"}
    """
    half = configuration.half_field_deg
    curves = field_curves(configuration, np.linspace(0.0, half, _FIELDS), projection)
    frame_diagram(axes, "Field curves", "focus, mm", "field, degrees")
    line = dict(color=SPECTRUM[1][2], linewidth=1.3)
    axes.plot(curves.sagittal, curves.field_deg, label="sagittal", **line)
    axes.plot(
        curves.tangential, curves.field_deg, label="tangential", linestyle=(0, (4, 2)), **line
    )
    axes.set_xlim(symmetric_limits([*curves.sagittal, *curves.tangential], _LEAST_MM))
    legend(axes, loc="best")
    rule = "f θ" if projection == "fisheye" else "f tan θ"
    frame_diagram(distortion_axes, "Distortion", f"% of {rule}", "field, degrees")
    percent = 100.0 * curves.distortion
    distortion_axes.plot(percent, curves.field_deg, color=INK, linewidth=1.3)
    distortion_axes.set_xlim(symmetric_limits(percent, _LEAST_PERCENT))
    for one in (axes, distortion_axes):
        one.axvline(0.0, color=INK, linewidth=0.6)
        one.set_ylim(0.0, half)


def draw_vignetting(axes, configuration):
    """Draw how much of the axial beam's area gets through over the field, wide open and stopped.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    configuration : Configuration
    """
    frame_diagram(axes, "Vignetting", "field, degrees", "area of the pupil, % of the axis'")
    half = configuration.half_field_deg
    fields = np.linspace(0.0, half, _FIELDS)
    f_numbers = [configuration.f_number * 2.0 ** (step / 2.0) for step in _STOPS_DOWN]
    shares = 100.0 * passing_shares(configuration, fields, f_numbers)
    for order, f_number in enumerate(f_numbers):
        shade = order / len(_STOPS_DOWN)
        color = tuple((1.0 - shade) * dark + shade * 0.78 for dark in (0.13, 0.29, 0.45))
        axes.plot(fields, shares[:, order], color=color, linewidth=1.4, label=f"f/{f_number:.2g}")
    axes.set_xlim(0.0, half)
    axes.set_ylim(0.0, max(105.0, 1.05 * axes.get_ylim()[1]))
    legend(axes, loc="lower left")


def passing_shares(configuration, fields_deg, f_numbers):
    """Areas of beams that get through the lens, over that of the first one.

    Parameters
    ----------
    configuration : Configuration
    fields_deg : sequence of F float
        The first is the axis.
    f_numbers : sequence of N float
        Not below that of the lens.

    Returns
    -------
    ndarray of shape (F, N)
    """
    areas = np.array([_areas(configuration, field, f_numbers) for field in fields_deg])
    return areas / np.maximum(areas[0], 1e-12)


def _areas(configuration, field_deg, f_numbers):
    """Areas of the beam that get through at each of the f-numbers, mm^2."""
    found = pupil_rays(configuration, field_deg, _PUPIL_GRID)
    stop = configuration.stop
    traced = trace(configuration, found.rays, REFERENCE_WAVELENGTH_NM, last=stop)
    radius = np.hypot(traced.points[:, 0], traced.points[:, 1])
    wide_open = configuration.surfaces[stop - 1].semi_diameter
    openings = [wide_open * configuration.f_number / f_number for f_number in f_numbers]
    return [found.weights[radius <= opening].sum() for opening in openings]
