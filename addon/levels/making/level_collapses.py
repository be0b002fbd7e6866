"""Edge collapses: which places of a mesh merge into one in the next level of detail.

fast-simplification decides the collapses. It holds the interpreter lock while it works, so a large
mesh is given to it in patches; their rims are kept, and lie elsewhere in the next level. It never
moves a border's vertex inwards, so a mesh of many holes would not be simplified: holes are closed
by cones first, whose steep sides hold the border as Garland's perpendicular planes do, while a
small hole may vanish.
"""

import threading
from dataclasses import dataclass

import numpy as np

from .level_parts import paired, small_parts
from .level_surface import borders, connected, numbered

# Scaled edge length: fast-simplification's thresholds begin at 2e-6 in squared lengths, so edges
# must be much longer for the best collapses to come first.
_EDGE_LENGTH = 0.5
# Triangles of a patch: some 20 ms of work, and its data fit into a cache.
_PATCH = 32_000
# Least area of a triangle that takes part, in mean areas.
_LEAST_AREA = 1e-9
# Height of the cone over a hole, in radii of the hole.
_CONE_HEIGHT = 3.0

# The library keeps its mesh in global variables.
_library = threading.Lock()


@dataclass(frozen=True, eq=False)
class Halving:
    """The collapses from one level to the next.

    Parameters
    ----------
    places : ndarray of shape (V,)
        int32; the place of each vertex: those of one place are the sides of a seam.
    groups : ndarray of shape (P,)
        int32; the place that each place merges into, in the next level.
    seams : ndarray of shape (E, 2)
        int32; places at the ends of edges where more than normals change.
    """

    places: np.ndarray
    groups: np.ndarray
    seams: np.ndarray


def decimate(surface, triangles, slots=(), check=None):
    """Choose the collapses of places for the next level.

    Parameters
    ----------
    surface : Surface
    triangles : int
        Number of triangles to leave.
    slots : sequence of (int, int, int), optional
        Material slot, first triangle and count, of the mesh.
    check : callable, optional
        Called before each patch; it may raise to end the work.

    Returns
    -------
    Halving
    """
    points, faces, normal = surface.points, surface.faces, surface.normal
    # A triangle without area has no plane, and its quadric error would be NaN.
    proper = surface.size > _LEAST_AREA * surface.size.mean()
    small, of_face = small_parts(surface)
    pairs = np.empty((0, 2), np.int64)
    if small.any():
        proper &= ~small[of_face]
        pairs = paired(surface, small, of_face, slots)
    left = triangles / max(len(faces), 1)
    if proper.all():
        border, owner = surface.borders
    else:
        faces, normal = faces[proper], normal[:, proper]
        border, owner = borders(faces, len(points))
    if len(faces) == 0:
        groups = _groups(pairs, len(points), 0)
        return Halving(surface.places, groups, surface.seams)
    scaled = _scaled(surface, points, faces)
    apexes, cones = _cones(scaled, border, owner, normal)
    left = left * len(faces) + len(cones) // 2
    faces = np.concatenate([faces, cones]).astype(np.int32, copy=False)
    scaled = np.concatenate([scaled, apexes])
    share = min(left / len(faces), 1.0)
    collapses = [pairs]
    for patch in _patches(scaled, faces):
        if check is not None:
            check()
        collapses.append(_collapse(scaled, faces[patch], share, len(patch) < len(faces)))
    groups = _groups(np.concatenate(collapses), len(points), len(apexes))
    return Halving(surface.places, groups, surface.seams)


def _scaled(surface, points, faces):
    """Scale every part to the same mean edge length.

    So each part loses the same share of its triangles: with one error bound for the whole mesh,
    small parts would vanish before large ones are touched.
    """
    along = (points[faces[:, 0]] - points[faces[:, 1]]).T
    length = np.sqrt(np.square(along).sum(axis=0))
    centered = points - points.mean(axis=0)
    if surface.part_count == 1:
        return centered * (_EDGE_LENGTH / max(length.mean(), 1e-30))
    count = surface.part_count
    part = surface.parts[faces[:, 0]]
    edge = np.bincount(part, length, count) / np.maximum(np.bincount(part, minlength=count), 1)
    mean = length.mean()
    scale = np.where(edge > 0.0, mean / np.where(edge > 0.0, edge, 1.0), 1.0)
    sizes = np.maximum(np.bincount(surface.parts, minlength=count), 1)
    middle = [np.bincount(surface.parts, x, count) / sizes for x in centered.T]
    middle = np.stack(middle, axis=1)[surface.parts]
    centered = middle + (centered - middle) * scale[surface.parts][:, None]
    return centered * (_EDGE_LENGTH / max(mean, 1e-30))


