"""Aplanat in Blender's list of render engines."""

import bpy

from ..errors import AplanatError, RenderCancelledError
from ..scene.settings import read_passes
from . import final_render, gpu_thread, outcome, render_passes

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

    def render(self, depsgraph):
        """Render one view layer."""
        heard = outcome.current()
        try:
            final_render.render_view_layer(self, depsgraph, heard)
        except RenderCancelledError:
            heard.cancelled = True
        except AplanatError as error:
            heard.error = error
            self.error_set(str(error))
            self.report({"ERROR"}, str(error))
        except Exception as error:
            # Blender prints the traceback and goes on as if there were a picture: whoever started
            # the render must still hear that there is none.
            heard.error = error
            self.error_set(f"Aplanat failed, see the console: {error}")
            raise

    def update_render_passes(self, scene=None, renderlayer=None):
        """Tell Blender which passes a view layer has."""
        if scene is not None and renderlayer is not None:
            render_passes.register(self, scene, renderlayer, read_passes(renderlayer))


_register, _unregister = bpy.utils.register_classes_factory((AplanatRenderEngine,))


def register():
    """Register the engine and have the main thread look for its work."""
    _register()
    if not bpy.app.background:
        bpy.app.timers.register(gpu_thread.work_off_one_job, persistent=True)


def unregister():
    """Undo `register`."""
    if bpy.app.timers.is_registered(gpu_thread.work_off_one_job):
        bpy.app.timers.unregister(gpu_thread.work_off_one_job)
    _unregister()
