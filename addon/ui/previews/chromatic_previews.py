"""Pictures of field maps as icons: made when a panel is drawn with new values."""

from functools import lru_cache

import bpy.utils.previews
import numpy as np

from ...plots import chromatic_pictures

_SIZE = 160

_collection = None
# What the pictures of a name were made of.
_shown = {}


# Memo of the map alone, which is drawn anew at every redraw of the panel.
@lru_cache(maxsize=16)
def shown_range(field_map):
    """Return the lowest and the highest value in the pictures of a map."""
    return chromatic_pictures.map_range(field_map)


def map_icons(camera, which, field_map, aspect):
    """Return the icons that show a field map: as a curve and as a disc.

    Parameters
    ----------
    camera : bpy.types.Camera
        Each has icons of its own.
    which : str
        Names the map.
    field_map : FieldMap
        The same object as long as it is the same map.
    aspect : float
        Width over height of the picture.

    Returns
    -------
    tuple of 2 int
        0 in a Blender without windows.
    """

    def pictures():
        shown = shown_range(field_map)
        yield chromatic_pictures.map_curve(field_map, shown, _SIZE)
        yield chromatic_pictures.map_disc(field_map, shown, aspect, _SIZE)

    return _icons_of(f"{which}:{camera.session_uid}", (field_map, aspect), pictures, 2)


def _icons_of(name, key, pictures, count):
    if bpy.app.background:
        return (0,) * count
    if _shown.get(name) != key:
        for number, picture in enumerate(pictures()):
            _draw(f"{name}:{number}", picture)
        _shown[name] = key
    collection = _icons()
    return tuple(collection[f"{name}:{number}"].icon_id for number in range(count))


def _draw(name, picture):
    icons = _icons()
    icon = icons.get(name) or icons.new(name)
    height, width, _ = picture.shape
    icon.image_size = width, height
    icon.image_pixels_float.foreach_set(np.ascontiguousarray(picture[::-1]).ravel())


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
