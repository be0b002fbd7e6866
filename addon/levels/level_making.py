"""Levels of detail of one mesh: a function of the mesh alone, independent of history.

The collapses of a mesh follow from its rest shape where that is known (`MeshSnapshot.rest`), so
every frame of a deforming mesh gets its levels by the same collapses, in whichever process and
order the frames are drawn. Collapses are cached, in memory and for large meshes on disk: that only
saves time.
"""

import hashlib
import threading
from collections import OrderedDict
from dataclasses import dataclass, replace

import numpy as np

from ..snapshot.content import MeshSnapshot
from .making.level_shadow import covering
from .making.level_surface import weld
from .making.mesh_levels import replay, seam_edges, simplify

# Least triangles of a mesh that is cached on disk: smaller ones are simplified as fast as read.
_LEAST_TRIANGLES_ON_DISK = 50_000
# A mesh is deformed too much for the collapses of its rest shape if its area shrinks by this factor
# more or less than the rest shape's on the way to the coarsest level.
_AREA_TOLERANCE = 1.15


@dataclass
class LevelWork:
    """Statistics of the making of levels.

    Attributes
    ----------
    decimations, replays, loads : int
        Meshes that were simplified, that got their levels by cached collapses, and by those read
        from disk.
    """

    decimations: int = 0
    replays: int = 0
    loads: int = 0

    def add(self, other):
        """Add other work to this."""
        self.decimations += other.decimations
        self.replays += other.replays
        self.loads += other.loads


@dataclass(frozen=True, eq=False)
class Collapses:
    """The collapses of a shape: which places merge from level to level.

    Parameters
    ----------
    halvings : tuple of Halving
        Without use of their `places`.
    shrinkage : float
        Area of the coarsest level over that of the shape.
    """

    halvings: tuple
    shrinkage: float


class LevelMaker:
    """Makes levels of detail, by cached collapses where there are any.

    Parameters
    ----------
    files : LevelFiles
    memory_limit : int
        Bytes of collapses that are kept in memory.
    """

    def __init__(self, files, memory_limit):
        self._files = files
        self._memory_limit = memory_limit
        self._known = OrderedDict()
        self._lock = threading.Lock()
        self._generation = 0

    def make(self, mesh, least_triangles, check):
        """Return the levels of a mesh, and the work they took.

        Parameters
        ----------
        mesh : MeshSnapshot
        least_triangles : int
            No level has fewer.
        check : callable
            See `levels.making.mesh_levels.simplify`.

        Returns
        -------
        levels : tuple of MeshLevel
        work : LevelWork
        """
        work = LevelWork()
        if mesh.rest is not None:
            levels = self._by_rest(mesh, least_triangles, check, work)
            if levels is not None:
                return levels, work
        places = weld(mesh.positions)
        seams = seam_edges(mesh, places)
        key = _shape_key(mesh, mesh.positions, places, seams, least_triangles)
        known = self._find(key, mesh, work)
        if known is not None:
            return replay(mesh, known.halvings, places), work
        levels, halvings = _simplified(mesh, least_triangles, check, seams)
        self._keep(key, mesh, levels, halvings, work)
        return levels, work

    def forget(self):
        """Clear the caches in memory and on disk."""
        with self._lock:
            self._generation += 1
            self._known.clear()
            self._files.clear()

    def _by_rest(self, mesh, least_triangles, check, work):
        """Return the levels by the collapses of the rest shape; None if it is deformed too much."""
        places = weld(mesh.rest)
        if not _meet(mesh.positions, places):
            return None
        own = LevelWork()
        seams = seam_edges(mesh, places)
        key = _shape_key(mesh, mesh.rest, places, seams, least_triangles)
        known = self._find(key, mesh, own)
        if known is None:
            shape = _bare(mesh, mesh.rest, places)
            known = self._keep(key, shape, *_simplified(shape, least_triangles, check, seams), own)
        work.add(own)
        levels = replay(mesh, known.halvings, places)
        ratio = _shrinkage(mesh, levels) / max(known.shrinkage, 1e-30)
        fits = 1.0 / _AREA_TOLERANCE <= ratio <= _AREA_TOLERANCE
        return levels if fits else None

    def _find(self, key, mesh, work):
        with self._lock:
            generation = self._generation
            known = self._known.get(key)
            if known is not None:
                self._known.move_to_end(key)
        if known is not None:
            work.replays += 1
        elif len(mesh.triangles) >= _LEAST_TRIANGLES_ON_DISK:
            found = self._files.read(key)
            if found is not None:
                work.loads += 1
                known = Collapses(*found)
                self._remember(key, known, generation)
        return known

    def _keep(self, key, shape, levels, halvings, work):
        work.decimations += 1
        nowhere = np.empty(0, np.int32)
        halvings = tuple(replace(halving, places=nowhere) for halving in halvings)
        known = Collapses(halvings, _shrinkage(shape, levels))
        large = len(shape.triangles) >= _LEAST_TRIANGLES_ON_DISK
        with self._lock:
            generation = self._generation
            if large and halvings:
                self._files.write(key, known.halvings, known.shrinkage)
        self._remember(key, known, generation)
        return known

    def _remember(self, key, known, generation):
        with self._lock:
            if generation != self._generation:
                return
            self._known[key] = known
            held = sum(_size(known) for known in self._known.values())
            while held > self._memory_limit and len(self._known) > 1:
                held -= _size(self._known.popitem(last=False)[1])


