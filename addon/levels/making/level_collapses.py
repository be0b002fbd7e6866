"""Edge collapses: which places of a mesh merge into one in the next level of detail.

fast-simplification decides the collapses. It holds the interpreter lock while it works, so a large
mesh is given to it in patches; their rims are kept, and lie elsewhere in the next level. It never
moves a border's vertex inwards, so a mesh of many holes would not be simplified: holes are closed
by cones first, whose steep sides hold the border as Garland's perpendicular planes do, while a
small hole may vanish.
"""

import threading
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .level_parts import paired, small_parts

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


class Surface:
    """The welded surface of a mesh: its places and the triangles between them.

    Parameters
    ----------
    mesh : MeshSnapshot
    places : ndarray of shape (V,)
        Of its vertices.
    seams : ndarray of shape (E, 2)
        Of its places; see `level_seams`.
    parts : ndarray of shape (P,), optional
        The connected part of each place, if it is known.

    Attributes
    ----------
    places : ndarray of shape (V,)
    points : ndarray of shape (P, 3)
        float64; positions of the places.
    faces : ndarray of shape (T, 3)
        Places.
    normal : ndarray of shape (3, T)
        See `facets`.
    size : ndarray of shape (T,)
        Length of the normals: twice the areas.
    """

    def __init__(self, mesh, places, seams, parts=None):
        self._parts = parts
        self.seams = seams
        self.places = places
        self.points = _points(mesh.positions, places).astype(np.float64)
        self.faces = places[mesh.triangles]
        self.normal = facets(self.points, self.faces)
        self.size = np.sqrt(np.square(self.normal).sum(axis=0))

    @cached_property
    def borders(self):
        """The edges with a single triangle, and those triangles: see `borders`."""
        return borders(self.faces, len(self.points))

    @cached_property
    def parts(self):
        """The connected part of each place."""
        if self._parts is not None:
            return self._parts
        edges = np.concatenate([self.faces[:, :2], self.faces[:, 1:]])
        return _numbered(connected(edges, len(self.points)))

    @cached_property
    def part_count(self):
        """A number above those of all parts."""
        return int(self.parts.max(initial=-1)) + 1


def weld(positions):
    """Weld vertices: number the distinct positions in the order of their first vertices.

    Parameters
    ----------
    positions : ndarray of shape (V, 3)

    Returns
    -------
    ndarray of shape (V,)
        int32.
    """
    # 0.0 and -0.0 are one place.
    bits = (np.ascontiguousarray(positions, np.float32) + np.float32(0.0)).view(np.uint32)
    order = np.arange(len(bits))
    for column in bits.T:
        order = order[stable_order(column[order])]
    ordered = bits[order]
    starts = np.ones(len(bits), bool)
    starts[1:] = differ(ordered[1:], ordered[:-1])
    # The order is stable, so a run's first is its least vertex.
    first = np.empty(len(bits), np.int64)
    first[order] = order[starts][np.cumsum(starts) - 1]
    return _numbered(first)


def stable_order(keys):
    """Return the order that sorts whole numbers of 32 bits, not negative; equal ones stay in order.

    By 16 bits at a time, which numpy sorts by counting: four times faster than by comparing.
    """
    keys = np.asarray(keys).astype(np.uint32)
    order = np.argsort(keys.astype(np.uint16), kind="stable")
    if len(keys) and keys.max() > 0xFFFF:
        high = (keys >> np.uint32(16)).astype(np.uint16)
        order = order[np.argsort(high[order], kind="stable")]
    return order


def differ(a, b):
    """Return where rows of three differ, shape (N,)."""
    x, y, z = ((p != q) for p, q in zip(a.T, b.T, strict=True))
    return x | y | z


def _numbered(first):
    """Return numbers of runs, from an array that holds the first entry of each entry's run."""
    leads = np.zeros(len(first), bool)
    leads[first] = True
    return (np.cumsum(leads, dtype=np.int32) - 1)[first]


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


def _points(positions, places):
    points = np.empty((int(places.max(initial=-1)) + 1, 3), np.float32)
    points[places[::-1]] = positions[::-1]
    return points


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
    return _numbered(first[target])


def facets(points, faces):
    """Return the normals of triangles, twice their area long, shape (3, T), float64.

    Parameters
    ----------
    points : ndarray of shape (P, 3)
    faces : ndarray of shape (T, 3)
    """
    result = np.empty((3, len(faces)))
    # In blocks that stay in a cache.
    for start in range(0, len(faces), 1 << 15):
        block = slice(start, start + (1 << 15))
        a, b, c = (points[corner].astype(np.float64) for corner in faces[block].T)
        (ux, uy, uz), (vx, vy, vz) = (b - a).T, (c - a).T
        result[0, block] = uy * vz - uz * vy
        result[1, block] = uz * vx - ux * vz
        result[2, block] = ux * vy - uy * vx
    return result


def borders(faces, count):
    """Return border edges, those of a single triangle, shape (E, 2), and their triangles.

    Parameters
    ----------
    faces : ndarray of shape (T, 3)
    count : int
        Of the places.
    """
    # Two triangles of the same orientation have their common edge in both directions. The numbers
    # of the edge's ends, signed by direction, then cancel; they are replaced by random ones, so
    # that other edges' numbers do not cancel by chance.
    label = np.random.default_rng(0).integers(1, 1 << 40, count).astype(np.float64)
    balance = np.zeros(count)
    columns = [np.ascontiguousarray(corner) for corner in faces.T]
    for k in range(3):
        a, b = columns[k], columns[(k + 1) % 3]
        low, high = np.minimum(a, b), np.maximum(a, b)
        # Whole numbers below 2**53 add up exactly for up to 2**13 edges.
        balance += np.bincount(low, np.where(a < b, label[high], -label[high]), count)
    odd = balance != 0.0
    edges, owners = [], []
    for k in range(3):
        a, b = columns[k], columns[(k + 1) % 3]
        found = np.flatnonzero(odd[np.minimum(a, b)])
        edges.append(np.stack([a[found], b[found]], axis=1))
        owners.append(found)
    edges, owners = np.concatenate(edges), np.concatenate(owners)
    low, high = edges.min(axis=1).astype(np.int64), edges.max(axis=1)
    keys = (low << 32) | high
    order = np.argsort(keys, kind="stable")
    ordered = keys[order]
    differs = ordered[1:] != ordered[:-1]
    alone = np.ones(len(keys), bool)
    alone[1:] &= differs
    alone[:-1] &= differs
    single = np.sort(order[alone])
    return edges[single], owners[single]


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


def connected(edges, count):
    """Label connected components.

    Parameters
    ----------
    edges : ndarray of shape (E, 2)
    count : int
        Of the nodes.

    Returns
    -------
    ndarray of shape (count,)
        The least node of each node's component.
    """
    label = np.arange(count)
    while True:
        least = np.minimum(label[edges[:, 0]], label[edges[:, 1]])
        following = label.copy()
        # Roots are linked, too, so that the number of rounds is logarithmic.
        for end in edges.T:
            np.minimum.at(following, end, least)
            np.minimum.at(following, label[end], least)
        following = following[following]
        if np.array_equal(following, label):
            return label
        label = following
