"""Exact areas of small lamps in the raster of the highlight search.

A raster counts texels: a lamp w texels wide covers w of them, or one more or less, in each
direction. The light that is found of a lamp is therefore scaled by the area of its triangles in the
raster over its number of texels. Hidden texels are counted as well, so that a partly hidden lamp
keeps the share of its light that is visible.

The search sees lamps from the middle of the lens, which may see less of them than the rest, such as
the face of a cube but none of its sides. The light is scaled by that as well. What only reflects is
not: its sides differ, and those that parts of the lens do not see stay with the lens samples.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...sampling.thin_lens import projected_areas

# A lamp thinner than this, in texels, may be missed altogether: then those that are found stand for
# those that are missed, and are not scaled.
_LEAST_THICKNESS = 2.0
# The count of lamps longer than this, in texels, is exact to 0.2 %.
_LONGEST = 1024.0
# Most triangles that are measured, those of the first lamps; where there are more, there are so
# many lamps that the errors of their counts cancel in the sum.
_MOST_TRIANGLES = 1 << 21
# Most that the light of an instance grows by what the rest of the lens sees. Where surfaces as a
# whole need more they are not splatted (see `engine.planning.seen_from_edge`); one of many may.
_MOST_GROWTH = 2.0
# Triangles that are measured at once, to bound memory.
_AT_ONCE = 1 << 16


@dataclass(frozen=True, eq=False)
class LampAreas:
    """The areas of instances in a raster.

    Parameters
    ----------
    rows : ndarray of shape (K,)
        Rows of the instance table.
    areas : ndarray of shape (K,)
        Summed area of the triangles, front and back facing, hidden or not, px^2.
    lower, upper : ndarray of shape (K, 2)
        Corners of their bounding rectangle, px.
    growth : ndarray of shape (K,)
        Mean of the area over the lens, relative to that from its middle.
    """

    rows: np.ndarray
    areas: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    growth: np.ndarray

    def in_tile(self, tile, subpixels, count):
        """Return the areas of the instances whose texels are counted in a tile.

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
            In texels; 0 for instances that are not wholly in the tile, so thin that they may be
            missed, or so large that the count is exact.
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

    def growths(self, count):
        """Return the factor of the light of each instance, shape (count,); 1 if unknown."""
        found = np.ones(count)
        found[self.rows] = self.growth
        return found

    def without_growth(self, groups):
        """Return the same areas, where the instances of some groups do not grow.

        Parameters
        ----------
        groups : iterable of InstanceGroup

        Returns
        -------
        LampAreas
        """
        kept = np.zeros(self.rows.max(initial=-1) + 1, bool)
        for group in groups:
            kept[group.first : group.first + group.count] = True
        return replace(self, growth=np.where(kept[self.rows], 1.0, self.growth))

    def any_cut(self, tiles, subpixels, areas):
        """Return whether a tile's edge cuts any instance that is counted.

        Parameters
        ----------
        tiles : list of tuple of 4 int
        subpixels : int
        areas : ndarray of shape (count,)
            Areas of the counted instances; 0 of others.
        """
        if len(tiles) == 1 or not areas.any():
            return False
        found = sum(self.in_tile(tile, subpixels, len(areas)) > 0.0 for tile in tiles)
        return bool((found[areas > 0.0] == 0).any())


NO_AREAS = LampAreas(np.zeros(0, int), np.zeros(0), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0))


def lamp_areas(content, surfaces, plan, projection, size):
    """Measure the areas in the raster of all instances with one of some surfaces.

    Parameters
    ----------
    content : SceneContent
    surfaces : set of (int, int)
        Group and slot; only their triangles count.
    plan : FramePlan
        For its view and lens.
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the raster.
    size : tuple of 2 int
        Of the raster, px.

    Returns
    -------
    LampAreas
        Instances that lie between the near and the far plane.
    """
    budget, found = _MOST_TRIANGLES, [NO_AREAS]
    projection = np.asarray(projection, float)
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
            eye = np.einsum("rab,vb->rva", plan.view @ content.instances.world[rows], points)
            found.append(_areas_of(rows, eye, corners.reshape(-1, 3), plan, projection, size))
    return LampAreas(
        *(
            np.concatenate([getattr(part, name) for part in found])
            for name in ("rows", "areas", "lower", "upper", "growth")
        )
    )


def _areas_of(rows, eye, triangles, plan, projection, size):
    """Measure instances by the corners of their triangles in camera space, shape (R, V, 4)."""
    clip = eye @ projection.T
    w = clip[..., 3]
    whole = ((w > 0.0) & (np.abs(clip[..., 2]) <= w)).all(axis=1)
    rows, eye, clip = rows[whole], eye[whole], clip[whole]
    places = (clip[..., :2] / clip[..., 3:] * 0.5 + 0.5) * size
    a, b, c = (places[:, triangles[:, i]] for i in range(3))
    u, v = b - a, c - a
    areas = 0.5 * np.abs(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]).sum(axis=1)
    corners = eye[:, triangles, :3]
    lens = (plan.focus_distance, plan.lens_extent, plan.orthographic)
    middle, mean = (area.sum(axis=1) for area in projected_areas(corners, *lens))
    growth = np.minimum(mean / np.maximum(middle, 1e-300), _MOST_GROWTH)
    growth = np.where(middle > 0.0, growth, 1.0)
    return LampAreas(rows, areas, places.min(axis=1), places.max(axis=1), growth)
