"""What steps of migrations share: a stored setting under another name, with keys and drivers."""

import bpy


def move(stored, old, new):
    """Move a stored value, unless there is none or its new place is taken.

    Parameters
    ----------
    stored : bpy.types.PropertyGroup
        As `migrations.stored_settings` returns it.
    old, new : str
        Names, with a dot after each group; groups of `new` are made where missing.

    Returns
    -------
    bool
        Whether it was moved. What is stored under `old` stays otherwise.
    """
    source, name = _group(stored, old, make=False)
    if source is None or name not in source:
        return False
    target, new_name = _group(stored, new, make=True)
    if new_name in target:
        return False
    target[new_name] = source[name]
    del source[name]
    return True


def _group(stored, path, make):
    *groups, name = path.split(".")
    for group in groups:
        if group not in stored:
            if not make:
                return None, name
            stored[group] = {}
        stored = stored[group]
    return stored, name


def move_animation(block, old, new):
    """Let keyframes and drivers of a data-block's setting drive it under its new name.

    An action that several data-blocks share is changed with the first of them.

    Parameters
    ----------
    block : bpy.types.ID
    old, new : str
        Names as in `move`.
    """
    animation = getattr(block, "animation_data", None)
    if animation is None:
        return
    curves = list(animation.drivers)
    strips = [strip for track in animation.nla_tracks for strip in track.strips]
    for user in (animation, *strips):
        if user.action is not None and user.action_slot is not None:
            curves += _curves(user.action, user.action_slot)
    old_path, new_path = (f"aplanat.{name}" for name in (old, new))
    for curve in curves:
        if curve.data_path == old_path:
            curve.data_path = new_path


def _curves(action: bpy.types.Action, slot):
    for layer in action.layers:
        for strip in layer.strips:
            bag = strip.channelbag(slot)
            if bag is not None:
                yield from bag.fcurves
