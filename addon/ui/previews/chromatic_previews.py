"""Pictures of field maps as icons: made when a panel is drawn with new values."""

from functools import lru_cache

from ...plots import chromatic_pictures
from .picture_icons import PictureIcons

_SIZE = 160

icons = PictureIcons()
register, unregister = icons.register, icons.unregister


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
        yield chromatic_pictures.map_curve(field_map, shown, _SIZE)[::-1]
        yield chromatic_pictures.map_disc(field_map, shown, aspect, _SIZE)[::-1]

    return icons.icon_ids(f"{which}:{camera.session_uid}", (field_map, aspect), pictures, 2)
