"""Which lens samples can share one drawing of an object (methods 4).

Where an object is nearly in focus, many lens samples put it at the same place of the raster. Its
places are rounded to a grid; of the samples in one cell, the one nearest the cell's centre is the
parent: it is drawn once, into a sprite, and copied for all of them. The movement for the pixel
filter counts only by its fraction of a pixel: whole pixels are a shift of the copy.

References
----------
Jeong, Kim and Lee, CGF 2013, section 5.
"""

from dataclasses import dataclass

import numpy as np

# What copying a pixel of a sprite costs, in triangles drawn. A copy tests and writes depth and
# colour; on software OpenGL some 0.07 us, where triangles of scanned meshes take 0.17 us.
_COPY_COST = 0.4
# From this radius on, blur hides a step of the raster twice as long, and there are cells enough for
# smooth edges where the object is sharp: every parent keeps its own movement for the pixel filter.
_BLUR_HIDES_PX = 1.5
# Sprites are worth their copies only if this share of the work is saved.
_LEAST_SAVING = 0.1


@dataclass(frozen=True)
class Sprite:
    """One drawing of an object that several lens samples share.

    Parameters
    ----------
    row : int
        Of the instance table.
    level : int
    parent : int
        The lens sample that it is drawn for.
    members : dict of int to (int, int)
        By lens sample: whole pixels, x and y, by which its copy lies away from the parent's.
    rectangle : tuple of 4 int
        x, y, width, height of what the parent's drawing may cover, in the raster.
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


def find_sprites(row, coc, levels, triangles, rectangle, plan, corners=None):
    """Find the lens samples that may share drawings of one object.

    Parameters
    ----------
    row : int
    coc : float
        Signed radius of its largest circle of confusion, in pixels along the vertical.
    levels : ndarray of shape (N,)
        int; its level for each sample of the round.
    triangles : sequence of int
        By level.
    rectangle : tuple of 4 int
        x, y, width, height of what it may cover in the raster of any sample.
    plan : FramePlan
        Its `reuse_grid` tells the cells along a pixel; half as many where there is blur.
    corners : ndarray of shape (8, 3), optional
        Of its bounding box, in camera space. With chromatic aberration samples share a drawing only
        where they agree on the places of all corners.

    Returns
    -------
    list of Sprite
        Empty where drawing every sample costs less.
    """
    if plan.chromatic is None:
        moves, shifts = raster_moves(coc, plan)
    else:
        moves, shifts = corner_moves(corners, plan)
    moves, shifts = moves[plan.first :], shifts[plan.first :]
    grid = plan.reuse_grid if abs(coc) < _BLUR_HIDES_PX else max(1, plan.reuse_grid // 2)
    cells = np.round(moves * grid)
    distance = np.square(moves * grid - cells).sum(axis=1)
    keys = np.column_stack([levels, cells.astype(np.int64)])
    if _touches_edge(rectangle, plan):
        # A shift would bring in what lies outside the parent's raster.
        keys = np.column_stack([keys, shifts])
    _, cell_of, sizes = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    cell_of = cell_of.ravel()
    sprites = []
    for cell in np.flatnonzero(sizes > 1):
        members = np.flatnonzero(cell_of == cell)
        parent = int(members[np.argmin(distance[members])])
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


def _touches_edge(rectangle, plan):
    x, y, width, height = rectangle
    return x <= 0 or y <= 0 or x + width >= plan.width or y + height >= plan.height


def raster_moves(coc, plan):
    """Return where lens samples put a point, relative to the pinhole's picture.

    Parameters
    ----------
    coc : float
        Signed radius of the circle of confusion, in pixels along the vertical.
    plan : FramePlan

    Returns
    -------
    moves : ndarray of shape (N, 2)
        In pixels, without whole pixels of the movement for the pixel filter.
    shifts : ndarray of shape (N, 2)
        int64; those whole pixels.
    """
    jitter = plan.jitter * np.array([plan.width, plan.height]) / 2.0
    shifts = np.round(jitter)
    height = max(plan.lens_extent[1], 1e-30)
    return plan.lens_positions / height * coc + jitter - shifts, shifts.astype(np.int64)


def corner_moves(corners, plan):
    """Return where lens samples of any wavelength put the corners of a box.

    Parameters
    ----------
    corners : ndarray of shape (8, 3)
        In camera space, in front of the camera.
    plan : FramePlan

    Returns
    -------
    moves : ndarray of shape (N, 16)
        From the pinhole's picture, in pixels, without whole pixels of the movement for the pixel
        filter.
    shifts : ndarray of shape (N, 2)
        int64; those whole pixels.
    """
    jitter = plan.jitter * np.array([plan.width, plan.height]) / 2.0
    shifts = np.round(jitter)
    moved = plan.chromatic.displaced(corners, plan.lens_positions)[..., :2] - corners[:, :2]
    scale = np.diag(plan.projection)[:2] * np.array([plan.width, plan.height]) / 2.0
    if not plan.orthographic:
        scale = scale / -corners[:, 2:]
    moves = moved * scale + (jitter - shifts)[:, None]
    return moves.reshape(len(moves), -1), shifts.astype(np.int64)
