"""Aplanat in Blender's list of render engines."""

import bpy

from ..errors import AplanatError, RenderCancelledError
from ..scene.settings import read_passes
from . import final_render, gpu_thread, viewport_text
from .frame import render_passes
from .report import failure, one_line
from .shared_resources import resources
from .viewport import Viewport

ENGINE_ID = "APLANAT"


class AplanatRenderEngine(bpy.types.RenderEngine):
    """Renders the scene through a lens."""

    bl_idname = ENGINE_ID
    bl_label = "Aplanat"
    bl_use_preview = False
    bl_use_postprocess = True
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False
    # In the background the render thread owns the GPU context; in the user interface it must not,
    # or Blender freezes until the render ends.
    bl_use_gpu_context = bpy.app.background

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        # Made by the first 3D view that asks; a final render has none.
        self._viewport = None
        # Of the last frame, where Blender keeps this instance and its evaluated scene.
        self._kept = None

    def render(self, depsgraph):
        """Render one view layer."""
        session = resources().renders.current()
        with session.in_use():
            self._render(depsgraph, session)

    def _render(self, depsgraph, session):
        heard = session.outcome
        persistent = depsgraph.scene.render.use_persistent_data
        earlier, self._kept = self._kept if persistent else None, None
        kept = earlier or session.kept_scenes(depsgraph.scene)
        try:
            final_render.render_view_layer(self, depsgraph, session, kept, earlier is None)
            self._kept = kept if persistent else None
        except RenderCancelledError:
            heard.cancelled = True
        except AplanatError as error:
            heard.error = error
            self.error_set(str(error))
            self.report({"ERROR"}, str(error))
            session.note_findings(depsgraph.scene, "render", session.warnings, one_line(error))
        except Exception as error:
            # Blender prints the traceback and goes on as if there were a picture: the listener
            # must still get the error.
            heard.error = error
            self.error_set(f"Aplanat failed, see the console: {error}")
            # Without an error report Blender goes on to write the picture that is not there, and a
            # multilayer file of nothing crashes it.
            self.report({"ERROR"}, f"Aplanat failed, see the console: {error}")
            session.note_findings(depsgraph.scene, "render", session.warnings, failure(error))
            raise

    def update_render_passes(self, scene=None, renderlayer=None):
        """Tell Blender which passes a view layer has."""
        if scene is not None and renderlayer is not None:
            render_passes.register(self, scene, renderlayer, read_passes(renderlayer))

    def view_update(self, context, depsgraph):
        """Note the changes in the scene of a 3D view."""
        if self._viewport is None:
            self._viewport = Viewport()
        self._viewport.note_updates(depsgraph, context.space_data)

    def view_draw(self, context, depsgraph):
        """Draw the picture of a 3D view, with more samples than the last time."""
        unfinished = False
        try:
            unfinished = self._viewport.draw(
                depsgraph,
                context.space_data,
                context.region,
                context.region_data,
                int(self.get_preview_pixel_size(depsgraph.scene)),
            )
        finally:
            self.update_stats("", self._viewport.text)
            if self._viewport.failed and not _shows_text(context.space_data.overlay):
                viewport_text.draw(self._viewport.text, context.area, context.region)
        if unfinished:
            self.tag_redraw()


def _shows_text(overlay):
    """Whether Blender itself writes the status line into a 3D view."""
    return overlay.show_overlays and overlay.show_text


_register, _unregister = bpy.utils.register_classes_factory((AplanatRenderEngine,))


def register():
    """Register the engine, and the timer by which the main thread does its GPU work."""
    _register()
    if not bpy.app.background:
        bpy.app.timers.register(gpu_thread.work_off_one_job, persistent=True)


def unregister():
    """Undo `register`."""
    if bpy.app.timers.is_registered(gpu_thread.work_off_one_job):
        bpy.app.timers.unregister(gpu_thread.work_off_one_job)
    _unregister()
