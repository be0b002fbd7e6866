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

import numpy as np

from ...sampling.halton import radical_inverse

# Cost of copying a pixel of a sprite, in triangles. A copy tests and writes depth and colour: some
# 0.07 us on software OpenGL, where a triangle of a scanned mesh takes 0.17 us.
_COPY_COST = 0.4
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


def find_sprites(row, coc, levels, triangles, rectangle, plan, corners=None, moved=None):
    """Group the lens samples that may share drawings of one object.

    Parameters
    ----------
    row : int
    coc : float
        Signed radius of its largest circle of confusion, in pixels along the vertical.
    levels : ndarray of shape (N,)
        int; its level of detail for each sample of the round.
    triangles : sequence of int
        Number of triangles by level.
    rectangle : tuple of 4 int
        x, y, width, height of the part of the raster that it may cover in any sample.
    plan : FramePlan
        Its `reuse_grid` is the number of cells along a pixel; half as many where there is blur.
    corners : ndarray of shape (8, 3), optional
        Corners of its bounding box, in camera space. With chromatic aberration samples share a
        drawing only if all corners fall into the same cells.
    moved : ndarray of shape (N, P, 2), optional
        How the samples of the round move points of it, px, without the jitter: their mean tells
        the cell, and no point may be farther than a cell's side from where the parent has it.

    Returns
    -------
    list of Sprite
        Empty where it costs less to draw every sample.
    """
    if moved is not None:
        jitter, shifts = (part[plan.first :] for part in _jittered(plan))
        moved = moved + jitter[:, None]
        moves = moved.mean(axis=1)
    else:
        if plan.chromatic is None:
            moves, shifts = raster_moves(coc, plan)
        else:
            moves, shifts = corner_moves(corners, plan)
        moves, shifts = moves[plan.first :], shifts[plan.first :]
    grid = plan.reuse_grid if abs(coc) < _BLUR_HIDES_PX else max(1, plan.reuse_grid // 2)
    cells = np.round(moves * grid)
    keys = np.column_stack([levels, cells.astype(np.int64)])
    if moved is not None:
        # A parent's tables are on the device together with those of its members.
        keys = np.column_stack([keys, np.arange(len(keys)) // _TOGETHER])
    if _touches_edge(rectangle, plan):
        # A shifted copy would need pixels from outside the parent's raster.
        keys = np.column_stack([keys, shifts])
    _, cell_of, sizes = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    cell_of = cell_of.ravel()
    sprites = []
    turn = row + plan.first + _SEED_TURNS * (plan.source.seed if plan.source else 0)
    for number, members in _families(cell_of, sizes):
        place = place_in_cell(cells[members[0]], turn + number)
        parent = int(members[_parent(moves[members], place)])
        if moved is not None:
            apart = np.abs(moved[members] - moved[parent]).max(axis=(1, 2))
            members = members[apart * grid <= 1.0]
        level = int(levels[parent])
        pixels = rectangle[2] * rectangle[3]
        drawn = len(members) * triangles[level]
        shared = triangles[level] + (len(members) + 1) * pixels * _COPY_COST
        if shared < (1.0 - _LEAST_SAVING) * drawn:
            offsets = shifts[members] - shifts[parent]
            sprites.append(
                Sprite(
                    row,
                    level,
                    plan.first + parent,
                    {
                        plan.first + int(m): (int(x), int(y))
                        for m, (x, y) in zip(members, offsets, strict=True)
                    },
                    rectangle,
                )
            )
    return sprites


def _families(cell_of, sizes):
    """Yield the samples of each cell, and which of its families they are, in the order of samples.

    Cells of more than `_MOST_MEMBERS` samples are divided, so that the picture comes nearer to the
    true one the more samples there are.
    """
    for cell in np.flatnonzero(sizes > 1):
        members = np.flatnonzero(cell_of == cell)
        count = -(-len(members) // _MOST_MEMBERS)
        for number in range(count):
            yield number, members[number::count]


def _parent(moves, wanted):
    """Return the sample nearest, by rank, to the wanted position in its cell.

    Its place among them, not in the cell: of a cell that they do not fill evenly, such as one under
    the slope of a pixel filter, the parents must be as unevenly spread.
    """
    ranks = np.argsort(np.argsort(moves, axis=0), axis=0)
    far = (ranks + 0.5) / len(moves) - wanted
    # Places at either end are neighbours: all are wanted equally often.
    far -= np.round(far)
    return int(np.argmin(np.square(far).sum(axis=1)))


def place_in_cell(cell, turn):
    """Return where in its cell a parent should be: elsewhere in every row and column of cells.

    Parents in the middle of all cells would look at a raster of one phase: what is thinner than a
    cell would be met too often, or never, however many samples there are.

    Parameters
    ----------
    cell : ndarray of shape (2 M,)
        Whole numbers: the place of the cell along x and y, of M points.
    turn : int
        Of a cell that has several parents, or is met again: each turn is elsewhere.

    Returns
    -------
    ndarray of shape (2 M,)
        0 to 1 along each side of the cell.

    References
    ----------
    Chiu, Shirley and Wang, *Multi-jittered sampling*, Graphics Gems IV, 1994.
    """
    across = cell.reshape(-1, 2)[:, ::-1].astype(np.int64) % _PATTERN
    place = radical_inverse(across, 2) + 0.5 / _PATTERN + turn * _TURN
    return (place % 1.0).ravel()


def _touches_edge(rectangle, plan):
    x, y, width, height = rectangle
    return x <= 0 or y <= 0 or x + width >= plan.width or y + height >= plan.height


def raster_moves(coc, plan):
    """Return the displacement of a point by lens samples and jitter, relative to a pinhole's.

    Parameters
    ----------
    coc : float
        Signed radius of the circle of confusion, in pixels along the vertical.
    plan : FramePlan

    Returns
    -------
    moves : ndarray of shape (N, 2)
        In pixels, without whole pixels of the jitter.
    shifts : ndarray of shape (N, 2)
        int64; those whole pixels.
    """
    jitter = plan.jitter * np.array([plan.width, plan.height]) / 2.0
    shifts = np.round(jitter)
    height = max(plan.lens_extent[1], 1e-30)
    return plan.lens_positions / height * coc + jitter - shifts, shifts.astype(np.int64)


def corner_moves(corners, plan):
    """Return the displacements of a box' corners by lens samples, each at its wavelength.

    Parameters
    ----------
    corners : ndarray of shape (8, 3)
        In camera space, in front of the camera.
    plan : FramePlan

    Returns
    -------
    moves : ndarray of shape (N, 16)
        From the pinhole's picture, in pixels, without whole pixels of the jitter.
    shifts : ndarray of shape (N, 2)
        int64; those whole pixels.
    """
    jitter, shifts = _jittered(plan)
    moved = plan.chromatic.displaced(corners, plan.lens_positions)[..., :2] - corners[:, :2]
    scale = np.diag(plan.projection)[:2] * np.array([plan.width, plan.height]) / 2.0
    if not plan.orthographic:
        scale = scale / -corners[:, 2:]
    moves = moved * scale + jitter[:, None]
    return moves.reshape(len(moves), -1), shifts


def _jittered(plan):
    """Return the jitter of samples without whole pixels, and those, px."""
    jitter = plan.jitter * np.array([plan.width, plan.height]) / 2.0
    shifts = np.round(jitter)
    return jitter - shifts, shifts.astype(np.int64)
