"""The store of levels of detail: made in a background thread, cached, shared between clients.

Every client (each scene that 3D views show, each final render) opens a handle of its own, by which
it requests levels, waits for them, and gets its own errors; none sees the requests of others.
Behind the handles, meshes of equal content share their levels, and one thread makes what is
missing, first for clients that wait. Caches only save time: see `level_making`.
"""

import atexit
import threading
import weakref
from collections import deque
from dataclasses import dataclass

from ..errors import RenderCancelledError
from ..files.cache_folder import cache_folder
from .level_files import LevelFiles
from .level_making import LevelMaker, LevelWork, content_key
from .level_requests import LevelRequests
from .made_levels import MadeLevels

_MEMORY_LIMIT = 1 << 30
_DISK_LIMIT = 2 << 30
# Seconds between checks of a waiting caller whether it was cancelled.
_POLL_SECONDS = 0.05


@dataclass(frozen=True, eq=False)
class _Job:
    client: LevelRequests
    mesh: object
    least_triangles: int
    generation: int


class LevelStore:
    """Levels of detail by the content of meshes, shared by all handles.

    Safe to use from several threads. One thread makes the levels; it exists while there are
    requests.

    Parameters
    ----------
    memory_limit : int
        Most bytes of levels that are kept for meshes without requests.
    folder : Path, optional
        Folder of the collapses of large meshes; default the user's cache.
    disk_limit : int
        Most bytes of the folder.

    Attributes
    ----------
    work : LevelWork
        Of all handles together.
    """

    def __init__(self, memory_limit=_MEMORY_LIMIT, folder=None, disk_limit=_DISK_LIMIT):
        self.work = LevelWork()
        files = LevelFiles(cache_folder("levels") if folder is None else folder, disk_limit)
        self._maker = LevelMaker(files, memory_limit)
        self._changed = threading.Condition()
        self._clients = []
        # Clients of handles that were garbage-collected without being closed. They are removed
        # later under the lock, because garbage may be collected in any thread.
        self._abandoned = deque()
        self._made = MadeLevels(memory_limit)
        self._generation = 0
        self._job = None
        self._thread = None
        self._stopping = False
        atexit.register(_close, weakref.ref(self))

    def open(self):
        """Return a handle of its own for a client.

        Returns
        -------
        LevelHandle
            To be closed; one that is garbage-collected closes itself.
        """
        client = LevelRequests()
        with self._changed:
            self._clients.append(client)
        handle = LevelHandle(self, client)
        weakref.finalize(handle, self._abandoned.append, client).atexit = False
        return handle

    @property
    def progress(self):
        """Triangles of full detail that are done, and their total, over all handles."""
        with self._changed:
            self._forget_abandoned()
            pairs = [client.progress() for client in self._clients]
        return sum(done for done, _ in pairs), sum(total for _, total in pairs)

    @property
    def busy(self):
        """Whether levels are being made."""
        with self._changed:
            return self._thread is not None

    @property
    def memory_bytes(self):
        """Bytes of all levels kept in memory."""
        with self._changed:
            return self._made.bytes

    @property
    def generation(self):
        """Number of rebuilds so far; levels of an earlier generation are out of date."""
        with self._changed:
            return self._generation

    def rebuild(self):
        """Clear all levels, in memory and on disk, and make the requested ones again."""
        self._maker.forget()
        with self._changed:
            # What is being made at this moment was begun with what is forgotten now.
            self._generation += 1
            self._made.clear()
            for client in self._clients:
                client.begin_anew()
                self._enqueue(client)

    def close(self):
        """Stop making levels; returns when the thread has ended."""
        with self._changed:
            for client in self._clients:
                client.give_up()
            self._stopping = True
            thread = self._thread
        if thread is not None:
            thread.join()
        with self._changed:
            self._stopping = False

    def _remove(self, client):
        with self._changed:
            if client in self._clients:
                self._clients.remove(client)
                client.end()
                self._make_room()
                self._changed.notify_all()

    def _forget_abandoned(self):
        while self._abandoned:
            self._remove(self._abandoned.popleft())

    def _request(self, client, meshes, least_triangles):
        with self._changed:
            self._forget_abandoned()
            client.replace(meshes, least_triangles)
            self._enqueue(client)
            self._make_room()

    def _ready(self, client, uid):
        with self._changed:
            return client.levels_of(uid, self._made)

    def _is_made_for(self, client):
        return self._job is not None and self._job.client is client

    def _enqueue(self, client):
        """Queue the missing levels of a client, and start the thread."""
        client.enqueue(self._made, self._job.mesh.uid if self._is_made_for(client) else None)
        if client.queue and self._thread is None and not self._stopping:
            self._thread = threading.Thread(target=self._run, name="aplanat-levels", daemon=True)
            self._thread.start()

    def _take_job(self):
        """Take the next mesh off a queue, waiting clients first; None if all is done."""
        self._forget_abandoned()
        busy = [client for client in self._clients if client.queue]
        if not busy or self._stopping:
            return None
        client = next((client for client in busy if client.waits), busy[0])
        _, mesh = client.queue.popitem(last=False)
        return _Job(client, mesh, client.least_triangles, self._generation)

    def _run(self):
        while True:
            with self._changed:
                job = self._job = self._take_job()
                if job is None:
                    self._thread = None
                    self._changed.notify_all()
                    return
            key = levels = error = None
            work = LevelWork()
            try:
                key = content_key(job.mesh, job.least_triangles)
                with self._changed:
                    levels = self._made.get(key)
                if levels is None:
                    levels, work = self._maker.make(job.mesh, job.least_triangles, self._check)
            except RenderCancelledError:
                pass
            # Whatever goes wrong belongs to the handle that asked, which raises it again.
            except Exception as raised:
                error = raised
            with self._changed:
                self._finish_job(job, key, levels, error, work)
                self._changed.notify_all()

    def _finish_job(self, job, key, levels, error, work):
        client, uid = job.client, job.mesh.uid
        self._job = None
        self.work.add(work)
        client.work.add(work)
        client.begun = 0
        if job.generation != self._generation:
            # Forgotten while it was made: once more, if it is still wanted.
            if client in self._clients:
                self._enqueue(client)
            return
        wanted = uid in client.wanted and client.least_triangles == job.least_triangles
        if error is not None and wanted:
            client.errors[uid] = error
        if levels is not None:
            self._made.add(key, levels)
            if wanted:
                client.keys[uid] = key
            self._make_room()
        if levels is not None or error is not None:
            client.finish_mesh(uid)

    def _check(self, done):
        """Raise an exception if no client needs the mesh in progress; called from the work."""
        with self._changed:
            self._forget_abandoned()
            job = self._job
            client = job.client
            dropped = client not in self._clients or job.mesh.uid not in client.batch
            if self._stopping or dropped or job.generation != self._generation:
                raise RenderCancelledError("levels of detail are not needed any more")
            client.begun = done

    def _make_room(self):
        self._made.make_room({key for client in self._clients for key in client.keys.values()})


