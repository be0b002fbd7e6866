"""Operators on the levels of detail."""

import bpy

from ...engine.shared_resources import resources


class APLANAT_OT_rebuild_levels(bpy.types.Operator):
    """Forget all levels of detail, in memory and on disk, and make them anew."""

    bl_idname = "render.aplanat_rebuild_levels"
    bl_label = "Rebuild Levels of Detail"
    bl_description = "Forget all levels of detail, in memory and on disk, and make them anew"

    def execute(self, context):
        """Rebuild, and have every view drawn again."""
        resources().levels.rebuild()
        for window in context.window_manager.windows:
            for area in window.screen.areas:
                area.tag_redraw()
        return {"FINISHED"}


CLASSES = (APLANAT_OT_rebuild_levels,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
