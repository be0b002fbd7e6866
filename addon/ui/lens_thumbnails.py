"""Pictures of lenses as icons: made in the background, kept on disk and in memory."""

import bpy.utils.previews

from ..plots import lens_pictures
from . import background

_collection = None
# Content of the lens of which the icon shows a picture, by id.
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
    if found.lens is None or bpy.app.background:
        return 0
    prescription = found.lens.prescription
    if _shown.get(found.id) is not prescription:
        background.submit(
            ("thumbnail", found.id),
            f"Picture of {found.name}",
            lambda progress, cancelled: lens_pictures.thumbnail(prescription, progress, cancelled),
            lambda pixels: _show(found.id, prescription, pixels),
        )
    icon = _icons().get(found.id)
    return icon.icon_id if icon else 0


def _show(lens_id, prescription, pixels):
    icons = _icons()
    icon = icons.get(lens_id) or icons.new(lens_id)
    height, width, _ = pixels.shape
    icon.image_size = width, height
    icon.image_pixels_float.foreach_set(pixels[::-1].ravel())
    _shown[lens_id] = prescription


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
