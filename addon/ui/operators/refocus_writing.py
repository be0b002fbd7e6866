"""The operator that writes refocused pictures, while the window stays alive."""

import contextlib
from pathlib import Path

import bpy

from ...capture.kept_values import KeptValues
from ...engine.refocus.frames import write_frames
from ...engine.refocus.pictures import save_picture
from ...engine.refocus.scene_refocus import layers_path
from ...engine.shared_resources import resources
from ...files.frame_path import frame_path
from ...files.whole_file import check_writable
from ...layers.captured_files import check_apart
from ..jobs import live_refocus
from .stepwise import StepwiseOperator, frames_of, output_pattern


class APLANAT_OT_refocus_write(StepwiseOperator, bpy.types.Operator):
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

    _interval = 0.001
    _stopped_line = "Stopped; files that are there are whole"

    @classmethod
    def poll(cls, context):
        """Whether something is open."""
        if context.scene is None or not context.scene.aplanat.refocus.path:
            cls.poll_message_set("No depth layers are open")
            return False
        return not bpy.app.is_job_running("RENDER")

    def _begin(self, context):
        scene = context.scene
        self._scene, self._frame = scene, scene.frame_current
        self._kept = contextlib.ExitStack()
        frames = frames_of(scene, self.animation)
        self._output = output_pattern(
            scene.aplanat.refocus.output,
            len(frames) > 1,
            "Picture File",
            "the pictures",
            (".exr", ".png"),
        )
        self._done_line = f"Written: {self._output}"
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

    def _show(self, context, step):
        frame, share = step
        self._tell_progress(context, f"Refocusing frame {frame}", share)
        return {"RUNNING_MODAL"}

    def _end(self):
        self._steps.close()
        if self._frame != self._scene.frame_current:
            self._scene.frame_set(self._frame)
        self._kept.close()


CLASSES = (APLANAT_OT_refocus_write,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
