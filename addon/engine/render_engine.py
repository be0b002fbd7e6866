"""Aplanat in Blender's list of render engines."""

import bpy

from ..device import context
from ..errors import AplanatError
from ..scene.extract import SceneExtractor
from . import outcome
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
        heard = outcome.current()
        try:
            self._render(depsgraph, heard)
        except AplanatError as error:
            heard.error = error
            self.error_set(str(error))
            self.report({"ERROR"}, str(error))

    def _render(self, depsgraph, heard):
        context.ensure_context()
        statistics = heard.statistics
        statistics.device = context.device_name()
        with statistics.timed("extract"):
            snapshot = SceneExtractor().extract(depsgraph)
        heard.note(snapshot.content.report)
        with statistics.timed("upload"):
            buffers = SceneBuffers()
            buffers.update(snapshot.content)
        with statistics.timed("plan"):
            renderer = FrameRenderer(plan_frame(snapshot), snapshot, buffers)
        with statistics.timed("draw"):
            renderer.advance(renderer.plan.samples)
        with statistics.timed("read_back"):
            image = renderer.read_image()
        statistics.lens_samples += renderer.samples_done
        statistics.draw_calls += renderer.draw_calls
        statistics.triangles_submitted += renderer.triangles
        statistics.triangles_full_detail += renderer.triangles
        x, y, width, height = snapshot.film.region
        result = self.begin_result(0, 0, width, height, layer=snapshot.layer_name)
        try:
            result.layers[0].passes["Combined"].rect.foreach_set(image.reshape(-1))
        finally:
            self.end_result(result)
        if heard.keeps_pictures:
            heard.layers.append(
                outcome.LayerPicture(
                    scene=depsgraph.scene.name,
                    layer=snapshot.layer_name,
                    region=(x, y, width, height),
                    size=(snapshot.film.width, snapshot.film.height),
                    passes={"Combined": outcome.PassPicture("RGBA", image)},
                )
            )
        renderer.release()


register, unregister = bpy.utils.register_classes_factory((AplanatRenderEngine,))
