"""The operator that writes refocused pictures, while the window stays alive."""

import contextlib
import os
from pathlib import Path

import bpy

from ...capture.kept_values import KeptValues
from ...engine.refocus.frames import write_frames
from ...engine.refocus.pictures import save_picture
from ...engine.refocus.scene_refocus import layers_path
from ...engine.shared_resources import resources
from ...errors import AplanatError, InputError, OutputError
from ...files.frame_path import frame_path
from ...files.whole_file import check_writable
from ...layers.captured_files import check_apart
from ..jobs import live_refocus

# Seconds between two pieces of work.
_INTERVAL = 0.001


class APLANAT_OT_refocus_write(bpy.types.Operator):
    """Write refocused pictures to files."""

    bl_idname = "image.aplanat_refocus_write"
    bl_label = "Write Refocused Picture"
    bl_description = "Write the refocused picture to its file, with all its samples. Esc stops it"

    animation: bpy.props.BoolProperty(
        name="Animation",
        description="Write all frames of the scene's range",
        default=False,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        """Whether something is open."""
        if context.scene is None or not context.scene.aplanat.refocus.path:
            cls.poll_message_set("No depth layers are open")
            return False
        return not bpy.app.is_job_running("RENDER")

    def invoke(self, context, _event):
        """Begin, and go on between the events of the window."""
        try:
            self._begin(context)
        except AplanatError as error:
            self.report({"ERROR"}, " ".join(str(error).split()))
            return {"CANCELLED"}
        manager = context.window_manager
        self._timer = manager.event_timer_add(_INTERVAL, window=context.window)
        manager.progress_begin(0.0, 1.0)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        """Write at once, as scripts want it."""
        try:
            self._begin(context)
            for _ in self._steps:
                pass
        except AplanatError as error:
            self.report({"ERROR"}, " ".join(str(error).split()))
            return {"CANCELLED"}
        finally:
            self._end()
        self._tell()
        return {"FINISHED"}

    def modal(self, context, event):
        """Do the next piece of work."""
        if event.type == "ESC" and event.value == "PRESS":
            self._finish(context)
            self.report({"WARNING"}, "Stopped; files that are there are whole")
            return {"CANCELLED"}
        if event.type != "TIMER":
            # The scene goes from frame to frame: nobody else may change it now.
            return {"RUNNING_MODAL"}
        try:
            frame, share = next(self._steps)
        except StopIteration:
            self._finish(context)
            self._tell()
            return {"FINISHED"}
        except AplanatError as error:
            self._finish(context)
            self.report({"ERROR"}, " ".join(str(error).split()))
            return {"CANCELLED"}
        context.window_manager.progress_update(share)
        context.workspace.status_text_set(f"Refocusing frame {frame}  |  {share:.0%}  |  Esc: stop")
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """Leave the scene as it was when Blender ends or opens another file."""
        self._finish(context)

    def _begin(self, context):
        scene = context.scene
        self._scene, self._frame = scene, scene.frame_current
        self._steps, self._kept, self._lines = (step for step in ()), contextlib.ExitStack(), {}
        frames = [scene.frame_current]
        if self.animation:
            frames = list(range(scene.frame_start, scene.frame_end + 1, scene.frame_step))
        self._output = output_path(scene.aplanat.refocus.output, len(frames) > 1)
        check_writable(frame_path(self._output, frames[0]))
        if not self.animation and self._is_shown(context):
            self._steps = self._write_what_is_shown()
            return
        if frames != [scene.frame_current]:
            self._kept.enter_context(KeptValues())
        # One of both at a time on the device.
        live_refocus.hold(scene)
        self._kept.callback(live_refocus.let_go, scene)
        self._steps = write_frames(
            scene,
            frames,
            self._output,
            resources().panels.sources,
            context.evaluated_depsgraph_get,
            self._note,
        )

    def _is_shown(self, context):
        live = live_refocus.live_of(self._scene)
        if live is None:
            return False
        live.work(self._scene, context.evaluated_depsgraph_get())
        return live.finished and not live.error

    def _write_what_is_shown(self):
        live = live_refocus.live_of(self._scene)
        for line in live.notes:
            self._note(line)
        output = Path(frame_path(self._output, self._frame))
        check_apart([layers_path(self._scene, self._frame)], [output])
        save_picture(output, live.picture(), live.stack, self._scene)
        yield self._frame, 1.0

    def _note(self, line):
        self._lines[line] = None

    def _tell(self):
        for line in self._lines:
            self.report({"WARNING"}, line)
        self.report({"INFO"}, f"Written: {self._output}")

    def _end(self):
        self._steps.close()
        if self._frame != self._scene.frame_current:
            self._scene.frame_set(self._frame)
        self._kept.close()

    def _finish(self, context):
        self._end()
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)


def output_path(text, several):
    """Return where pictures are written, in a folder that is there.

    Parameters
    ----------
    text : str
        As Blender keeps it.
    several : bool
        Whether it has to have a place for the frame number.

    Returns
    -------
    Path

    Raises
    ------
    InputError
        If it cannot be used.
    """
    if text.startswith("//") and not bpy.data.filepath:
        raise InputError(
            "save the .blend file first: the pictures go beside it (or set another Picture File)"
        )
    path = Path(bpy.path.abspath(text))
    if path.suffix.lower() not in {".exr", ".png"}:
        raise InputError(f"Picture File '{text}' must end in .exr or .png")
    if several and "#" not in path.name:
        raise InputError(f"Picture File '{text}' needs #### for the frame number")
    try:
        os.makedirs(path.parent, exist_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise OutputError(f"cannot make folder '{path.parent}': {reason}") from error
    return path


CLASSES = (APLANAT_OT_refocus_write,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
