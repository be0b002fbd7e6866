"""Background jobs of the user interface: started from panels, finished in the main thread."""

import threading
import traceback

import bpy
from bpy.app.handlers import persistent

from ...errors import AplanatError
from .job_queue import JobQueue

# Seconds between looks for results, and longest wait for the thread when Blender ends.
_INTERVAL = 0.15
_PATIENCE = 10.0

_queue = JobQueue()
_errors = {}
# Set when the user stops the jobs; no job is begun until it is cleared.
_stopped = threading.Event()


def submit(key, label, work, receive, urgent=False, group=None):
    """Submit a job to the background, unless it was submitted already.

    Does nothing in a Blender without windows.

    Parameters
    ----------
    key : hashable
    label : str
        What is being made, for the user.
    work : callable
        ``work(progress, cancelled)``, in the background thread; must not touch Blender.
    receive : callable
        ``receive(result)``, in the main thread.
    urgent : bool
        Goes before all waiting jobs.
    group : hashable
        Replaces the waiting jobs of its group.
    """
    if bpy.app.background or _stopped.is_set() or key in _errors:
        return

    def work_and_address(progress, cancelled):
        return receive, work(progress, cancelled)

    _queue.submit(key, label, work_and_address, urgent, group)
    if not bpy.app.timers.is_registered(_collect):
        bpy.app.timers.register(_collect, first_interval=_INTERVAL, persistent=True)


def progress():
    """Return the progress of all jobs, or None if there are none."""
    return _queue.progress()


def error_of(key):
    """Return in one line why a job failed, or None."""
    return _errors.get(key)


def resume():
    """Allow jobs that failed or were stopped to be submitted again."""
    _errors.clear()
    _stopped.clear()
    _redraw()


def stop():
    """Stop all jobs until `resume`."""
    _stopped.set()
    cancel()
    _redraw()


def is_stopped():
    """Whether the user stopped the jobs."""
    return _stopped.is_set()


def cancel():
    """Cancel all jobs; panels submit what they still need when they are drawn."""
    _queue.cancel()


def _collect():
    # Asked before the results are fetched: none can come in between and stay behind.
    busy = _queue.progress() is not None
    outcomes = _queue.fetch()
    for outcome in outcomes:
        if outcome.error is not None:
            _note(outcome)
        else:
            receive, result = outcome.result
            receive(result)
    if busy or outcomes:
        _redraw()
    return _INTERVAL if busy or _queue.progress() is not None else None


def _note(outcome):
    error = outcome.error
    if isinstance(error, AplanatError):
        _errors[outcome.key] = " ".join(str(error).split())
        return
    traceback.print_exception(error)
    _errors[outcome.key] = f"failed, see the console: {error}"


def _redraw():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()
        if not window.modal_operators:
            # Nothing else redraws the status bar; a tool that is at work may have its text in it.
            with bpy.context.temp_override(window=window):
                window.workspace.status_text_set_internal(None)


@persistent
def _stop_before_load(*_):
    cancel()


def _draw_in_status_bar(header, _context):
    current = progress()
    if current is not None:
        header.layout.progress(text=current.label, factor=current.share)


def register():
    """Stop the jobs when another file is loaded; show their progress in the status bar."""
    bpy.app.handlers.load_pre.append(_stop_before_load)
    bpy.types.STATUSBAR_HT_header.append(_draw_in_status_bar)


def unregister():
    """Undo `register` and end the work."""
    bpy.types.STATUSBAR_HT_header.remove(_draw_in_status_bar)
    bpy.app.handlers.load_pre.remove(_stop_before_load)
    if bpy.app.timers.is_registered(_collect):
        bpy.app.timers.unregister(_collect)
    cancel()
    _errors.clear()
    _stopped.clear()
    _queue.close(_PATIENCE)
