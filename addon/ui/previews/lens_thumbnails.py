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


def bokeh_icon_id(camera, lens, opening):
    """Return the icon that shows the bokeh of a camera's lens; asked for if there is none yet.

    While another f-number or zoom position is being drawn, the picture before stays.

    Parameters
    ----------
    camera : bpy.types.Camera
    lens : LensSettings
    opening : BladedIris or PictureIris
        Of `read_opening`.

    Returns
    -------
    int
        0 while there is no picture.
    """
    wanted = _wanted_bokeh(lens, opening)
    return _icon(
        f"bokeh:{camera.session_uid}",
        wanted,
        f"Bokeh of {lens.prescription.name}",
        partial(_draw_bokeh, *wanted),
        urgent=True,
    )


def bokeh_error(camera, lens, opening):
    """Return in one line why there is no picture of the bokeh, or None."""
    return background.error_of(_key(f"bokeh:{camera.session_uid}", _wanted_bokeh(lens, opening)))


def _wanted_bokeh(lens, opening):
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


def _show(name, wanted, pixels):
    icons.show(name, wanted, pixels[::-1])
