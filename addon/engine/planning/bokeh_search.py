"""Region and resolution of the search for a frame's highlights.

The raster of the search has a texel for each sub-pixel; only the part where surfaces may exceed the
highlight threshold is drawn, tile by tile (`engine.bokeh.search_tiles`).
"""

import numpy as np

from ...levels.choosing import extents, world_corners
from ...snapshot.brightness import emits, sharpest_gloss
from ...snapshot.surface_graph import Constant

# Of the raster that highlights are searched in, in sub-pixels.
_LARGEST_RASTER = 1 << 26
LEAST_SUBPIXELS, _MOST_SUBPIXELS = 2, 4
# Sub-pixels along a side of a triangle that shines: the light of a lamp of one triangle is then
# found to a few per cent.
_HITS_A_SIDE = 6.0
# Sub-pixels across a single lamp: its light is found to one per cent. The error with m sub-pixels
# on a lamp falls with m^(3/4); that of the sum of k lamps as if each had k^(2/3) times as many.
_HITS_A_LAMP = 45.0
# Sub-pixels across a glint, the image of a lamp in a glossy surface, of all views together: its
# light is found to some per mille. With fewer than one it is found or missed by chance.
_HITS_A_GLINT = 5.0
# Width of the lobe of GGX at half of its height, as angle of the normal over the squared roughness:
# on a ball, glints are half as wide as that angle times the ball.
_LOBE = 2.0 * np.sqrt(np.sqrt(2.0) - 1.0)
# Parallax over the lens beyond which a surface hides no highlight from all of it, px: more than
# hiding_lib.glsl and visibility_lib.glsl ask for.
_HIDING_PARALLAX = 2.0
# Most sub-pixels for the sake of single lamps: along a side of a pixel, and in all.
_FINEST = 64
_FINE_RASTER = 1 << 21
# Roughness below which reflections of lamps may be smaller than a pixel.
_GLINTS_BELOW = 0.3


def graph_of(content, key):
    """Return the `SurfaceGraph` of a surface, given as group and slot."""
    number, slot = key
    return content.materials[content.groups[number].materials[slot]].graph


def emitting(content, shining):
    """Return the surfaces that emit light."""
    return frozenset(key for key in shining if emits(graph_of(content, key)))


def glinting(content, mirroring):
    """Return the mirroring surfaces whose reflections of lamps may be smaller than a pixel."""
    return frozenset(k for k in mirroring if sharpest_gloss(graph_of(content, k)) < _GLINTS_BELOW)


def uneven_groups(content, shining):
    """Return the groups with shining surfaces that are not a single uniform emission."""
    return frozenset(
        key[0]
        for key in shining
        if not all(
            node.kind == "emission"
            and all(isinstance(source, Constant) for _, source in node.inputs)
            for node in graph_of(content, key).nodes
        )
    )


def rows_of(content, shining):
    """Return the rows of the instance table that have shining surfaces, and their groups."""
    groups = [(number, content.groups[number]) for number in sorted({n for n, _ in shining})]
    rows = [np.arange(g.first, g.first + g.count) for _, g in groups]
    of_group = [np.full(g.count, number) for number, g in groups]
    empty = [np.zeros(0, int)]
    return np.concatenate(empty + rows), np.concatenate(empty + of_group)


def corners_of(content, rows):
    """Return the corners of the boxes of instances in the world, shape (R, 8, 3)."""
    bounds = {group.mesh: content.meshes[group.mesh].bounds for group in content.groups}
    return world_corners(content, bounds)[rows]


def rectangles_of(content, rows, plan, projection, size):
    """Return the rectangles of the raster that the bounding boxes of instances cover.

    Parameters
    ----------
    content : SceneContent
    rows : ndarray of shape (R,)
        Of the instance table.
    plan : FramePlan
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the raster.
    size : tuple of 2 int
        Of the raster, px.

    Returns
    -------
    lower, upper : ndarray of shape (K, 2)
        Of the visible boxes, px; of those that reach behind the camera, the whole raster's.
    size : tuple of 2 int
    """
    corners = corners_of(content, rows) @ plan.view[:3, :3].T + plan.view[:3, 3]
    clip = np.concatenate([corners, np.ones((*corners.shape[:2], 1))], axis=2) @ projection.T
    w = clip[..., 3:]
    ahead = (w > 1e-6).all(axis=(1, 2))
    places = (clip[..., :2] / np.where(w > 1e-6, w, 1.0) * 0.5 + 0.5) * size
    lower = np.where(ahead[:, None], places.min(axis=1), 0.0)
    upper = np.where(ahead[:, None], places.max(axis=1), size)
    seen = (w > 1e-6).any(axis=(1, 2)) & (upper > 0.0).all(axis=1) & (lower < size).all(axis=1)
    return lower[seen], upper[seen], size