def _collapse(points, faces, share, in_part):
    """Return the collapses, shape (C, 2), that leave a share of a patch's faces."""
    import fast_simplification

    # A random order of the triangles: the library stops in the middle of a round.
    corners = faces[np.random.default_rng(0).permutation(len(faces))].ravel()
    number = np.empty(len(points), np.int32)
    number[corners] = np.arange(len(corners), dtype=np.int32)
    used = corners[number[corners] == np.arange(len(corners))]
    number[used] = np.arange(len(used), dtype=np.int32)
    with _library:
        _, _, collapses = fast_simplification.simplify(
            points[used],
            number[corners].reshape(-1, 3),
            target_count=round(share * len(faces)),
            return_collapses=True,
            preserve_border=in_part,
        )
    return used[np.asarray(collapses).reshape(-1, 2)]


def _patches(points, faces):
    """Split faces into patches of about equal number by planes; return the faces of each."""
    if len(faces) <= _PATCH:
        return [np.arange(len(faces))]
    # Rotated at random for each level, so that no rim lies where one was in the level before.
    turn, _ = np.linalg.qr(np.random.default_rng(len(faces)).normal(size=(3, 3)))
    columns = [np.ascontiguousarray(corner) for corner in faces.T]
    centers = []
    for row in turn:
        along = sum(
            np.float32(x) * axis.astype(np.float32) for x, axis in zip(row, points.T, strict=True)
        )
        centers.append(sum(along[corner] for corner in columns))
    return _split(centers, np.arange(len(faces)), -(-len(faces) // _PATCH))


def _split(centers, chosen, parts):
    if parts <= 1 or len(chosen) == 0:
        return [chosen] if len(chosen) else []
    axis = max(centers, key=np.ptp)
    # A sample of the centres is enough for the median.
    sample = np.sort(axis[:: max(len(axis) // 4096, 1)])
    low = axis < sample[len(sample) * (parts // 2) // parts]
    result = []
    for side, count in ((low, parts // 2), (~low, parts - parts // 2)):
        result += _split([center[side] for center in centers], chosen[side], count)
    return result


def _groups(collapses, count, apexes):
    """Return the group of each place: collapses move their second place into their first."""
    target = np.arange(count + apexes)
    target[collapses[:, 1]] = collapses[:, 0]
    while True:
        following = target[target]
        if np.array_equal(following, target):
            break
        target = following
    # Groups are numbered by their first place, which is never an apex.
    target = target[:count]
    first = np.empty(count + apexes, np.int64)
    first[target[::-1]] = np.arange(count)[::-1]
    return numbered(first[target])


def _cones(points, border, owner, normal):
    """Return apexes of cones over the holes, shape (K, 3), and the cones' triangles."""
    if len(border) == 0:
        return np.empty((0, 3)), np.empty((0, 3), np.int32)
    used, local = np.unique(border, return_inverse=True)
    local = local.reshape(border.shape)
    hole = connected(local, len(used))
    numbers, hole = np.unique(hole, return_inverse=True)
    count = len(numbers)

    def mean(values, index):
        total = np.stack([np.bincount(index, v, count) for v in values.T], axis=1)
        return total / np.bincount(index, minlength=count)[:, None]

    center = mean(points[used], hole)
    radius = np.sqrt(mean(np.square(points[used] - center[hole]).sum(axis=1)[:, None], hole))
    normal = mean(normal[:, owner].T, hole[local[:, 0]])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    apexes = center + _CONE_HEIGHT * radius * normal
    cones = np.column_stack([border[:, 1], border[:, 0], len(points) + hole[local[:, 0]]])
    return apexes, cones
