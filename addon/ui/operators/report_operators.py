"""The operator of Render > Report: selecting what a warning is about."""

import bpy
from bpy.props import StringProperty

from ...scene.reported_blocks import objects_of

# Kinds of data-blocks that objects show.
SELECTABLE = frozenset({"object", "camera", "material", "image"})


class APLANAT_OT_select_reported(bpy.types.Operator):
    """Select the objects that show a data-block."""

    bl_idname = "object.aplanat_select_reported"
    bl_label = "Select Reported"
    bl_description = (
        "Select the object that the warning is about, or the objects with this material or image,"
        " and make the first one active"
    )
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    kind: StringProperty(
        name="Kind", description="Object, camera, material or image", options=set()
    )
    name: StringProperty(
        name="Name", description="Of the data-block, with its library", options=set()
    )

    @classmethod
    def poll(cls, context):
        """Whether objects can be selected."""
        if context.mode != "OBJECT":
            cls.poll_message_set("Objects are selected in Object Mode")
            return False
        return True

    def execute(self, context):
        """Select what is there and not hidden."""
        layer = context.view_layer
        found = objects_of(context.evaluated_depsgraph_get(), self.kind, self.name)
        shown = [(obj, slot) for obj, slot in found if obj.visible_get(view_layer=layer)]
        if not shown:
            why = "is hidden" if found else "is shown by no object of this view layer"
            self.report({"WARNING"}, f"{self.kind.capitalize()} '{self.name}' {why}")
            return {"CANCELLED"}
        for obj in layer.objects:
            obj.select_set(False, view_layer=layer)
        for obj, _ in shown:
            obj.select_set(True, view_layer=layer)
        first, slot = shown[0]
        layer.objects.active = first
        if slot is not None:
            first.active_material_index = slot
        return {"FINISHED"}


CLASSES = (APLANAT_OT_select_reported,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
