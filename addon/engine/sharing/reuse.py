"""Sprites: lens samples that can share one drawing of an object (methods 4).

Where an object is nearly in focus, many lens samples put it at the same place of the raster. The
places are rounded to a grid; of the samples in one cell one is the parent: the object is drawn once
for it, into a sprite, and copied for the others. Of the jitter of the pixel filter only the
fraction of a pixel counts: whole pixels are a shift of the copy.

References
----------
Jeong, Kim and Lee, CGF 2013, section 5.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...sampling.halton import radical_inverse

# Cost of copying a pixel of a sprite, in triangles. A copy tests and writes depth and colour: some
# 0.07 us on software OpenGL, where a triangle of a scanned mesh takes 0.17 us.
_COPY_COST = 0.4
# Cost of a copy whatever its size, in triangles: its draw call and what is set for it, 25 us.
_CALL_COST = 150.0
# From this radius of the circle of confusion on, px, cells may be twice as large: the blur hides
# their steps, and each parent keeps its own jitter of the pixel filter, which smooths sharp edges.
_BLUR_HIDES_PX = 1.5
# Most samples that share a drawing.
_MOST_MEMBERS = 16
# Steps between places in a cell, along x and y: the plastic number's, whose multiples modulo 1 fill
# a square most evenly.
_TURN = np.array([0.7548776662466927, 0.5698402909980532])
# Turns of `place_in_cell` between two seeds: other places, also where cells have many parents.
_SEED_TURNS = 7919
# Rows of cells after which the places of parents in their cells repeat.
_PATTERN = 16
# Samples of which some may share a drawing through a real lens.
_TOGETHER = 64
# Least share of the work that sprites must save to be used.
_LEAST_SAVING = 0.1


@dataclass(frozen=True)
class Sprite:
    """One drawing of an object that several lens samples share.

    Parameters
    ----------
    row : int
        Row of the instance table.
    level : int
        Level of detail.
    parent : int
        The lens sample that it is drawn for.
    members : dict of int to (int, int)
        By lens sample: offset of its copy from the parent's drawing, in whole pixels, x and y.
    rectangle : tuple of 4 int
        x, y, width, height of the part of the raster that the parent's drawing may cover.
    """

    row: int
    level: int
    parent: int
    members: dict[int, tuple[int, int]]
    rectangle: tuple[int, int, int, int]

    @property
    def pixels(self):
        """Number of pixels of the rectangle."""
        return self.rectangle[2] * self.rectangle[3]

    @cached_property
    def last(self):
        """The last lens sample that it is copied for."""
        return max(self.members)


def find_sprites(rows, coc, levels, triangles, rectangles, plan, corners=None, moved=None):
    """Group the lens samples that may share drawings of objects.

    Parameters
    ----------
    rows : ndarray of shape (R,)
        Of the instance table.
    coc : ndarray of shape (R,)
        Signed radius of their largest circle of confusion, in pixels along the vertical.
    levels : ndarray of shape (R, N)
        int; the level of detail for each sample of the round.
    triangles : ndarray of shape (R, L)
        Number of triangles by level.
    rectangles : ndarray of shape (R, 4)
        x, y, width, height of the part of the raster that each may cover in any sample.
    plan : FramePlan
        Its `reuse_grid` is the number of cells along a pixel; half as many where there is blur.
    corners : ndarray of shape (R, 8, 3), optional
        Corners of the bounding boxes, in camera space. With chromatic aberration samples share a
        drawing only if all corners fall into the same cells.
    moved : ndarray of shape (R, N, P, 2), optional
        How the samples of the round move points of each, px, without the jitter: their mean tells
        the cell, and no point may be farther than a cell's side from where the parent has it.

    Returns
    -------
    list of Sprite
        In the order of rows; none where it costs less to draw every sample.
    """
    if len(rows) == 0:
        return []
    part = slice(plan.first, None)
    if moved is not None:
        jitter, shifts = (found[part] for found in _jittered(plan))
        moved = moved + jitter[:, None]
        moves = moved.mean(axis=2)
    elif plan.chromatic is None:
        moves, shifts = (found[part] for found in raster_moves(coc, plan))
        moves = moves.swapaxes(0, 1)
    else:
        moves, shifts = (found[part] for found in corner_moves(corners, plan))
        moves = moves.swapaxes(0, 1)
    grids = np.where(np.abs(coc) < _BLUR_HIDES_PX, plan.reuse_grid, max(1, plan.reuse_grid // 2))
    cells = np.round(moves * grids[:, None, None]).astype(np.int64)
    row_of, sample_of = (places.ravel() for places in np.indices(levels.shape))
    keys = [row_of, levels.ravel(), *cells.reshape(len(row_of), -1).T]
    if moved is not None:
        # A parent's tables are on the device together with those of its members.
        keys.append(sample_of // _TOGETHER)
    # A shifted copy would need pixels from outside the parent's raster.
    at_edge = _touch_edge(rectangles, plan)
    keys += [(at_edge[:, None] * shift).ravel() for shift in shifts.T]
    pixels = rectangles[:, 2] * rectangles[:, 3]

    def pays(row, level, members):
        return sharing_pays(triangles[row, level], pixels[row], members)

    order, family, number = _families(keys)
    sizes = np.bincount(family)
    first = order[np.concatenate([[0], np.cumsum(sizes)[:-1]])]
    kept = pays(row_of[first], levels.ravel()[first], sizes)[family]
    order, number = order[kept], number[kept]
    family = np.unique(family[kept], return_inverse=True)[1]
    if len(order) == 0:
        return []
    moves, cells = (values.reshape(len(row_of), -1)[order] for values in (moves, cells))
    starts = np.flatnonzero(np.diff(family, prepend=-1))
    turns = rows[row_of[order]] + plan.first + number
    turns = turns + _SEED_TURNS * (plan.source.seed if plan.source else 0)
    wanted = places_in_cells(cells[starts], turns[starts])
    parents = order[_parents(moves, family, wanted)][family]
    if moved is not None:
        moved = moved.reshape(len(row_of), -1)
        apart = np.abs(moved[order] - moved[parents]).max(axis=1)
        near = apart * grids[row_of[order]] <= 1.0
        order, parents = order[near], parents[near]
        starts = np.flatnonzero(np.diff(family[near], prepend=-1))
    ends = np.append(starts[1:], len(order))
    row, level = row_of[order[starts]], levels.ravel()[parents[starts]]
    offsets = (shifts[sample_of[order]] - shifts[sample_of[parents]]).tolist()
    members = (plan.first + sample_of[order]).tolist()
    return [
        Sprite(
            int(rows[row[i]]),
            int(level[i]),
            int(plan.first + sample_of[parents[starts[i]]]),
            {members[j]: tuple(offsets[j]) for j in range(starts[i], ends[i])},
            tuple(rectangles[row[i]].tolist()),
        )
        for i in np.flatnonzero(pays(row, level, ends - starts)).tolist()
    ]


def sharing_pays(triangles, pixels, members=_MOST_MEMBERS):
    """Return whether one drawing and its copies cost less than a drawing for each sample.

    Parameters
    ----------
    triangles, pixels : ndarray of shape (...)
        Of the object, and of the rectangle that it may cover.
    members : ndarray of shape (...), optional
        Number of samples that share it; fewer never pay where these do not.
    """
    drawn = members * triangles
    shared = triangles + (members + 1) * (pixels * _COPY_COST + _CALL_COST)
    return shared < (1.0 - _LEAST_SAVING) * drawn


def _families(keys):
    """Sort elements into families of equal keys, of `_MOST_MEMBERS` at most.

    Cells of more samples are divided, so that the picture comes nearer to the true one the more
    samples there are.

    Parameters
    ----------
    keys : sequence of ndarray of shape (E,)

    Returns
    -------
    order, family, number : ndarray of shape (E,)
        The elements, one family after the other; which family each belongs to; and which of its
        cell's families that is.
    """
    order = np.lexsort(keys[::-1])
    begins = np.zeros(len(order), bool)
    begins[0] = True
    for key in keys:
        sorted_key = key[order]
        begins[1:] |= sorted_key[1:] != sorted_key[:-1]
    cell = np.cumsum(begins) - 1
    sizes = np.bincount(cell)
    counts = -(-sizes // _MOST_MEMBERS)
    place = np.arange(len(order)) - np.flatnonzero(begins)[cell]
    number = place % counts[cell]
    family = (np.cumsum(counts) - counts)[cell] + number
    within = np.argsort(family, kind="stable")
    return order[within], family[within], number[within]


def _parents(moves, family, wanted):
    """Return of each family the element nearest, by rank, to the wanted position in its cell.

    Its place among them, not in the cell: of a cell that they do not fill evenly, such as one under
    the slope of a pixel filter, the parents must be as unevenly spread.
    """
    starts = np.flatnonzero(np.diff(family, prepend=-1))
    sizes = np.bincount(family)[family]
    far = np.zeros(len(family))
    for move, place in zip(moves.T, wanted.T, strict=True):
        ranks = np.empty(len(family))
        ranks[np.lexsort((move, family))] = np.arange(len(family)) - starts[family]
        away = (ranks + 0.5) / sizes - place[family]
        # Places at either end are neighbours: all are wanted equally often.
        away -= np.round(away)
        far += np.square(away)
    return np.lexsort((far, family))[starts]


def places_in_cells(cells, turns):
    """Return where in its cell a parent should be: elsewhere in every row and column of cells.

    Parents in the middle of all cells would look at a raster of one phase: what is thinner than a
    cell would be met too often, or never, however many samples there are.

    Parameters
    ----------
    cells : ndarray of shape (F, 2 M)
        Whole numbers: the place of each cell along x and y, of M points.
    turns : ndarray of shape (F,)
        int; of a cell that has several parents, or is met again: each turn is elsewhere.

    Returns
    -------
    ndarray of shape (F, 2 M)
        0 to 1 along each side of the cell.

    References
    ----------
    Chiu, Shirley and Wang, *Multi-jittered sampling*, Graphics Gems IV, 1994.
    """
    across = cells.reshape(len(cells), -1, 2)[..., ::-1] % _PATTERN
    places = radical_inverse(across, 2) + 0.5 / _PATTERN + turns[:, None, None] * _TURN
    return (places % 1.0).reshape(cells.shape)


def _touch_edge(rectangles, plan):
    x, y, width, height = rectangles.T
    return (x <= 0) | (y <= 0) | (x + width >= plan.width) | (y + height >= plan.height)


def raster_moves(coc, plan):
    """Return the displacements of points by lens samples and jitter, relative to a pinhole's.

    Parameters
    ----------
    coc : ndarray of shape (R,)
        Signed radii of the circles of confusion, in pixels along the vertical.
    plan : FramePlan

    Returns
    -------
    moves : ndarray of shape (N, R, 2)
        In pixels, without whole pixels of the jitter.
    shifts : ndarray of shape (N, 2)
        int64; those whole pixels.
    """
    jitter, shifts = _jittered(plan)
    across = plan.lens_positions / max(plan.lens_extent[1], 1e-30)
    return across[:, None] * coc[:, None] + jitter[:, None], shifts


def corner_moves(corners, plan):
    """Return the displacements of boxes' corners by lens samples, each at its wavelength.

    Parameters
    ----------
    corners : ndarray of shape (R, 8, 3)
        In camera space, in front of the camera.
    plan : FramePlan

    Returns
    -------
    moves : ndarray of shape (N, R, 16)
        From the pinhole's picture, in pixels, without whole pixels of the jitter.
    shifts : ndarray of shape (N, 2)
        int64; those whole pixels.
    """
    jitter, shifts = _jittered(plan)
    points = corners.reshape(-1, 3)
    moved = plan.chromatic.displaced(points, plan.lens_positions)[..., :2] - points[:, :2]
    scale = np.diag(plan.projection)[:2] * np.array([plan.width, plan.height]) / 2.0
    if not plan.orthographic:
        scale = scale / -points[:, 2:]
    moves = moved * scale + jitter[:, None]
    return moves.reshape(len(moves), len(corners), 16), shifts


def _jittered(plan):
    """Return the jitter of samples without whole pixels, and those, px."""
    jitter = plan.jitter * np.array([plan.width, plan.height]) / 2.0
    shifts = np.round(jitter)
    return jitter - shifts, shifts.astype(np.int64)
