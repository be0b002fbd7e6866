"""The operator that captures depth layers, render by render, while the window stays alive."""

import uuid

import bpy

from ...capture.capture_files import source_digest
from ...capture.frame_capture import render_now
from ...capture.settings import ENGINES, CaptureSettings
from ...capture.shot_capture import capture_shot
from ...files.frame_path import frame_path
from ...files.whole_file import check_writable
from .stepwise import StepwiseOperator, frames_of, output_pattern


class APLANAT_OT_capture_layers(StepwiseOperator, bpy.types.Operator):
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

    # A look whether a render has ended.
    _interval = 0.05
    _stopped_line = "Capture stopped; the scene is as it was"

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

    def _begin(self, context):
        scene, own = context.scene, context.scene.aplanat.capture
        frames = frames_of(scene, self.animation)
        pattern = output_pattern(own.path, len(frames) > 1, "Layers File", "the layers", (".exr",))
        settings = CaptureSettings(scene.render.engine, own.layers, round(own.overscan, 6))
        # What is not saved is no file that could be compared.
        unsaved = bpy.data.is_dirty or not bpy.data.filepath
        source = uuid.uuid4().hex if unsaved else source_digest(bpy.data.filepath)
        check_writable(frame_path(pattern, frames[0]))
        self._done_line = (
            f"Captured into {pattern if self.animation else frame_path(pattern, frames[0])}"
        )
        self._steps = capture_shot(scene, frames, settings, pattern, source, self._note)

    def _do_now(self, step):
        _frame, render, _share = step
        render_now(render)

    def _open_window(self, context):
        view = context.preferences.view
        # The pictures of slices are nothing to look at, and would take the place of another editor.
        self._shown, self._dirty = view.render_display_type, context.preferences.is_dirty
        view.render_display_type = "NONE"
        self._started = self._ended = False
        bpy.app.handlers.render_complete.append(self._on_complete)
        bpy.app.handlers.render_cancel.append(self._on_cancel)

    def _pass_on(self, event):
        # Esc and the X of the status bar, below all editors, also end the render itself; all else
        # waits until the scene is itself again.
        below = min((area.y for area in bpy.context.screen.areas), default=0)
        if event.type == "ESC" or event.mouse_y < below:
            return {"PASS_THROUGH"}
        return {"RUNNING_MODAL"}

    def _waits(self):
        return bpy.app.is_job_running("RENDER") or (self._started and not self._ended)

    def _show(self, context, step):
        frame, render, share = step
        text = f"Capturing frame {frame}: {render.text} ({render.done + 1} of {render.total})"
        self._tell_progress(context, text, share)
        self._started, self._ended = True, False
        with context.temp_override(scene=render.scene, view_layer=render.view_layer):
            begun = bpy.ops.render.render("INVOKE_DEFAULT", write_still=True)
        if "RUNNING_MODAL" not in begun:
            self._ended = True
            self._stopped = "CANCELLED" in begun
        return {"PASS_THROUGH"}

    def _on_complete(self, *_):
        self._ended = True

    def _on_cancel(self, *_):
        self._ended = self._stopped = True

    def _close_window(self, context):
        # The generator's own `with` blocks remove the copy of the scene.
        super()._close_window(context)
        for handlers, function in (
            (bpy.app.handlers.render_complete, self._on_complete),
            (bpy.app.handlers.render_cancel, self._on_cancel),
        ):
            if function in handlers:
                handlers.remove(function)
        context.preferences.view.render_display_type = self._shown
        context.preferences.is_dirty = self._dirty


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
