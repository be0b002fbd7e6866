"""Operators that write frames step by step while the window stays alive, and their file names."""

import os
from pathlib import Path

import bpy

from ...errors import AplanatError, InputError, OutputError


class StepwiseOperator:
    """An operator whose work is a generator: one step at each tick of a timer; Esc stops it.

    A class of this kind sets ``_interval`` (seconds between ticks) and ``_stopped_line`` (what is
    reported after Esc). Its ``_begin(context)`` sets ``_steps`` (the generator) and ``_done_line``
    (what is reported at the end); ``_show(context, step)`` tells in the window what a step is
    about, and begins what goes on outside the generator.
    """

    def invoke(self, context, _event):
        """Begin, and go on between the events of the window."""
        failed = self._try_begin(context)
        if failed:
            return failed
        manager = context.window_manager
        self._timer = manager.event_timer_add(self._interval, window=context.window)
        manager.progress_begin(0.0, 1.0)
        self._stopped = False
        self._open_window(context)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        """Do everything at once, as scripts want it."""
        failed = self._try_begin(context)
        if failed:
            return failed
        try:
            for step in self._steps:
                self._do_now(step)
        except AplanatError as error:
            return self._fail(error)
        finally:
            self._end()
        self._tell()
        return {"FINISHED"}

    def modal(self, context, event):
        """Do the next step at a tick of the timer."""
        if event.type == "ESC" and event.value == "PRESS":
            self._stopped = True
        if event.type != "TIMER":
            return self._pass_on(event)
        if self._waits():
            return {"PASS_THROUGH"}
        if self._stopped:
            self._close_window(context)
            self.report({"WARNING"}, self._stopped_line)
            return {"CANCELLED"}
        try:
            step = next(self._steps)
        except StopIteration:
            self._close_window(context)
            self._tell()
            return {"FINISHED"}
        except AplanatError as error:
            self._close_window(context)
            return self._fail(error)
        return self._show(context, step)

    def cancel(self, context):
        """Leave the scene as it was when Blender ends or opens another file."""
        self._close_window(context)

    def _do_now(self, step):
        """Do what a step leaves to be done outside the generator, without a window."""

    def _open_window(self, context):
        """Prepare the window for the steps."""

    def _pass_on(self, _event):
        # What the user does must wait until the scene is itself again.
        return {"RUNNING_MODAL"}

    def _waits(self):
        """Whether the last step still goes on."""
        return False

    def _end(self):
        """Leave the scene as it was; `_close_window` calls it, too."""
        self._steps.close()

    def _close_window(self, context):
        self._end()
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)

    def _tell_progress(self, context, text, share):
        context.window_manager.progress_update(share)
        context.workspace.status_text_set(f"{text}  |  {share:.0%}  |  Esc: stop")

    def _try_begin(self, context):
        self._lines = {}
        try:
            self._begin(context)
        except AplanatError as error:
            return self._fail(error)
        return None

    def _fail(self, error):
        self.report({"ERROR"}, " ".join(str(error).split()))
        return {"CANCELLED"}

    def _note(self, line):
        self._lines[line] = None

    def _tell(self):
        for line in self._lines:
            self.report({"WARNING"}, line)
        self.report({"INFO"}, self._done_line)


def frames_of(scene, animation):
    """Return the frames that an operator works on: the current one, or the scene's range.

    Returns
    -------
    list of int
    """
    if not animation:
        return [scene.frame_current]
    return list(range(scene.frame_start, scene.frame_end + 1, scene.frame_step))


def output_pattern(text, several, field, what, suffixes):
    """Return where files are written, in a folder that is there.

    Parameters
    ----------
    text : str
        As Blender keeps it.
    several : bool
        Whether it has to have a place for the frame number.
    field : str
        Name of the field in the panel.
    what : str
        What is written, for the message: "the pictures".
    suffixes : sequence of str
        Those that are allowed, as ".exr".

    Returns
    -------
    Path

    Raises
    ------
    InputError
        If it cannot be used.
    OutputError
        If its folder cannot be made.
    """
    if text.startswith("//") and not bpy.data.filepath:
        raise InputError(
            f"save the .blend file first: {what} go beside it (or set another {field})"
        )
    path = Path(bpy.path.abspath(text))
    if path.suffix.lower() not in suffixes:
        raise InputError(f"{field} '{text}' must end in {' or '.join(suffixes)}")
    if several and "#" not in path.name:
        raise InputError(f"{field} '{text}' needs #### for the frame number")
    try:
        os.makedirs(path.parent, exist_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise OutputError(f"cannot make folder '{path.parent}': {reason}") from error
    return path
