"""Pictures of lenses as icons: made in the background, kept on disk and in memory."""

from functools import partial

import bpy.utils.previews

from ...lens_bokeh.look.iris_mask import BladedIris
from ..jobs import background

_collection = None
# What the picture of an icon was made of, by the icon's name.
_shown = {}


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


def bokeh_icon_id(camera, lens):
    """Return the icon that shows the bokeh of a camera's lens; asked for if there is none yet.

    While another f-number or zoom position is being drawn, the picture before stays.

    Parameters
    ----------
    camera : bpy.types.Camera
        Its iris is used.
    lens : LensSettings

    Returns
    -------
    int
        0 while there is no picture.
    """
    wanted = _wanted_bokeh(camera, lens)
    return _icon(
        f"bokeh:{camera.session_uid}",
        wanted,
        f"Bokeh of {lens.prescription.name}",
        partial(_draw_bokeh, *wanted),
        urgent=True,
    )


def bokeh_error(camera, lens):
    """Return in one line why there is no picture of the bokeh, or None."""
    return background.error_of(_key(f"bokeh:{camera.session_uid}", _wanted_bokeh(camera, lens)))


def _wanted_bokeh(camera, lens):
    blades = camera.dof.aperture_blades
    # Below three blades Blender's opening is round.
    iris = BladedIris(blades if blades >= 3 else 0, 0.0, camera.dof.aperture_rotation)
    return lens.prescription, lens.label, round(lens.f_number, 3), iris


def _key(name, wanted):
    prescription, *rest = wanted
    # Prescriptions are kept by the library, and compared by identity: they are large.
    return name, id(prescription), *rest


def _icon(name, wanted, label, work, urgent=False):
    if bpy.app.background:
        return 0
    if _shown.get(name) != wanted:
        receive = partial(_show, name, wanted)
        background.submit(_key(name, wanted), label, work, receive, urgent, group=name)
    icon = _icons().get(name)
    return icon.icon_id if icon else 0


# In the background thread, which also imports what they need: Blender starts sooner.


def _draw_thumbnail(*arguments):
    from ...plots.lens_pictures import thumbnail

    return thumbnail(*arguments)


def _draw_bokeh(*arguments):
    from ...plots.lens_pictures import bokeh_sheet

    return bokeh_sheet(*arguments)


def _show(name, wanted, pixels):
    icons = _icons()
    icon = icons.get(name) or icons.new(name)
    height, width, _ = pixels.shape
    icon.image_size = width, height
    icon.image_pixels_float.foreach_set(pixels[::-1].ravel())
    _shown[name] = wanted


def _icons():
    global _collection
    if _collection is None:
        _collection = bpy.utils.previews.new()
    return _collection


def register():
    """Nothing is made before a panel is drawn."""


def unregister():
    """Free the icons."""
    global _collection
    if _collection is not None:
        bpy.utils.previews.remove(_collection)
        _collection = None
    _shown.clear()
