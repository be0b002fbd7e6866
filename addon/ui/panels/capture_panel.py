"""The panel of captured depth layers, in the render properties of each engine that makes them."""

import bpy

from ...capture.settings import ENGINES


class APLANAT_RENDER_PT_layers(bpy.types.Panel):
    """Depth Layers: how many, how much beyond the border, and where they go."""

    bl_label = "Depth Layers"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}
    COMPAT_ENGINES = set(ENGINES)

    @classmethod
    def poll(cls, context):
        """Whether the scene's engine makes layers."""
        return context.engine in cls.COMPAT_ENGINES

    def draw(self, context):
        """Draw the settings and the button that captures."""
        layout, settings = self.layout, context.scene.aplanat.capture
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.prop(settings, "layers")
        column.prop(settings, "overscan")
        column.prop(settings, "path")
        row = layout.row()
        row.operator_context = "INVOKE_DEFAULT"
        name = "render.aplanat_capture_layers"
        row.operator(name, text="Capture", icon="RENDERLAYERS")
        row.operator(name, text="Capture Animation").animation = True


CLASSES = (APLANAT_RENDER_PT_layers,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
