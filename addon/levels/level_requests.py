"""The levels of detail that one client of a `LevelStore` has requested, and their progress."""

from collections import OrderedDict
from dataclasses import dataclass, field

from .level_making import LevelWork


@dataclass(eq=False)
class LevelRequests:
    """The meshes of one handle whose levels of detail are requested.

    Not safe to use from several threads at once: `LevelStore` holds its lock meanwhile.

    Attributes
    ----------
    least_triangles : int
        No level has fewer.
    wanted : dict of int to MeshSnapshot
        By uid.
    keys : dict of int to bytes
        Content of those whose levels were made.
    queue : OrderedDict of int to MeshSnapshot
        Those that are still to be made, in that order.
    batch, done : dict of int to int
        Triangles of what was asked for since nothing was left to do, and of what is done of it.
    begun : int
        Triangles done of the mesh that is being made.
    errors : dict of int to Exception
        Why the levels of a mesh could not be made.
    work : LevelWork
        Work done for this client so far.
    waits : bool
        The client waits for its levels, so they are made first.
    """

    least_triangles: int = 0
    wanted: dict = field(default_factory=dict)
    keys: dict = field(default_factory=dict)
    queue: OrderedDict = field(default_factory=OrderedDict)
    batch: dict = field(default_factory=dict)
    done: dict = field(default_factory=dict)
    begun: int = 0
    errors: dict = field(default_factory=dict)
    work: LevelWork = field(default_factory=LevelWork)
    waits: bool = False

    def replace(self, meshes, least_triangles):
        """Request these meshes instead of the previous ones; nothing is queued yet."""
        if least_triangles != self.least_triangles:
            self.least_triangles = least_triangles
            self.keys.clear()
            self.give_up()
        self.wanted = {mesh.uid: mesh for mesh in meshes}
        self.keys = {u: k for u, k in self.keys.items() if u in self.wanted}
        self.errors = {u: e for u, e in self.errors.items() if u in self.wanted}
        for uid in [uid for uid in self.queue if uid not in self.wanted]:
            del self.queue[uid]
            self.batch.pop(uid, None)

    def enqueue(self, made, current):
        """Queue the requested meshes without levels, those with most triangles last.

        Parameters
        ----------
        made : MadeLevels
        current : int or None
            Uid of the mesh whose levels are being made for this client.
        """
        if current not in self.batch:
            # Given up; it ends without levels.
            current = None
        missing = [
            mesh
            for uid, mesh in self.wanted.items()
            if self.keys.get(uid) not in made
            and uid not in self.queue
            and uid not in self.errors
            and uid != current
            and not self.is_small(mesh)
        ]
        if missing and not self.queue and current is None:
            self.batch.clear()
            self.done.clear()
        for mesh in sorted(missing, key=lambda mesh: len(mesh.triangles)):
            self.queue[mesh.uid] = mesh
            self.batch[mesh.uid] = len(mesh.triangles)
            self.done.pop(mesh.uid, None)

    def is_small(self, mesh):
        """Whether a mesh has too few triangles for a level, or such as are seen by themselves."""
        few = len(mesh.triangles) < 2 * self.least_triangles
        return few or "barycentric" in mesh.attributes

    def levels_of(self, uid, made):
        """Return the levels of a wanted mesh as `LevelHandle.ready` does."""
        mesh = self.wanted.get(uid)
        if mesh is not None and self.is_small(mesh):
            return ()
        return made.get(self.keys.get(uid))

    def progress(self):
        """Return the triangles of full detail that are done, and in all."""
        total = sum(self.batch.values())
        return min(sum(self.done.values()) + self.begun, total), total

    def finish_mesh(self, uid):
        """Count a mesh as done, with levels or with an error."""
        self.begun = 0
        if uid in self.batch:
            self.done[uid] = self.batch[uid]

    def give_up(self):
        """Drop the requests whose levels are not made yet."""
        self.queue.clear()
        self.batch.clear()
        self.done.clear()
        self.begun = 0

    def begin_anew(self):
        """Forget levels and errors: all requested levels have to be made again."""
        self.keys.clear()
        self.errors.clear()
        self.give_up()

    def end(self):
        """Drop all requests."""
        self.give_up()
        self.wanted.clear()
        self.keys.clear()
