"""The state that all sessions of this process share, and its owner.

State that outlives a session and could change a picture belongs to one object, made when Aplanat is
registered and closed when it is unregistered. Its parts are safe to use from several threads; they
give out values or handles.
"""

import weakref

import bpy
from bpy.app.handlers import persistent

from ..lens_io.lens_shelf import LensShelf
from ..levels.level_store import LevelStore
from ..scene.camera.lenses import read_real_lens, user_folder
from .final_sessions import FinalSessions
from .live_pictures import LivePictures
from .picture_notes import PictureNotes
from .session import RenderSession


class SharedResources:
    """State that sessions share.

    Attributes
    ----------
    lenses : LensShelf
        The library of real lenses; a lens that was read stays as it is until a reload.
    levels : LevelStore
        Levels of detail; each session has handles of its own.
    notes : PictureNotes
        Counts and warnings of each scene's last picture, for the panels.
    renders : FinalSessions
        Finds the session of a final render.
    views : WeakValueDictionary of ViewportSession
        Sessions of 3D views, by the objects shown; each lives as long as a 3D view uses it.
    panels : RenderSession
        Of panels and operators, in the main thread.
    live : LivePictures
        Refocused pictures that Image editors show, with a session of their own.
    """

    def __init__(self):
        self.lenses = LensShelf([user_folder()])
        self.levels = LevelStore()
        self.notes = PictureNotes()
        self.renders = FinalSessions(self.open_session)
        self.views = weakref.WeakValueDictionary()
        self.panels = self.open_session()
        self.live = LivePictures(self.open_session)

    def open_session(self):
        """Return a new `RenderSession`; the caller closes it."""
        return RenderSession(self)

    def close(self):
        """Stop making levels of detail; close all sessions but those that others opened."""
        self.renders.end_render()
        self.live.close()
        self.panels.close()
        self.levels.close()


# The owner, while Aplanat is registered. No other module keeps state: see tests/layering.
_resources = None


def resources():
    """Return the state that sessions of this process share.

    Returns
    -------
    SharedResources

    Raises
    ------
    RuntimeError
        If Aplanat is not registered.
    """
    if _resources is None:
        raise RuntimeError("Aplanat is not registered in this Blender; call addon.register() first")
    return _resources


def listen(keep_pictures=False, progress=None, strict=False, session=None):
    """Receive the outcome of final renders in a `with` block; see `FinalSessions.listen`."""
    return resources().renders.listen(keep_pictures, progress, strict, session)


def shelf():
    """Return the library of real lenses, a `LensShelf`."""
    return resources().lenses


def real_lens_of(camera):
    """Return the real lens of a camera's data as `LensSettings`; None without a usable one."""
    lens, _ = read_real_lens(camera, resources().lenses)
    return lens


@persistent
def _begin_render(*_):
    resources().renders.begin_render()


@persistent
def _end_render(*_):
    resources().renders.end_render()


def _handlers():
    handlers = bpy.app.handlers
    yield handlers.render_init, _begin_render
    yield handlers.render_complete, _end_render
    yield handlers.render_cancel, _end_render


def register():
    """Make the shared state, and register handlers for begin and end of final renders."""
    global _resources
    _resources = SharedResources()
    for handlers, handler in _handlers():
        handlers.append(handler)


def unregister():
    """Undo `register`."""
    global _resources
    for handlers, handler in _handlers():
        handlers.remove(handler)
    _resources.close()
    _resources = None
