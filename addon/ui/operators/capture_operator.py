"""The operator that captures depth layers, render by render, while the window stays alive."""

import os
import uuid
from pathlib import Path

import bpy

from ...capture.capture_files import source_digest
from ...capture.settings import ENGINES, CaptureSettings
from ...capture.shot_capture import capture_shot
from ...errors import AplanatError, InputError, OutputError
from ...files.frame_path import frame_path
from ...files.whole_file import check_writable

# Seconds between looks whether a render has ended.
_INTERVAL = 0.05


class APLANAT_OT_capture_layers(bpy.types.Operator):
    """Render the shot as depth layers, to be refocused later."""

    bl_idname = "render.aplanat_capture_layers"
    bl_label = "Capture Depth Layers"
    bl_description = (
        "Render the frame as depth layers with the scene's engine, hidden surfaces included, so"
        " that focus, f-number and lens can be chosen later. Esc stops it"
    )

    animation: bpy.props.BoolProperty(
        name="Animation",
        description="Capture all frames of the scene's range. Frames that are there already,"
        " whole and of the same settings, are left",
        default=False,
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        """Whether there is something to capture and nothing else is rendered."""
        if context.scene is None or context.scene.camera is None:
            cls.poll_message_set("The scene has no camera")
            return False
        if context.scene.render.engine not in ENGINES:
            cls.poll_message_set("Cycles, EEVEE and Aplanat make depth layers")
            return False
        return not bpy.app.is_job_running("RENDER")

    def invoke(self, context, _event):
        """Begin, and go on between the events of the window."""
        try:
            self._begin(context)
        except AplanatError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        manager = context.window_manager
        self._timer = manager.event_timer_add(_INTERVAL, window=context.window)
        manager.progress_begin(0.0, 1.0)
        view = context.preferences.view
        # The pictures of slices are nothing to look at, and would take the place of another editor.
        self._shown, self._dirty = view.render_display_type, context.preferences.is_dirty
        view.render_display_type = "NONE"
        self._started = self._stopped = self._ended = False
        bpy.app.handlers.render_complete.append(self._on_complete)
        bpy.app.handlers.render_cancel.append(self._on_cancel)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        """Capture at once, as scripts want it."""
        from ...capture.frame_capture import render_now

        try:
            self._begin(context)
            for _frame, step, _share in self._steps:
                render_now(step)
        except AplanatError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self._tell()
        return {"FINISHED"}

    def modal(self, context, event):
        """Start the next render when the last one has ended."""
        if event.type == "ESC" and event.value == "PRESS":
            self._stopped = True
        if event.type != "TIMER":
            # Esc also ends the render itself; all else waits until the scene is itself again.
            return {"PASS_THROUGH"} if event.type == "ESC" else {"RUNNING_MODAL"}
        if bpy.app.is_job_running("RENDER") or (self._started and not self._ended):
            return {"PASS_THROUGH"}
        if self._stopped:
            self._finish(context)
            self.report({"WARNING"}, "Capture stopped; the scene is as it was")
            return {"CANCELLED"}
        try:
            frame, step, share = next(self._steps)
        except StopIteration:
            self._finish(context)
            self._tell()
            return {"FINISHED"}
        except AplanatError as error:
            self._finish(context)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        context.window_manager.progress_update(share)
        context.workspace.status_text_set(
            f"Capturing frame {frame}: {step.text} ({step.done + 1} of {step.total})"
            f"  |  {share:.0%}  |  Esc: stop"
        )
        self._started, self._ended = True, False
        with context.temp_override(scene=step.scene, view_layer=step.view_layer):
            begun = bpy.ops.render.render("INVOKE_DEFAULT", write_still=True)
        if "RUNNING_MODAL" not in begun:
            self._ended = True
            self._stopped = "CANCELLED" in begun
        return {"PASS_THROUGH"}

    def cancel(self, context):
        """Leave the scene as it was when Blender ends or opens another file."""
        self._finish(context)

    def _begin(self, context):
        scene, own = context.scene, context.scene.aplanat.capture
        frames = [scene.frame_current]
        if self.animation:
            frames = list(range(scene.frame_start, scene.frame_end + 1, scene.frame_step))
        pattern = _path(own.path, len(frames) > 1)
        settings = CaptureSettings(scene.render.engine, own.layers, round(own.overscan, 6))
        # What is not saved is no file that could be compared.
        unsaved = bpy.data.is_dirty or not bpy.data.filepath
        source = uuid.uuid4().hex if unsaved else source_digest(bpy.data.filepath)
        check_writable(frame_path(pattern, frames[0]))
        self._pattern, self._lines = pattern, {}
        self._steps = capture_shot(scene, frames, settings, pattern, source, self._note)

    def _note(self, line):
        self._lines[line] = None

    def _tell(self):
        for line in self._lines:
            self.report({"WARNING"}, line)
        self.report({"INFO"}, f"Captured into {self._pattern}")

    def _on_complete(self, *_):
        self._ended = True

    def _on_cancel(self, *_):
        self._ended = self._stopped = True

    def _finish(self, context):
        # The generator's own `with` blocks remove the copy of the scene.
        self._steps.close()
        for handlers, function in (
            (bpy.app.handlers.render_complete, self._on_complete),
            (bpy.app.handlers.render_cancel, self._on_cancel),
        ):
            if function in handlers:
                handlers.remove(function)
        context.preferences.view.render_display_type = self._shown
        context.preferences.is_dirty = self._dirty
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)


def _path(text, several):
    if text.startswith("//") and not bpy.data.filepath:
        raise InputError(
            "save the .blend file first: the layers go beside it (or set another Layers File)"
        )
    path = Path(bpy.path.abspath(text))
    if path.suffix.lower() != ".exr":
        raise InputError(f"Layers File '{text}' must end in .exr")
    if several and "#" not in path.name:
        raise InputError(f"Layers File '{text}' needs #### for the frame number")
    try:
        os.makedirs(path.parent, exist_ok=True)
    except OSError as error:
        reason = error.strerror or error
        raise OutputError(f"cannot make folder '{path.parent}': {reason}") from error
    return path


def _draw_menu(self, _context):
    layout = self.layout
    layout.separator()
    # A row for each, so that a click begins at once.
    layout.operator_context = "INVOKE_DEFAULT"
    name = APLANAT_OT_capture_layers.bl_idname
    layout.operator(name, icon="RENDERLAYERS")
    layout.operator(name, text="Capture Depth Layers of Animation").animation = True


CLASSES = (APLANAT_OT_capture_layers,)

_register, _unregister = bpy.utils.register_classes_factory(CLASSES)


def register():
    """Register the operator, and put it into the Render menu."""
    _register()
    bpy.types.TOPBAR_MT_render.append(_draw_menu)


def unregister():
    """Undo `register`."""
    bpy.types.TOPBAR_MT_render.remove(_draw_menu)
    _unregister()