def content_key(mesh, least_triangles):
    """Return a hash of all that the levels of a mesh depend on.

    Parameters
    ----------
    mesh : MeshSnapshot
    least_triangles : int

    Returns
    -------
    bytes
    """
    digest = hashlib.blake2b(digest_size=20)
    digest.update(f"{least_triangles} {mesh.slots}".encode())
    arrays = {"positions": mesh.positions, "triangles": mesh.triangles}
    if mesh.rest is not None:
        arrays["rest"] = mesh.rest
    for name, array in (*arrays.items(), *mesh.attributes.items()):
        digest.update(f"|{name} {array.dtype} {array.shape}|".encode())
        digest.update(np.ascontiguousarray(array))
    return digest.digest()


def _simplified(mesh, least_triangles, check, seams):
    """Return the levels of a mesh that cover what it covers, and their halvings."""
    levels, halvings = simplify(mesh, least_triangles, check, seams)
    kept = covering(mesh, levels)
    return levels[:kept], halvings[:kept]


def _shape_key(mesh, positions, places, seams, least_triangles):
    """Return a hash of what collapses depend on: places, triangles, material slots, seams."""
    shape = _bare(mesh, positions, places)
    digest = hashlib.blake2b(f"{least_triangles} {mesh.slots}".encode(), digest_size=20)
    for array in (shape.positions, shape.triangles, seams):
        digest.update(f"|{array.dtype} {array.shape}|".encode())
        digest.update(np.ascontiguousarray(array))
    return digest.hexdigest()


def _bare(mesh, positions, places):
    """Return a shape with one vertex for each place, without attributes.

    The splitting of vertices along seams depends on the normals, and so on the frame; collapses
    must not depend on it.
    """
    first = np.zeros(int(places.max(initial=-1)) + 1, np.intp)
    # Written from the back, so that a place's first vertex stands for it.
    first[places[::-1]] = np.arange(len(places) - 1, -1, -1)
    # 0.0 and -0.0 are one place.
    points = positions[first] + np.float32(0.0)
    return MeshSnapshot(mesh.uid, mesh.name, points, places[mesh.triangles], mesh.slots)


def _meet(positions, places):
    """Whether all vertices of each place have the same position."""
    count = int(places.max(initial=-1)) + 1
    if count == len(places):
        return True
    at = np.empty((count, 3), positions.dtype)
    at[places] = positions
    return bool((at[places] == positions).all())


def _shrinkage(mesh, levels):
    """Return the area of the coarsest level over that of the mesh."""
    if not levels:
        return 1.0
    return _area(levels[-1]) / max(_area(mesh), 1e-30)


def _area(mesh):
    a, b, c = (mesh.positions[corner].astype(np.float64) for corner in mesh.triangles.T)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0


def _size(known):
    return sum(array.nbytes for halving in known.halvings for array in vars(halving).values())