def deep_projection(content, rows, plan, projection):
    """Return a projection whose depths tell apart surfaces close to one another, shape (4, 4).

    Its clip planes enclose some instances and what may hide them from the whole lens, no more:
    between those of a camera, a near one of millimetres leaves no steps of depth far away.

    Parameters
    ----------
    content : SceneContent
    rows : ndarray of shape (R,)
        Of the instance table.
    plan : FramePlan
    projection : ndarray of shape (4, 4)
        Camera space to clip space, whose clip planes are not exceeded.
    """
    if len(rows) == 0:
        return projection
    planes = _clip_planes(projection, plan.orthographic)
    depth = -(corners_of(content, rows) @ plan.view[2, :3] + plan.view[2, 3])
    nearest, farthest = depth.min(), depth.max()
    move = _HIDING_PARALLAX / max(plan.coc_scale, 1e-30)
    if plan.orthographic:
        nearest = nearest - move * plan.focus_distance
    else:
        nearest = 1.0 / (1.0 / max(nearest, planes[0]) + move)
    # For rounding; of a flat surface across the view, too.
    room = 1e-3 * max(abs(nearest), abs(farthest))
    near, far = max(planes[0], nearest - room), min(planes[1], farthest + room)
    if not near < far:
        return projection
    deep = np.array(projection)
    if plan.orthographic:
        deep[2, 2:] = -2.0 / (far - near), -(far + near) / (far - near)
    else:
        deep[2, 2:] = -(far + near) / (far - near), -2.0 * far * near / (far - near)
    return deep


def _clip_planes(projection, orthographic):
    """Return the depths of the near and the far clip plane, m."""
    slope, offset = projection[2, 2:]
    if orthographic:
        return (offset + 1.0) / slope, (offset - 1.0) / slope
    # In single precision, a far plane many times as far as the near one is infinitely far.
    return offset / (slope - 1.0), offset / (slope + 1.0) if slope < -1.0 else np.inf


def part_of(rectangles):
    """Return the bounding rectangle of all rectangles in the raster: x, y, width, height."""
    lower, upper, size = rectangles
    if len(lower) == 0:
        return (0, 0, 0, 0)
    # A margin of a pixel for rounding.
    x, y = (max(int(np.floor(v)) - 1, 0) for v in lower.min(axis=0))
    right, top = (min(int(np.ceil(v)) + 1, s) for v, s in zip(upper.max(axis=0), size, strict=True))
    return (x, y, right - x, top - y)


def subpixels_of_triangles(content, plan, rows, of_group, size):
    """Return the sub-pixels of the search, so that small emitting triangles have several.

    Parameters
    ----------
    content : SceneContent
    plan : FramePlan
    rows, of_group : ndarray of shape (R,)
        Instances with emitting surfaces, and their groups.
    size : tuple of 2 int
        Of the raster in pixels.

    Returns
    -------
    int
    """
    width, height = size
    seen = extents(corners_of(content, rows), plan.view)
    affordable = int(np.sqrt(_LARGEST_RASTER / (width * height)))
    area = np.array([content.meshes[g.mesh].triangle_area for g in content.groups])[of_group]
    stretch = np.abs(np.linalg.det(content.instances.world[rows, :3, :3].astype(float)))
    side = np.sqrt(area) * np.cbrt(stretch) * plan.projection[1, 1] * plan.height / 2.0
    if not plan.orthographic:
        side = side / np.maximum(seen.center_depth, 1e-3 * plan.focus_distance)
    front = (seen.farthest > 0.0) & (side > 0.0)
    wanted = np.ceil(_HITS_A_SIDE / side[front].min(initial=np.inf)) if front.any() else 0
    return max(1, min(affordable, max(int(min(wanted, _MOST_SUBPIXELS)), LEAST_SUBPIXELS)))


def subpixels_of_lamps(rectangles, part, views=1):
    """Return the sub-pixels of the search, so that small lamps and lit objects keep their light.

    Parameters
    ----------
    rectangles : tuple
        Of the instances that are searched; see `rectangles_of`.
    part : tuple of 4 int
        The part of the raster that is searched.
    views : int, optional
        Places on the lens that it is searched from: they share the sub-pixels.

    Returns
    -------
    int
    """
    return _subpixels(_HITS_A_LAMP, rectangles, 1.0, part, views)


def subpixels_of_glints(rectangles, roughness, part, views=1):
    """Return the sub-pixels of the search, so that glints on round surfaces keep their light.

    Parameters
    ----------
    rectangles, part, views
        As of `subpixels_of_lamps`, of mirroring instances.
    roughness : float
        The least of them.

    Returns
    -------
    int
    """
    # A glint is as small beside its surface as its lobe.
    return _subpixels(_HITS_A_GLINT, rectangles, 0.5 * _LOBE * roughness**2, part, views)


def subpixels_of_mirrors(content, mirroring, rectangles, size, views):
    """Return the sub-pixels that small mirroring objects and small glints need."""
    part = (0, 0, *size)
    found = subpixels_of_lamps(rectangles, part, views)
    if any(light.highlights for light in content.lights):
        gloss = min((sharpest_gloss(graph_of(content, key)) for key in mirroring), default=1.0)
        found = max(found, subpixels_of_glints(rectangles, gloss, part, views))
    return found


def _subpixels(hits, rectangles, share, part, views):
    """Return sub-pixels with which a share of the smallest instance is hit so often; at least 1."""
    lower, upper, _ = rectangles
    if len(lower) == 0:
        return 1
    width = max(share * max(float((upper - lower).max(axis=1).min()), 1e-3), 1e-6)
    wanted = np.ceil(hits / (width * np.cbrt(len(lower)) * np.sqrt(views)))
    affordable = int(np.sqrt(_FINE_RASTER / (max(part[2] * part[3], 1) * views)))
    return max(1, int(min(wanted, affordable, _FINEST)))
