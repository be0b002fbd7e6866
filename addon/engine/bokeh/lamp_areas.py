"""How large lamps are in the raster that highlights are searched in.

A raster counts texels: of an even lamp w texels wide it finds w, or one more or less, in each
direction. What is counted of a lamp is therefore brought to the area that its triangles have in the
raster. Only the count of what nothing hides is compared, so that a lamp that is partly hidden keeps
the share of its light that is seen.
"""

from dataclasses import dataclass

import numpy as np

# A lamp that is thinner than this, in texels, may be missed as a whole: what is found of those that
# are met stands for the others.
_LEAST_THICKNESS = 2.0
# Of lamps that are longer than this, in texels, the count is within 0.2 %.
_LONGEST = 1024.0
# Triangles that are measured, those of the first lamps; of more lamps than have so many, the errors
# of the counts cancel in the sum.
_MOST_TRIANGLES = 1 << 21
# Triangles that are measured at once, for the memory that it takes.
_AT_ONCE = 1 << 16


@dataclass(frozen=True, eq=False)
class LampAreas:
    """The areas of instances in a raster.

    Parameters
    ----------
    rows : ndarray of shape (K,)
        Of the instance table.
    areas : ndarray of shape (K,)
        Sum over the triangles, whichever way they face and whatever hides them, px^2.
    lower, upper : ndarray of shape (K, 2)
        Of the rectangle that holds them, px.
    """

    rows: np.ndarray
    areas: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    def in_tile(self, tile, subpixels, count):
        """Return the areas of those whose texels are counted in a tile.

        Parameters
        ----------
        tile : tuple of 4 int
            x, y, width and height in pixels of the raster.
        subpixels : int
            Texels along a side of a pixel.
        count : int
            Rows of the instance table.

        Returns
        -------
        ndarray of shape (count,)
            In texels; 0 of those that are not wholly in the tile, or so thin that all their texels
            may be missed, or so large that the count is right as it is.
        """
        x, y, width, height = tile
        inside = (self.lower >= (x, y)).all(axis=1)
        inside &= (self.upper <= (x + width, y + height)).all(axis=1)
        length = (self.upper - self.lower).max(axis=1, initial=0.0) * subpixels
        areas = self.areas * subpixels**2
        used = inside & (length <= _LONGEST) & (areas >= _LEAST_THICKNESS * length)
        found = np.zeros(count)
        found[self.rows[used]] = areas[used]
        return found

    def any_cut(self, tiles, subpixels, areas):
        """Return whether a tile's edge cuts any instance that is counted.

        Parameters
        ----------
        tiles : list of tuple of 4 int
        subpixels : int
        areas : ndarray of shape (count,)
            Of those that are counted; 0 of others.
        """
        if len(tiles) == 1 or not areas.any():
            return False
        found = sum(self.in_tile(tile, subpixels, len(areas)) > 0.0 for tile in tiles)
        return bool((found[areas > 0.0] == 0).any())


NO_AREAS = LampAreas(np.zeros(0, int), np.zeros(0), np.zeros((0, 2)), np.zeros((0, 2)))


def lamp_areas(content, surfaces, view, projection, size):
    """Measure the instances that have any of some surfaces.

    Parameters
    ----------
    content : SceneContent
    surfaces : set of (int, int)
        Group and slot; only their triangles count.
    view, projection : ndarray of shape (4, 4)
        World to camera space, and that to clip space of the raster.
    size : tuple of 2 int
        Of the raster, px.

    Returns
    -------
    LampAreas
        Of those that lie between the near and the far plane.
    """
    budget, found = _MOST_TRIANGLES, [NO_AREAS]
    to_clip = np.asarray(projection, float) @ view
    for number in sorted({number for number, _ in surfaces}):
        group = content.groups[number]
        mesh = content.meshes[group.mesh]
        parts = [
            mesh.triangles[first : first + count]
            for slot, first, count in mesh.slots
            if (number, slot) in surfaces
        ]
        triangles = np.concatenate([np.zeros((0, 3), int), *parts])
        measured = min(group.count, budget // max(len(triangles), 1))
        if len(triangles) == 0 or measured == 0:
            continue
        budget -= measured * len(triangles)
        used, corners = np.unique(triangles, return_inverse=True)
        points = np.column_stack([mesh.positions[used], np.ones(len(used))])
        at_once = max(1, _AT_ONCE // len(triangles))
        for first in range(0, measured, at_once):
            rows = group.first + np.arange(first, min(first + at_once, measured))
            clip = np.einsum("rab,vb->rva", to_clip @ content.instances.world[rows], points)
            found.append(_areas_of(rows, clip, corners.reshape(-1, 3), size))
    return LampAreas(
        *(
            np.concatenate([getattr(part, name) for part in found])
            for name in ("rows", "areas", "lower", "upper")
        )
    )


def _areas_of(rows, clip, triangles, size):
    """Measure instances by the corners of their triangles in clip space, shape (R, V, 4)."""
    w = clip[..., 3]
    whole = ((w > 0.0) & (np.abs(clip[..., 2]) <= w)).all(axis=1)
    rows, clip = rows[whole], clip[whole]
    places = (clip[..., :2] / clip[..., 3:] * 0.5 + 0.5) * size
    a, b, c = (places[:, triangles[:, i]] for i in range(3))
    u, v = b - a, c - a
    areas = 0.5 * np.abs(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]).sum(axis=1)
    return LampAreas(rows, areas, places.min(axis=1), places.max(axis=1))
