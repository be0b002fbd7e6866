"""Chromatic aberration of a camera: what is stored."""

import bpy
from bpy.props import PointerProperty, StringProperty

from ...lens_io.glasses.glass_catalog import catalog_names
from ...settings.chromatic_settings import CHROMATIC, MAPS
from ...settings.setting import kept_names, settings_of
from ..operators.chromatic_curves import curves_as_text, curves_from_text, make_group
from ..previews.spectrum_bar import AplanatSpectrumBar
from .declared import properties
from .overrides import OVERRIDABLE, SHARED, setting_changed


def _curve_wanted(settings, name):
    # Not for a linked camera: then the value was not changed by hand.
    if getattr(settings, name) == "CURVE" and settings.id_data.is_editable:
        make_group(settings)


def _atom_changed(name):
    def update(settings, context):
        _curve_wanted(settings, name)
        setting_changed(settings, context)

    return update


def _use_changed(settings, context):
    if settings.id_data.is_editable:
        # Files in which it is not stored are older, and mean another light (`migration_steps`).
        settings.focus_light = settings.focus_light
    setting_changed(settings, context)


def _equalizer_changed(settings, context):
    if settings.use_equalizer and settings.id_data.is_editable:
        make_group(settings)
    setting_changed(settings, context)


def _found_glasses(settings, _context, typed):
    # Before anything is typed the field holds the glass that is there: then all are wanted.
    typed = "" if typed == settings.glass else typed.casefold()
    return [name for name in catalog_names() if typed in name.casefold()]


_CALLBACKS = {
    **{name: {"update": _atom_changed(name)} for name in settings_of(MAPS)},
    "use": {"update": _use_changed},
    "use_equalizer": {"update": _equalizer_changed},
    "glass": {"search": _found_glasses},
}


class AplanatChromaticSettings(bpy.types.PropertyGroup):
    """How colors part in a camera."""

    __annotations__ = properties(*CHROMATIC, callbacks=_CALLBACKS, **SHARED) | {
        "curves": PointerProperty(
            name="Curves",
            description="Holds the curves that are drawn in the panel",
            type=bpy.types.NodeTree,
            options={"HIDDEN"},
            override=OVERRIDABLE,
            update=setting_changed,
        ),
        "spectrum": PointerProperty(
            name="Spectrum",
            description="Colors under the equalizer's curve",
            type=AplanatSpectrumBar,
            options={"HIDDEN", "SKIP_SAVE"},
        ),
        "curve_text": StringProperty(
            name="Drawn Curves",
            description="The points of all curves as JSON, for presets",
            get=curves_as_text,
            set=curves_from_text,
            options={"HIDDEN", "SKIP_SAVE"},
        ),
    }


# What a preset and a lens keep, in the order in which it is written back: curves last, into a
# group that then exists.
SETTING_NAMES = (*kept_names(*CHROMATIC), "curve_text")
