"""Pictures of lenses as icons: made in the background, kept on disk and in memory."""

from functools import partial

import bpy

from ..jobs import background
from .picture_icons import PictureIcons

icons = PictureIcons()
register, unregister = icons.register, icons.unregister


def icon_id(found):
    """Return the icon of a lens; its picture is asked for if there is none yet.

    Parameters
    ----------
    found : ShelvedLens

    Returns
    -------
    int
        0 while there is no picture.
    """
    if found.lens is None:
        return 0
    prescription = found.lens.prescription
    return _icon(
        f"lens:{found.id}",
        (prescription,),
        f"Picture of {found.name}",
        partial(_draw_thumbnail, prescription),
    )


def reserved_icon_id(found):
    """Return the icon of a lens as `icon_id`, but of a number that stays while it is being made."""
    if bpy.app.background or found.lens is None:
        return 0
    return icon_id(found) or icons.reserved_id(f"lens:{found.id}")


def bokeh_icon_id(camera, state, place):
    """Return the icon that shows the bokeh of a lens; asked for if there is none yet.

    While another f-number or zoom position is being drawn, the picture before stays.

    Parameters
    ----------
    camera : bpy.types.Camera
    state : tuple
        As `state_of` returns it.
    place : int
        0 for the camera's lens, 1 for that it is compared with.

    Returns
    -------
    int
        0 while there is no picture.
    """
    return _icon(
        f"bokeh:{camera.session_uid}:{place}",
        state,
        f"Bokeh of {state[0].name}",
        partial(_draw_bokeh, *state),
        urgent=True,
    )


def bokeh_error(camera, state, place):
    """Return in one line why there is no picture of the bokeh, or None."""
    return background.error_of(_key(f"bokeh:{camera.session_uid}:{place}", state))


def diagram_icon_ids(camera, states):
    """Return the icons of the diagrams of sharpness and light, of one or two lenses in each.

    Parameters
    ----------
    camera : bpy.types.Camera
    states : tuple of tuple
        As `state_of` returns them.

    Returns
    -------
    tuple of 2 int
        0 while there is no picture.
    """
    if bpy.app.background:
        return 0, 0
    name = f"diagrams:{camera.session_uid}"
    if icons.shown.get(f"{name}:0") != states:
        label = " and ".join(state[0].name for state in states)
        key = (name, *(part for state in states for part in _key("", state)))
        receive = partial(_show_diagrams, name, states)
        work = partial(_draw_diagrams, states)
        background.submit(key, f"Diagrams of {label}", work, receive, True, group=name)
    return icons.icon_id(f"{name}:0"), icons.icon_id(f"{name}:1")


def state_of(lens, opening):
    """Return what pictures of a lens are made of.

    Parameters
    ----------
    lens : LensSettings
    opening : BladedIris or PictureIris
        Of `read_opening`.

    Returns
    -------
    tuple
        Prescription, zoom position, f-number, opening.
    """
    return lens.prescription, lens.label, round(lens.f_number, 3), opening


def _key(name, wanted):
    prescription, *rest = wanted
    # Prescriptions are kept by the library, and compared by identity: they are large.
    return name, id(prescription), *rest


def _icon(name, wanted, label, work, urgent=False):
    if bpy.app.background:
        return 0
    if icons.shown.get(name) != wanted:
        receive = partial(_show, name, wanted)
        background.submit(_key(name, wanted), label, work, receive, urgent, group=name)
    return icons.icon_id(name)


# In the background thread, which also imports what they need: Blender starts sooner.


def _draw_thumbnail(*arguments):
    from ...plots.lens_pictures import thumbnail

    return thumbnail(*arguments)


def _draw_bokeh(*arguments):
    from ...plots.lens_pictures import bokeh_sheet

    return bokeh_sheet(*arguments)


def _draw_diagrams(states, *arguments):
    from ...plots.comparison import LensState, diagrams

    return diagrams([LensState(*state) for state in states], *arguments)


def _show_diagrams(name, wanted, pictures):
    for order, pixels in enumerate(pictures):
        _show(f"{name}:{order}", wanted, pixels)


def _show(name, wanted, pixels):
    icons.show(name, wanted, pixels[::-1])
