"""Compositor > Sidebar > Aplanat: the picture through our nodes, and the sprite of the lens."""

import bpy

from ..operators.compositor_operators import (
    APLANAT_OT_add_asset_library,
    APLANAT_OT_add_bokeh_sprite,
    APLANAT_OT_bokeh_image,
    APLANAT_OT_wire_compositor,
)


class APLANAT_NODE_PT_compositing(bpy.types.Panel):
    """Buttons that set up the compositor."""

    bl_space_type = "NODE_EDITOR"
    bl_region_type = "UI"
    bl_category = "Aplanat"
    bl_label = "Compositing"

    @classmethod
    def poll(cls, context):
        """Whether this is the compositor."""
        return context.space_data.tree_type == "CompositorNodeTree"

    def draw(self, context):
        """Draw the buttons."""
        column = self.layout.column()
        column.label(text="Set Up With")
        row = column.row(align=True)
        name = APLANAT_OT_wire_compositor.bl_idname
        row.operator(name, text="Render", icon="RENDERLAYERS").source = "RENDER"
        refocused = row.row(align=True)
        refocused.enabled = bool(context.scene.aplanat.refocus.output)
        refocused.operator(name, text="Refocused", icon="IMAGE_DATA").source = "REFOCUSED"
        column.separator()
        column.label(text="Bokeh Sprite of Camera")
        row = column.row(align=True)
        row.operator(APLANAT_OT_add_bokeh_sprite.bl_idname, text="Add Node", icon="NODE")
        row.operator(APLANAT_OT_bokeh_image.bl_idname, text="Draw Anew", icon="FILE_REFRESH")
        if APLANAT_OT_add_asset_library.poll(context):
            column.separator()
            name = APLANAT_OT_add_asset_library.bl_idname
            column.operator(name, text="Show in Asset Browser", icon="ASSET_MANAGER")


CLASSES = (APLANAT_NODE_PT_compositing,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
