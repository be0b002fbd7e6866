"""The levels of detail of the scene's meshes: made in the background, kept, shared.

Meshes of equal content share their levels. A mesh that has the name and the triangles of one that
was simplified before, but other positions, has been deformed: its levels follow by the same
collapses. What was made for large meshes is kept on disk.
"""

import atexit
import hashlib
import threading
import weakref
from collections import OrderedDict
from dataclasses import dataclass
from functools import cache

import numpy as np

from ..errors import RenderCancelledError
from ..files.cache_folder import cache_folder
from ..scene.mesh_levels import replay, simplify
from .level_files import LevelFiles

_MEMORY_LIMIT = 1 << 30
_DISK_LIMIT = 2 << 30
# Smaller meshes are simplified about as fast as they are read.
_LEAST_TRIANGLES_ON_DISK = 50_000
# How often a waiting caller looks whether it was cancelled.
_POLL_SECONDS = 0.05
# A mesh of the same name and triangles is not the same one deformed if its area shrinks more by
# this factor on the way to the coarsest level.
_AREA_TOLERANCE = 1.15


@dataclass(frozen=True, eq=False)
class _Made:
    levels: tuple
    bytes: int


@dataclass(frozen=True, eq=False)
class _Known:
    halvings: tuple
    shrinkage: float


