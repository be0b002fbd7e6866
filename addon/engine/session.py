"""The state of one client of the engine between its pictures: readers, buffers, outcome, reports.

A final render has a session from its first frame to its last, a command for all that it renders.
3D views that show the same objects have one in common, and so have the panels. State that several
sessions share is in `shared_resources`, in objects that are safe to use from several threads.
"""

import threading
import weakref
from contextlib import contextmanager

from ..device import context, keeping
from ..device.textures import TextureCache
from ..scene.camera.camera import CameraSources
from ..scene.camera.irises import IrisReader
from ..scene.extract import SceneExtractor
from .drawing.scene_buffers import SceneBuffers
from .outcome import RenderOutcome
from .picture_notes import Findings
from .report import without_count


class RenderSession:
    """Readers, buffers, outcome and reports of one client; used by one thread at a time.

    A client makes the parts that it needs: a final render an extractor for each view layer, a 3D
    view one for as long as it is shown, and a client that draws a stored capture none.

    Parameters
    ----------
    shared : SharedResources

    Attributes
    ----------
    outcome : RenderOutcome
        Of the render in progress, or of the last one.
    sources : CameraSources
        The shared library of lenses, and iris images of its own.
    look_textures : TextureCache
        Textures of the appearance of bokeh discs, kept for the next picture.
    warnings : list of str
        Those of the render in progress, or of the last one.
    """

    def __init__(self, shared):
        self.outcome = RenderOutcome()
        self.sources = CameraSources(shared.lenses, IrisReader())
        self.look_textures = TextureCache()
        self._levels, self._notes = shared.levels, shared.notes
        self._kept = {}
        self._reported = set()
        self.warnings = []
        self._handles = weakref.WeakSet()
        self._lock = threading.Lock()
        self._uses, self._closed = 0, False

    def __enter__(self):
        """Return the session, which the end of the `with` block closes."""
        return self

    def __exit__(self, *exception):
        """Close."""
        self.close()

    def extractor(self, space=None, largest_image=None, in_main_thread=None):
        """Return a new `SceneExtractor`, for one depsgraph; the arguments are its own."""
        return SceneExtractor(space, largest_image, in_main_thread, self.sources)

    def buffers(self):
        """Return new `SceneBuffers`, for the content of one extractor."""
        return SceneBuffers(self.look_textures)

    def kept_scenes(self, scene):
        """Return the `KeptScenes` of a scene; empty ones without *Persistent Data*."""
        uid = scene.original.session_uid
        if not scene.render.use_persistent_data:
            # What it kept while it was on would stay as long as Blender does.
            self._kept.pop(uid, None)
            return KeptScenes(self)
        if uid not in self._kept:
            self._kept[uid] = KeptScenes(self)
        return self._kept[uid]

    def open_levels(self):
        """Return a new `LevelHandle`; the session closes it if nobody else does."""
        handle = self._levels.open()
        self._handles.add(handle)
        return handle

    def begin_report(self):
        """Clear the list of reported warnings, for the next render."""
        self._reported.clear()
        self.warnings.clear()

    def report(self, lines):
        """Add warnings to the outcome; return those that this render has not reported yet.

        Parameters
        ----------
        lines : sequence of str
            As `report.frame_report` returns them. Lines that differ only in their count of copies
            are the same warning.

        Returns
        -------
        list of str
        """
        self.outcome.note(lines)
        new = []
        for line in lines:
            words = without_count(line)
            if words not in self._reported:
                self._reported.add(words)
                self.warnings.append(line)
                new.append(line)
        return new

    def note_findings(self, scene, where, warnings, error="", levels=1.0):
        """Store what a picture lacks for the panels.

        Parameters
        ----------
        scene : bpy.types.Scene
        where : {'viewport', 'render'}
        warnings, error, levels
            As of `Findings`.
        """
        self._notes.change(scene, **{where: Findings(tuple(warnings), error, levels)})

    def note_picture(self, scene, renderer):
        """Store counts and warnings of a picture for the panels; see `PictureNotes.note`."""
        self._notes.note(scene, renderer)

    @contextmanager
    def in_use(self):
        """Delay `close` until the end of a `with` block."""
        with self._lock:
            self._uses += 1
        try:
            yield
        finally:
            with self._lock:
                self._uses -= 1
                ended = self._closed and not self._uses
            if ended:
                self._release()

    def close(self):
        """Close level handles and drop textures; the garbage collector does the same."""
        with self._lock:
            self._closed = True
            used = self._uses
        if not used:
            self._release()

    def _release(self):
        for handle in list(self._handles):
            handle.close()
        self._kept.clear()
        self.look_textures.clear()
        # Works in the thread that draws only; Blender's main thread does it again when it is idle.
        keeping.let_go()


class KeptScenes:
    """What a final render keeps of its scene from frame to frame, with *Persistent Data*.

    Of each view layer that is what was read of it and its copy on the device. Where Blender keeps
    its evaluated scene, too, meshes that it names no update of are not even read; in the background
    it evaluates each frame from nothing, and what is read is compared.

    Parameters
    ----------
    session : RenderSession
        Opens extractors and buffers.
    """

    def __init__(self, session):
        self._session = session
        self._layers = {}
        self._runs_in_main_thread = None

    @contextmanager
    def rendering(self, depsgraph, evaluated_anew, in_main_thread):
        """Render a frame's view layer in a `with` block.

        Parameters
        ----------
        depsgraph : bpy.types.Depsgraph
        evaluated_anew : bool
            It is another evaluated scene than that of the last time.
        in_main_thread : callable
            As for `SceneExtractor`, while the block runs.
        """
        for layer in self._layers.values():
            # All are told of all updates: their meshes are of the same evaluated scene.
            layer.extractor.note_updates(depsgraph)
            # Nothing tells of files that have changed.
            layer.extractor.look_again(meshes=evaluated_anew)
        self._runs_in_main_thread = in_main_thread
        try:
            yield
        finally:
            self._runs_in_main_thread = None

    def layer(self, name):
        """Return the `KeptLayer` of a view layer."""
        if name not in self._layers:
            self._layers[name] = KeptLayer(self._session, self._in_main_thread)
        return self._layers[name]

    def _in_main_thread(self, work):
        return self._runs_in_main_thread(work)


class KeptLayer:
    """What is kept of a view layer.

    Parameters
    ----------
    session : RenderSession
    in_main_thread : callable
        As for `SceneExtractor`.

    Attributes
    ----------
    extractor : SceneExtractor
    buffers : SceneBuffers
    """

    def __init__(self, session, in_main_thread):
        self.extractor = session.extractor(
            largest_image=context.max_texture_size(), in_main_thread=in_main_thread
        )
        self.buffers = session.buffers()
