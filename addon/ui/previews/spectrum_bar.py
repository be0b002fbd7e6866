"""The spectrum under the equalizer's curve: a row of colour fields, as wide as the curve.

Blender's layout has no wide pictures; fields of properties fill a row without gaps.
"""

import bpy
import numpy as np
from bpy.props import FloatVectorProperty

from ...plots.chromatic_pictures import encoded, spectrum_colors
from ...scene.camera.drawn_curves import EQUALIZER, EQUALIZER_RANGE_NM, SAMPLES, curve_values
from ..jobs import background

# Fewer would show as steps, more would be narrower than their edges.
FIELDS = 48
_UNKNOWN = (0.5, 0.5, 0.5)

# Linear RGB of each field; filled in the background, once.
_colors = []


def ask_for_colors():
    """Compute the colours of the spectrum in the background, once: it takes a second or two."""
    if not _colors:
        background.submit(
            "spectrum bar",
            "Colors of the spectrum",
            lambda _progress, _cancelled: field_colors(),
            lambda found: _colors.extend(found),
            urgent=True,
        )


def field_colors():
    """Return the colour of each field.

    Returns
    -------
    ndarray of shape (FIELDS, 3)
        Linear RGB.
    """
    colors = spectrum_colors(EQUALIZER_RANGE_NM)
    # Of the wavelengths at its middle; the last colour belongs to the upper end.
    places = (np.arange(FIELDS) + 0.5) / FIELDS * (len(colors) - 1)
    known = np.arange(len(colors))
    return np.stack([np.interp(places, known, column) for column in colors.T], axis=-1)


def _getter(number):
    sample = round((number + 0.5) / FIELDS * (SAMPLES - 1))

    def get(bar):
        if not _colors:
            return _UNKNOWN
        weights = curve_values(bar.id_data.aplanat.chromatic.curves, EQUALIZER)
        weight = 1.0 if weights is None else min(max(weights[sample], 0.0), 1.0)
        return tuple(encoded(_colors[number] * weight).tolist())

    return get


def _ignore(_bar, _value):
    # Without a setter Blender draws a field dimmed.
    pass


def _field(number):
    low, high = EQUALIZER_RANGE_NM
    wavelength = low + (number + 0.5) / FIELDS * (high - low)
    return FloatVectorProperty(
        name=f"{wavelength:.0f} nm",
        description="Light of this wavelength, as strongly as the curve lets it count",
        subtype="COLOR_GAMMA",
        size=3,
        min=0.0,
        max=1.0,
        get=_getter(number),
        set=_ignore,
        options={"SKIP_SAVE"},
    )


def _name(number):
    return f"field_{number}"


class AplanatSpectrumBar(bpy.types.PropertyGroup):
    """Fields of one colour each; nothing is stored."""

    __annotations__ = {_name(number): _field(number) for number in range(FIELDS)}


def draw_spectrum(column, bar):
    """Draw a spectrum and its scale as wide as a column.

    Parameters
    ----------
    column : bpy.types.UILayout
    bar : AplanatSpectrumBar
    """
    ask_for_colors()
    fields = column.row(align=True)
    fields.use_property_split = False
    fields.use_property_decorate = False
    for number in range(FIELDS):
        fields.prop(bar, _name(number), text="")
    low, high = EQUALIZER_RANGE_NM
    scale = column.split(factor=1.0 / 3.0)
    scale.label(text=f"{low:.0f} nm")
    right = scale.split(factor=0.5)
    for wavelength, alignment in ((0.5 * (low + high), "CENTER"), (high, "RIGHT")):
        row = right.row()
        row.alignment = alignment
        row.label(text=f"{wavelength:.0f} nm")