class LevelStore:
    """Levels of detail by mesh.

    Safe to use from several threads. The work is done by one thread, which exists while there is
    some.

    Parameters
    ----------
    memory_limit : int
        Bytes of levels that are kept for meshes that nobody requests at the moment.
    folder : Path, optional
        For the levels of large meshes; default the user's cache.
    disk_limit : int
        Bytes that the folder may take.

    Attributes
    ----------
    decimations, replays, loads : int
        How many meshes were simplified, got their levels by the collapses of another mesh or frame,
        and by those on disk.
    """

    def __init__(self, memory_limit=_MEMORY_LIMIT, folder=None, disk_limit=_DISK_LIMIT):
        self.decimations = self.replays = self.loads = 0
        self._memory_limit = memory_limit
        self._files = LevelFiles(cache_folder("levels") if folder is None else folder, disk_limit)
        self._changed = threading.Condition()
        self._least_triangles = None
        self._wanted = {}
        self._keys = {}
        self._made = OrderedDict()
        self._known = OrderedDict()
        self._queue = OrderedDict()
        self._fresh = set()
        self._work_done = self._work_total = self._work_begun = 0
        self._error = None
        self._thread = None
        self._stopping = False
        atexit.register(_close, weakref.ref(self))

    def request(self, meshes, least_triangles):
        """Ask for the levels of a scene's meshes, in place of those asked for before.

        Returns at once; a thread makes what is not here yet, the meshes with most triangles last.

        Parameters
        ----------
        meshes : iterable of MeshSnapshot
        least_triangles : int
            No level has fewer.
        """
        with self._changed:
            if least_triangles != self._least_triangles:
                self._least_triangles = least_triangles
                self._keys.clear()
                self._queue.clear()
            self._wanted = {mesh.uid: mesh for mesh in meshes}
            self._keys = {u: k for u, k in self._keys.items() if u in self._wanted}
            for uid in [uid for uid in self._queue if uid not in self._wanted]:
                self._work_total -= len(self._queue.pop(uid).triangles)
            self._enqueue()
            self._evict()

    def ready(self, uid):
        """Return the levels of a requested mesh.

        Parameters
        ----------
        uid : int

        Returns
        -------
        tuple of MeshSnapshot or None
            From level 1 up, empty if it cannot be simplified; None while they are not made.
        """
        with self._changed:
            mesh = self._wanted.get(uid)
            if mesh is not None and self._is_small(mesh):
                return ()
            made = self._made.get(self._keys.get(uid))
            return None if made is None else made.levels

    @property
    def progress(self):
        """Triangles of full detail that are done, and in all, since there was nothing to do."""
        with self._changed:
            return min(self._work_done + self._work_begun, self._work_total), self._work_total

    @property
    def busy(self):
        """Whether levels are being made."""
        with self._changed:
            return self._thread is not None

    def finish(self, progress=None, cancelled=None):
        """Wait until every requested mesh has its levels.

        Parameters
        ----------
        progress : callable, optional
            Called with the triangles done and their total.
        cancelled : callable, optional
            Tells whether to give up.

        Raises
        ------
        RenderCancelledError
            If `cancelled` says so; what was not begun is not made then.
        """
        while self._pending():
            if cancelled is not None and cancelled():
                with self._changed:
                    self._queue.clear()
                raise RenderCancelledError("cancelled while levels of detail were made")
            if progress is not None:
                progress(*self.progress)
            with self._changed:
                if self._thread is not None:
                    self._changed.wait(_POLL_SECONDS)
        if progress is not None:
            progress(*self.progress)

    def _pending(self):
        """Return whether a requested mesh lacks its levels; somebody is making them, then."""
        with self._changed:
            if self._thread is not None:
                return True
            if self._error is not None:
                error, self._error = self._error, None
                raise error
            self._enqueue()
            return self._thread is not None

    @property
    def memory_bytes(self):
        """Bytes of all levels kept in memory."""
        with self._changed:
            return sum(made.bytes for made in self._made.values())

    def rebuild(self):
        """Forget every level, in memory and on disk, and make the requested ones again."""
        with self._changed:
            for shape in [key for key in self._known if isinstance(key, str)]:
                self._files.forget(shape)
            self._made.clear()
            self._known.clear()
            self._keys.clear()
            self._queue.clear()
            self._fresh = set(self._wanted)
            self._enqueue()

    def close(self):
        """Stop making levels; returns when the thread has ended."""
        with self._changed:
            self._queue.clear()
            self._stopping = True
            thread = self._thread
        if thread is not None:
            thread.join()
        with self._changed:
            self._stopping = False

    def _is_small(self, mesh):
        return len(mesh.triangles) < 2 * self._least_triangles

    def _enqueue(self):
        missing = [
            mesh
            for uid, mesh in self._wanted.items()
            if self._keys.get(uid) not in self._made
            and uid not in self._queue
            and not self._is_small(mesh)
        ]
        if missing and self._thread is None:
            self._work_done = self._work_total = self._work_begun = 0
        for mesh in sorted(missing, key=lambda mesh: len(mesh.triangles)):
            self._queue[mesh.uid] = mesh
            self._work_total += len(mesh.triangles)
        if self._queue and self._thread is None and not self._stopping:
            self._thread = threading.Thread(target=self._work, name="aplanat-levels", daemon=True)
            self._thread.start()

    def _work(self):
        while True:
            with self._changed:
                if not self._queue or self._stopping:
                    self._thread = None
                    self._changed.notify_all()
                    return
                uid, mesh = self._queue.popitem(last=False)
                least = self._least_triangles
                fresh = uid in self._fresh
                self._fresh.discard(uid)
            try:
                key = _content_hash(mesh, least)
                with self._changed:
                    made = self._made.get(key)
                if made is None:
                    made = self._make(mesh, key, least, fresh)
            except RenderCancelledError:
                continue
            except Exception as error:
                with self._changed:
                    self._error = error
                    self._queue.clear()
                continue
            with self._changed:
                self._work_done += len(mesh.triangles)
                self._work_begun = 0
                if least == self._least_triangles and uid in self._wanted:
                    self._keys[uid] = key
                self._made[key] = made
                self._evict()
                self._changed.notify_all()

    def _make(self, mesh, key, least, fresh):
        shape = _shape_hash(mesh, least)
        topology = _topology_hash(mesh, least)
        made = self._replayed(mesh, shape, topology)
        if made is not None:
            self.replays += 1
            return made
        large = len(mesh.triangles) >= _LEAST_TRIANGLES_ON_DISK
        halvings = self._files.read(shape) if large and not fresh else None
        if halvings is not None:
            levels = replay(mesh, halvings)
            self.loads += 1
        else:
            levels, halvings = simplify(mesh, least, self._check)
            self.decimations += 1
            if large and halvings:
                self._files.write(shape, halvings)
        known = _Known(halvings, _shrinkage(mesh, levels))
        with self._changed:
            self._known[shape] = self._known[topology] = known
        return _Made(levels, _size(levels))

    def _replayed(self, mesh, shape, topology):
        with self._changed:
            same, deformed = self._known.get(shape), self._known.get(topology)
        if same is not None:
            levels = replay(mesh, same.halvings)
            return _Made(levels, _size(levels))
        if deformed is None:
            return None
        levels = replay(mesh, deformed.halvings)
        ratio = _shrinkage(mesh, levels) / max(deformed.shrinkage, 1e-30)
        if not 1.0 / _AREA_TOLERANCE <= ratio <= _AREA_TOLERANCE:
            return None
        return _Made(levels, _size(levels))

    def _check(self, done):
        with self._changed:
            if self._stopping:
                raise RenderCancelledError("levels of detail are not needed any more")
            self._work_begun = done

    def _evict(self):
        used = {self._keys.get(uid) for uid in self._wanted}
        for key in used & self._made.keys():
            self._made.move_to_end(key)
        spare = sum(made.bytes for key, made in self._made.items() if key not in used)
        for key in [key for key in self._made if key not in used]:
            if spare <= self._memory_limit:
                break
            spare -= self._made.pop(key).bytes
        # Each is there by its shape and by its topology: counted twice, removed twice.
        held = sum(_halvings_size(known.halvings) for known in self._known.values())
        while held > self._memory_limit and len(self._known) > 2:
            held -= _halvings_size(self._known.popitem(last=False)[1].halvings)


