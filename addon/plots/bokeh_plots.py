"""Plots of a lens' bokeh: its table, and discs of points in front of and behind the focus."""

import numpy as np

from ..lens_bokeh.tables.mapping import pattern_row
from ..lens_bokeh.tables.profile import REFERENCE_DISTANCE, profile_table, ring_areas
from ..optics.focus import focused
from ..optics.paraxial import first_order, image_distance
from ..optics.rays.pupil import pupil_rays
from ..optics.rays.trace import trace
from ..sampling.spectrum import rgb_weights, spectrum_wavelengths
from .style import QUIET, SMALL_SIZE, frame_diagram, frame_picture, length

_ROWS, _RADII = 200, 256
_DISK_PIXELS = 256
# Pixels of traced disks, and rays: about five a pixel in each direction.
_TRACED_PIXELS, _TRACED_GRID, _TRACED_WAVELENGTHS = 72, 301, 7
_FOCUS_IN_FOCAL_LENGTHS = 40.0
# Where the disks' lights are, in focus distances, and what they are called.
DISK_LIGHTS = ((0.6, "in front of the focus"), (1.0, "in focus"), (4.0, "behind the focus"))
# Share of the energy that a picture of a disk holds, and its margin: halos may reach far.
_HELD, _MARGIN = 0.98, 1.15
# Grey of an even disk, so that bright rims are not clipped.
_EVEN_GRAY = 0.35


def draw_bokeh_table(axes, configuration, profile):
    """Draw the table: energy over sensor position and radius, each row in units of its extent.

    Rows go from the focus of infinity to as far behind the image of a point at 1 m.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    configuration : Configuration
    profile : LensProfile
        Of it.
    """
    values = first_order(configuration)
    behind = image_distance(configuration, REFERENCE_DISTANCE - values.h) - values.bfl
    table = profile_table(profile, rows=2 * _ROWS, radii=_RADII, span=2.0 * behind)
    # The half on the scene's side of the infinity focus says nothing new.
    density = table.density[_ROWS:]
    both = np.concatenate([density[:, ::-1], density], axis=1).transpose(1, 0, 2)
    frame_diagram(axes, "", "sensor, mm behind the focus of infinity", "radius / extent")
    axes.grid(False)
    axes.imshow(
        displayed(both),
        extent=(0.0, 2.0 * behind, -1.0, 1.0),
        aspect="auto",
        interpolation="bilinear",
    )
    axes.set_yticks([-1.0, 0.0, 1.0])


def draw_disks(axes_of_lights, configuration, profile):
    """Draw the disks that points of light make on the sensor, each to its own scale.

    Parameters
    ----------
    axes_of_lights : sequence of 3 matplotlib.axes.Axes
        For a light in front of, in and behind the focus.
    configuration : Configuration
    profile : LensProfile or None
        Of it; None for a lens that is not one of revolution: its disks are traced.
    """
    values = first_order(configuration)
    focus = _FOCUS_IN_FOCAL_LENGTHS * values.efl
    lens = focused(configuration, focus - values.h)
    for axes, (share, name) in zip(axes_of_lights, DISK_LIGHTS, strict=True):
        if profile is None:
            frame_picture(axes, f"{name}\n{_metres(share * focus)}")
            _show_traced(axes, lens, (0.0, 0.0, values.h - share * focus))
            continue
        row = pattern_row(profile, share * focus, focus, configuration.f_number, _RADII)
        frame_picture(axes, f"{name}\n{_metres(share * focus)}")
        shown = _MARGIN * held_radius(row, _HELD)
        axes.imshow(disk_picture(row, shown), extent=(-shown, shown, -shown, shown))
        axes.set_xlabel(f"⌀ {length(2.0 * shown / _MARGIN)}", fontsize=SMALL_SIZE, color=QUIET)


def draw_field_disks(axes_of_fields, configuration, fields_deg):
    """Draw the disks of points of light at infinity away from the axis, by tracing them.

    The lens is focused as for `draw_disks`; the picture's corner is up.

    Parameters
    ----------
    axes_of_fields : sequence of matplotlib.axes.Axes
    configuration : Configuration
    fields_deg : sequence of float
    """
    values = first_order(configuration)
    lens = focused(configuration, _FOCUS_IN_FOCAL_LENGTHS * values.efl - values.h)
    for axes, field_deg in zip(axes_of_fields, fields_deg, strict=True):
        frame_picture(axes)
        _show_traced(axes, lens, field_deg)
        axes.set_xlabel(f"{field_deg:.3g}° from the axis", fontsize=SMALL_SIZE, color=QUIET)


