"""Settings that a camera remembers for each real lens that it has had."""

import json


def values_of(group, names):
    """Return settings by name.

    Parameters
    ----------
    group : bpy.types.PropertyGroup
    names : sequence of str

    Returns
    -------
    dict of str
    """
    return {name: getattr(group, name) for name in names}


def set_values(group, names, values):
    """Set what `values_of` returned; what does not fit is left as it is.

    Parameters
    ----------
    group : bpy.types.PropertyGroup
    names : sequence of str
        Only these are set, in this order.
    values : dict of str
    """
    for name in names:
        if name not in values:
            continue
        try:
            if getattr(group, name) != values[name]:
                setattr(group, name, values[name])
        except (TypeError, ValueError, OverflowError):
            # Written by another version.
            continue


def remember(camera_settings, which, names):
    """Store the settings for the previous lens, and restore those of the present one.

    A lens that was not used before takes over the present settings.

    Parameters
    ----------
    camera_settings : AplanatCameraSettings
        `lens` is the new one; the text ``WHICH_lens`` the one before, ``WHICH_memory`` what is
        remembered.
    which : str
        Name of the group of settings.
    names : sequence of str
        Of the group's settings that belong to a lens, fit for JSON.
    """
    old, new = getattr(camera_settings, f"{which}_lens"), camera_settings.lens
    if old == new:
        return
    group = getattr(camera_settings, which)
    memory = _parsed(getattr(camera_settings, f"{which}_memory"))
    memory[old] = values_of(group, names)
    setattr(camera_settings, f"{which}_memory", json.dumps(memory))
    setattr(camera_settings, f"{which}_lens", new)
    if isinstance(memory.get(new), dict):
        set_values(group, names, memory[new])


def _parsed(text):
    try:
        found = json.loads(text) if text else {}
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}
