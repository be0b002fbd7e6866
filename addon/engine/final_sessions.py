"""Finds the session of a final render, because Blender passes none to an engine.

`bpy.ops.render.render` answers ``{'FINISHED'}`` whatever happened inside an engine, so a caller
that needs the outcome listens for it::

    with listen() as heard:
        bpy.ops.render.render()
    if heard.error: ...

A render without a listener has a session of its own, from its first frame to its last.
"""

import threading
from contextlib import contextmanager

from .outcome import RenderOutcome


class FinalSessions:
    """The session of a final render: that of the last listener, else the render's own.

    Safe to use from the main thread, where listeners are, and the render thread.

    Parameters
    ----------
    open_session : callable
        Returns a new `RenderSession`.
    """

    def __init__(self, open_session):
        self._open_session = open_session
        self._lock = threading.Lock()
        self._listening = []
        self._own = None

    @property
    def listeners(self):
        """Number of listeners at the moment."""
        with self._lock:
            return len(self._listening)

    @contextmanager
    def listen(self, keep_pictures=False, progress=None, strict=False, session=None):
        """Receive the outcome of the final renders that run inside a `with` block.

        Parameters
        ----------
        keep_pictures : bool
        progress : callable, optional
        strict : bool
            See `RenderOutcome`.
        session : RenderSession, optional
            Used for these renders, and left open; default: a new one, closed after the block.

        Yields
        ------
        RenderOutcome
            The new outcome of the session.
        """
        used = self._open_session() if session is None else session
        used.outcome = RenderOutcome(keeps_pictures=keep_pictures, progress=progress, strict=strict)
        with self._lock:
            self._listening.append(used)
        try:
            yield used.outcome
        finally:
            with self._lock:
                self._listening.remove(used)
            if session is None:
                used.close()

    def current(self):
        """Return the session of the render in progress; open one if there is none."""
        with self._lock:
            if self._listening:
                return self._listening[-1]
            if self._own is None:
                self._own = self._open_session()
            return self._own

    def begin_render(self):
        """Clear reports, and close the session of an earlier render, when a render begins."""
        self.end_render()
        with self._lock:
            for session in self._listening:
                session.begin_report()

    def end_render(self):
        """Close the session of a render without a listener, when it ends."""
        with self._lock:
            own, self._own = self._own, None
        if own is not None:
            own.close()