def displayed(density):
    """Encode energy density for the eye: an even disk becomes a middle grey.

    Parameters
    ----------
    density : ndarray of shape (..., channels)
        Integrates to 1 over the unit disk; one channel or three, linear.

    Returns
    -------
    ndarray of shape (..., 3)
        sRGB, 0 to 1.
    """
    linear = np.clip(np.pi * _EVEN_GRAY * np.asarray(density, dtype=float), 0.0, 1.0)
    encoded = np.where(
        linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    )
    return np.broadcast_to(encoded, (*encoded.shape[:-1], 3))


def _show_traced(axes, configuration, source):
    """Draw the light of an object on the sensor; `source` as for `pupil_rays`."""
    axes.set_facecolor("black")
    picture = traced_disk(configuration, source)
    if picture is not None:
        axes.imshow(picture, origin="lower", interpolation="bilinear")


def traced_disk(configuration, source, wavelengths_nm=None):
    """Colours of the light of an object on the sensor.

    Parameters
    ----------
    configuration : Configuration
        Focused.
    source : float or tuple of 3 float
        As for `pupil_rays`.
    wavelengths_nm : sequence of float or None
        None: a few over the spectrum.

    Returns
    -------
    ndarray of shape (P, P, 3) or None
        sRGB; None if nothing gets there.
    """
    wavelengths = spectrum_wavelengths(_TRACED_WAVELENGTHS)
    if wavelengths_nm is not None:
        wavelengths = np.array(wavelengths_nm, dtype=float)
    # Rims cut all colours alike, so far as one sees.
    bundle = pupil_rays(configuration, source, _TRACED_GRID)
    landed = []
    for wavelength in wavelengths:
        traced = trace(configuration, bundle.rays, wavelength)
        places = traced.at_plane(configuration.sensor)[traced.passed]
        if not len(places):
            return None
        landed.append((places, bundle.weights[traced.passed]))
    every = np.concatenate([places for places, _ in landed])
    low, high = np.quantile(every, [1.0 - _HELD, _HELD], axis=0)
    half = max(0.5 * _MARGIN * float((high - low).max()), 1e-6)
    scale = 0.5 * _TRACED_PIXELS / half
    layers = np.stack(
        [_laid_down((places - 0.5 * (low + high) + half) * scale, w) for places, w in landed],
        axis=-1,
    )
    colored = layers @ rgb_weights(wavelengths)
    total = colored.sum(axis=(0, 1))
    return displayed(colored / np.maximum(total, 1e-30) * (_TRACED_PIXELS / 2.0) ** 2)


def _laid_down(places, weights):
    """Spread rays over their four nearest pixels."""
    first = np.floor(places - 0.5)
    share = places - 0.5 - first
    picture = np.zeros(_TRACED_PIXELS * _TRACED_PIXELS)
    for right, above in ((0, 0), (1, 0), (0, 1), (1, 1)):
        x, y = first[:, 0] + right, first[:, 1] + above
        part = np.abs(1 - right - share[:, 0]) * np.abs(1 - above - share[:, 1]) * weights
        inside = (x >= 0) & (x < _TRACED_PIXELS) & (y >= 0) & (y < _TRACED_PIXELS)
        pixel = (y * _TRACED_PIXELS + x)[inside].astype(np.int64)
        picture += np.bincount(pixel, part[inside], minlength=len(picture))
    return picture.reshape(_TRACED_PIXELS, _TRACED_PIXELS)


def held_radius(row, share):
    """Return the radius that holds a share of the energy.

    Parameters
    ----------
    row : PatternRow
    share : float

    Returns
    -------
    float
        mm.
    """
    inside = np.cumsum((ring_areas(len(row.density))[:, None] * row.density).mean(axis=1))
    return row.edges[1 + int(np.searchsorted(inside, share * inside[-1]))]


def disk_picture(row, shown):
    """Draw the pattern of an axial point.

    Parameters
    ----------
    row : PatternRow
    shown : float
        Half the width of the picture, mm.

    Returns
    -------
    ndarray of shape (P, P, 3)
        sRGB.
    """
    place = (np.arange(_DISK_PIXELS) + 0.5) / _DISK_PIXELS * 2.0 - 1.0
    radius = np.hypot(*np.meshgrid(place, place)) * shown
    centres = 0.5 * (row.edges[1:] + row.edges[:-1])
    # In units of the disk that is shown.
    density = row.density * (shown / row.extent) ** 2
    channels = [np.interp(radius, centres, column, right=0.0) for column in density.T]
    return displayed(np.stack(channels, axis=-1))


def _metres(mm):
    return f"{mm / 1000.0:.3g} m" if mm >= 1000.0 else f"{mm / 10.0:.3g} cm"