class LevelHandle:
    """The access of one client to a `LevelStore`; made by `LevelStore.open`.

    A handle is used from one thread at a time; closing it is allowed from any.
    """

    def __init__(self, store, client):
        self._store = store
        self._client = client

    def __enter__(self):
        """Return the handle, which the end of the `with` block closes."""
        return self

    def __exit__(self, *exception):
        """Close."""
        self.close()

    def request(self, meshes, least_triangles):
        """Request the levels of meshes, instead of the previous request of this handle.

        Returns at once; a thread makes missing levels, the meshes with most triangles last. Work
        on a mesh that has begun goes on: the next mesh may be the same, deformed.

        Parameters
        ----------
        meshes : iterable of MeshSnapshot
        least_triangles : int
            No level has fewer.
        """
        self._store._request(self._client, meshes, least_triangles)

    def ready(self, uid):
        """Return the levels of a requested mesh.

        Parameters
        ----------
        uid : int

        Returns
        -------
        tuple of MeshSnapshot or None
            From level 1 up; empty if it cannot be simplified, None while they are not made.
        """
        return self._store._ready(self._client, uid)

    @property
    def progress(self):
        """Triangles of full detail done, and their total, since all requests were last met."""
        with self._store._changed:
            return self._client.progress()

    @property
    def work(self):
        """Work done for this handle so far, as `LevelWork`."""
        return self._client.work

    @property
    def generation(self):
        """As `LevelStore.generation`."""
        return self._store.generation

    @property
    def error(self):
        """Why levels of a requested mesh could not be made, or None; `finish` raises it."""
        with self._store._changed:
            return next(iter(self._client.errors.values()), None)

    def finish(self, progress=None, cancelled=None):
        """Wait until every requested mesh has its levels.

        Parameters
        ----------
        progress : callable, optional
            Called with the triangles done and their total.
        cancelled : callable, optional
            Returns whether to stop waiting.

        Returns
        -------
        dict of int to tuple of MeshSnapshot
            By uid, as `ready` returns them; complete even during a `LevelStore.rebuild`.

        Raises
        ------
        RenderCancelledError
            If `cancelled` returns True; requests that only this handle has are then dropped.
        Exception
            The error of a mesh of this handle; the next call tries again.
        """
        store, client = self._store, self._client
        client.waits = True
        try:
            while (found := self._all_ready()) is None:
                if cancelled is not None and cancelled():
                    with store._changed:
                        client.give_up()
                    raise RenderCancelledError("cancelled while levels of detail were made")
                if progress is not None:
                    progress(*self.progress)
                with store._changed:
                    if client.queue or store._is_made_for(client):
                        store._changed.wait(_POLL_SECONDS)
        finally:
            client.waits = False
        if progress is not None:
            progress(*self.progress)
        return found

    def _all_ready(self):
        """Return all levels, or None while some are missing and being made."""
        store, client = self._store, self._client
        with store._changed:
            store._enqueue(client)
            if client.queue or store._is_made_for(client):
                return None
            if client.errors:
                error = next(iter(client.errors.values()))
                client.errors.clear()
                raise error
            return {uid: store._ready(client, uid) for uid in client.wanted}

    def close(self):
        """Drop all requests; work for this handle alone is stopped."""
        self._store._remove(self._client)


def _close(reference):
    store = reference()
    if store is not None:
        store.close()
