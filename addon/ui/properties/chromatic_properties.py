"""Chromatic aberration settings of a camera, and those remembered for each lens."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    PointerProperty,
    StringProperty,
)

from ...lens_io.glasses.dispersion import DEFAULT_GLASS
from ...lens_io.glasses.glass_catalog import catalog_names
from ...sampling.field_maps import ATOMS
from ..operators.chromatic_curves import curves_as_text, curves_from_text, make_group
from ..previews.spectrum_bar import AplanatSpectrumBar
from .overrides import OVERRIDABLE, setting_changed

_LONGEST_TEXT = 255

# What each atom does, for the menu.
_DESCRIPTIONS = {
    "IDENTITY": "Rises evenly, from 0 in the middle of the picture to 1 in its corners",
    "T2": "Rises towards the corners",
    "T3": "Rises steeply towards the corners",
    "EXP": "Rises from 1 to 2.7",
    "ONE_MINUS": "Falls evenly, from 1 in the middle to 0 in the corners",
    "RECIPROCAL": "Grows without bound towards 0, where it is clamped",
    "COS_T": "A ring of the other sign halfway out",
    "COS_THETA": "From 1 on the right to -1 on the left, whatever the distance from the middle",
    "T_COS_THETA": "Rises to the right, falls to the left",
    "CURVE": "A curve that you draw",
}
_ATOM_ITEMS = tuple((name, text, _DESCRIPTIONS[name]) for name, text in ATOMS.items())


def _curve_wanted(settings, name):
    # Not for a linked camera: then the value was not changed by hand.
    if getattr(settings, name) == "CURVE" and settings.id_data.is_editable:
        make_group(settings)


def _atom_changed(name):
    def update(settings, context):
        _curve_wanted(settings, name)
        setting_changed(settings, context)

    return update


def _equalizer_changed(settings, context):
    if settings.use_equalizer and settings.id_data.is_editable:
        make_group(settings)
    setting_changed(settings, context)


def _found_glasses(settings, _context, typed):
    # Before anything is typed the field holds the glass that is there: then all are wanted.
    typed = "" if typed == settings.glass else typed.casefold()
    return [name for name in catalog_names() if typed in name.casefold()]


def _atom_property(which, stage):
    name = f"{which}_{'then' if stage else 'first'}"
    place = "is done with the outcome of the first step" if stage else "is done first"
    return EnumProperty(
        name="Then" if stage else "First",
        description=f"What {place} with t, which is 0 in the middle of the picture and 1 in its"
        " corners. Theta is the angle around the middle, 0 on the right",
        items=_ATOM_ITEMS,
        default="IDENTITY",
        override=OVERRIDABLE,
        update=_atom_changed(name),
    )


class AplanatChromaticSettings(bpy.types.PropertyGroup):
    """Chromatic aberration settings of a camera."""

    use: BoolProperty(
        name="Chromatic Aberration",
        description="Have the lens bend each color differently, as glass does",
        default=False,
        override=OVERRIDABLE,
        update=setting_changed,
    )
    mode: EnumProperty(
        name="Mode",
        description="Which wavelengths are drawn. Both take as long",
        items=(
            ("RGB", "RGB", "Red, green and blue light of 650, 510 and 475 nm: hard fringes"),
            ("SPECTRAL", "Spectral", "All wavelengths, a different one for each lens sample"),
        ),
        default="SPECTRAL",
        override=OVERRIDABLE,
        update=setting_changed,
    )
    axial: FloatProperty(
        name="Axial",
        description="How differently far away the colors are in focus: 1 as the glass does it, 0"
        " not at all, negative the other way round",
        default=1.0,
        min=-1000.0,
        max=1000.0,
        soft_min=-10.0,
        soft_max=10.0,
        step=10,
        override=OVERRIDABLE,
        update=setting_changed,
    )
    lateral: FloatProperty(
        name="Lateral",
        description="How differently large the pictures of the colors are: 1 as in a simple lens"
        " (2 % in the corners, from violet to red), 0 not at all, negative the other way round",
        default=1.0,
        min=-1000.0,
        max=1000.0,
        soft_min=-10.0,
        soft_max=10.0,
        step=10,
        override=OVERRIDABLE,
        update=setting_changed,
    )
    dispersion: EnumProperty(
        name="Dispersion",
        description="What says how strongly each wavelength is bent",
        items=(
            ("GLASS", "Glass", "A simple lens of one glass"),
            ("LENS", "Real Lens", "The focal shift of the camera's real lens over wavelength"),
        ),
        default="GLASS",
        override=OVERRIDABLE,
        update=setting_changed,
    )
    glass: StringProperty(
        name="Glass",
        description="Glass of the catalog. Flint (F2, N-SF11) parts the colors two to three"
        " times as much as crown (N-BK7)",
        default=DEFAULT_GLASS,
        maxlen=_LONGEST_TEXT,
        options=set(),
        override=OVERRIDABLE,
        search=_found_glasses,
        update=setting_changed,
    )
    wavelength_min: FloatProperty(
        name="Wavelengths",
        description="Shortest wavelength that is drawn, in nm",
        default=380.0,
        min=360.0,
        max=830.0,
        soft_min=380.0,
        soft_max=780.0,
        precision=0,
        step=100,
        override=OVERRIDABLE,
        update=setting_changed,
    )
    wavelength_max: FloatProperty(
        name="To",
        description="Longest wavelength that is drawn, in nm; the focus distance is meant for it",
        default=780.0,
        min=360.0,
        max=830.0,
        soft_min=380.0,
        soft_max=780.0,
        precision=0,
        step=100,
        override=OVERRIDABLE,
        update=setting_changed,
    )
    axial_first: _atom_property("axial", 0)
    axial_then: _atom_property("axial", 1)
    lateral_first: _atom_property("lateral", 0)
    lateral_then: _atom_property("lateral", 1)
    use_equalizer: BoolProperty(
        name="Spectral Equalizer",
        description="Weigh the wavelengths by a curve. What is in focus keeps its color",
        default=False,
        override=OVERRIDABLE,
        update=_equalizer_changed,
    )
    curves: PointerProperty(
        name="Curves",
        description="Holds the curves that are drawn in the panel",
        type=bpy.types.NodeTree,
        options={"HIDDEN"},
        override=OVERRIDABLE,
        update=setting_changed,
    )
    spectrum: PointerProperty(
        name="Spectrum",
        description="Colors under the equalizer's curve",
        type=AplanatSpectrumBar,
        options={"HIDDEN", "SKIP_SAVE"},
    )
    curve_text: StringProperty(
        name="Drawn Curves",
        description="The points of all curves as JSON, for presets",
        get=curves_as_text,
        set=curves_from_text,
        options={"HIDDEN", "SKIP_SAVE"},
    )


# What a preset and a lens keep, in the order in which it is written back: curves last, into a
# group that then exists.
SETTING_NAMES = (
    *("use", "mode", "axial", "lateral", "dispersion", "glass"),
    *("wavelength_min", "wavelength_max", "use_equalizer"),
    *("axial_first", "axial_then", "lateral_first", "lateral_then"),
    "curve_text",
)


def values_as_dict(settings):
    """Return all settings of a camera's chromatic aberration by name."""
    return {name: getattr(settings, name) for name in SETTING_NAMES}


def values_from_dict(settings, values):
    """Set what `values_as_dict` returned; what does not fit is left as it is."""
    for name in SETTING_NAMES:
        if name not in values:
            continue
        try:
            if getattr(settings, name) != values[name]:
                setattr(settings, name, values[name])
        except TypeError:
            # Written by another version.
            continue
