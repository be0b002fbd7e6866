"""Blender's properties from the declarations of `settings`."""

from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ...settings.setting import settings_of

_LONGEST_TEXT = 255
_KINDS = {bool: BoolProperty, int: IntProperty, float: FloatProperty, str: StringProperty}


def properties(*sections, callbacks=None, **shared):
    """Return the annotations of a property group that stores the settings of sections.

    Parameters
    ----------
    *sections : settings.setting.Section
    callbacks : dict of str to dict, optional
        By the name of a setting: what only Blender knows of it, such as ``"search"`` or, of a
        pointer, ``"type"``.
    **shared
        What all properties have in common, such as ``update``.

    Returns
    -------
    dict of str
    """
    callbacks = callbacks or {}
    return {
        name: _property(setting, shared | callbacks.get(name, {}))
        for name, setting in settings_of(*sections).items()
    }


def _property(setting, others):
    words = {"name": setting.label, "description": setting.description} | others
    if setting.default is None:
        return PointerProperty(**words)
    words["default"] = setting.default
    if setting.items:
        items = tuple(
            (item.identifier, item.label, item.description, "NONE", item.number)
            for item in setting.items
        )
        return EnumProperty(items=items, **words)
    if isinstance(setting.default, str) and not setting.subtype:
        words |= {"maxlen": _LONGEST_TEXT, "options": set()}
    (least, most), (soft_least, soft_most) = setting.limits, setting.soft
    numbers = {
        "min": least,
        "max": most,
        "soft_min": soft_least,
        "soft_max": soft_most,
        "step": setting.step,
        "precision": setting.precision,
    }
    words |= {name: number for name, number in numbers.items() if number is not None}
    if setting.subtype:
        words["subtype"] = setting.subtype
        if setting.subtype == "FILE_PATH":
            # Else Blender shows a path that starts with // in red.
            words["options"] = {"PATH_SUPPORTS_BLEND_RELATIVE"}
        if setting.subtype.startswith("TIME"):
            words["unit"] = setting.subtype
    return _KINDS[type(setting.default)](**words)
