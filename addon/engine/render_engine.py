"""Aplanat in Blender's list of render engines."""

import bpy

from ..device import context
from ..errors import AplanatError
from ..scene.extract import SceneExtractor
from .pipeline import FrameRenderer
from .plan import plan_frame
from .scene_buffers import SceneBuffers

ENGINE_ID = "APLANAT"


class AplanatRenderEngine(bpy.types.RenderEngine):
    """Renders the scene through a lens."""

    bl_idname = ENGINE_ID
    bl_label = "Aplanat"
    bl_use_preview = False
    bl_use_postprocess = True
    # In the background the render thread owns the GPU context; in the user interface it must not,
    # or Blender freezes until the render ends.
    bl_use_gpu_context = bpy.app.background

    def render(self, depsgraph):
        """Render one view layer."""
        try:
            self._render(depsgraph)
        except AplanatError as error:
            self.error_set(str(error))
            self.report({"ERROR"}, str(error))

    def _render(self, depsgraph):
        context.ensure_context()
        snapshot = SceneExtractor().extract(depsgraph)
        buffers = SceneBuffers()
        buffers.update(snapshot.content)
        renderer = FrameRenderer(plan_frame(snapshot), snapshot, buffers)
        renderer.advance(renderer.plan.samples)
        image = renderer.read_image()
        _, _, width, height = snapshot.film.region
        result = self.begin_result(0, 0, width, height, layer=snapshot.layer_name)
        try:
            result.layers[0].passes["Combined"].rect.foreach_set(image.reshape(-1))
        finally:
            self.end_result(result)
        renderer.release()


register, unregister = bpy.utils.register_classes_factory((AplanatRenderEngine,))