@cache
def level_store():
    """Return the store of this process, shared by final renders and viewports.

    Returns
    -------
    LevelStore
    """
    return LevelStore()


def _close(reference):
    store = reference()
    if store is not None:
        store.close()


def _content_hash(mesh, least_triangles):
    digest = hashlib.blake2b(digest_size=20)
    digest.update(f"{least_triangles} {mesh.slots}".encode())
    for name, array in (("", mesh.positions), ("", mesh.triangles), *mesh.attributes.items()):
        digest.update(f"|{name} {array.dtype} {array.shape}|".encode())
        digest.update(np.ascontiguousarray(array))
    return digest.hexdigest()


def _shape_hash(mesh, least_triangles):
    """Hash what the collapses depend on."""
    digest = hashlib.blake2b(f"{least_triangles}".encode(), digest_size=20)
    digest.update(np.ascontiguousarray(mesh.positions))
    digest.update(np.ascontiguousarray(mesh.triangles))
    return digest.hexdigest()


def _topology_hash(mesh, least_triangles):
    digest = hashlib.blake2b(digest_size=20)
    digest.update(f"{mesh.name}|{least_triangles} {len(mesh.positions)}".encode())
    digest.update(np.ascontiguousarray(mesh.triangles))
    return digest.digest()


def _size(levels):
    return sum(
        array.nbytes
        for level in levels
        for array in (level.positions, level.triangles, level.merged, *level.attributes.values())
    )


def _halvings_size(halvings):
    return sum(array.nbytes for halving in halvings for array in vars(halving).values())


def _shrinkage(mesh, levels):
    """Return the area of the coarsest level over that of the mesh."""
    if not levels:
        return 1.0
    return _area(levels[-1]) / max(_area(mesh), 1e-30)


def _area(mesh):
    a, b, c = (mesh.positions[corner].astype(np.float64) for corner in mesh.triangles.T)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0
