"""Pictures of field maps as icons: made when a panel is drawn with new values."""

from dataclasses import dataclass
from functools import lru_cache

from ...plots import chromatic_pictures
from .picture_icons import PictureIcons

_SIZE = 160

icons = PictureIcons()
register, unregister = icons.register, icons.unregister


@dataclass(frozen=True)
class Share:
    """How much of a strength is left over the field; called as a `FieldMap`.

    Parameters
    ----------
    field_map : FieldMap
    falls : bool
        The map is what is taken away (of axial aberration), not what is left (of lateral).
    """

    field_map: object
    falls: bool

    def __call__(self, t, theta):
        """Return the share at ``t`` and ``theta``, as `FieldMap`."""
        values = self.field_map(t, theta)
        return 1.0 - values if self.falls else values

    @property
    def text(self):
        """The share as a formula."""
        told = f"1 - ({self.field_map.text})" if self.falls else self.field_map.text
        return f"{told}, clamped" if self.field_map.clamped else told


def share_of_strength(which, field_map):
    """Return what the map of ``"axial"`` or ``"lateral"`` aberration leaves, as `Share`."""
    return Share(field_map, falls=which == "axial")


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
    field_map : Share
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
