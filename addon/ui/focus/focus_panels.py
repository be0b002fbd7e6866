"""Where the focus in the 3D view is switched on: the camera's panel and the overlays' popover."""

import bpy

from .focus_operators import APLANAT_OT_focus_pick, APLANAT_OT_focus_pull


class APLANAT_VIEW3D_PT_focus_overlay(bpy.types.Panel):
    """Overlays of the focus."""

    bl_label = "Focus"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_parent_id = "VIEW3D_PT_overlay"

    def draw(self, context):
        """Draw the settings; they are of no use without depth of field."""
        settings, camera = context.scene.aplanat, context.scene.camera
        layout = self.layout
        layout.use_property_split = False
        blurs = camera is not None and camera.type == "CAMERA" and camera.data.dof.use_dof
        layout.active = context.space_data.overlay.show_overlays and blurs
        row = layout.row(align=True)
        row.prop(settings, "show_coc", text="Circle of Confusion")
        row.prop(settings, "show_focus_planes", text="Depth of Field")
        layout.prop(settings, "acceptable_blur")


def _draw_buttons(panel, context):
    """Add to Blender's panel Depth of Field what sets the focus of the scene's camera."""
    camera = context.scene.camera
    if camera is None or camera.data != context.camera:
        return
    settings, column = context.scene.aplanat, panel.layout.column(align=True)
    row = column.row(align=True)
    row.operator(APLANAT_OT_focus_pick.bl_idname, icon="EYEDROPPER")
    row.operator(APLANAT_OT_focus_pull.bl_idname, icon="ANIM")
    row = column.row(align=True)
    row.prop(settings, "show_coc", text="Show Blur", toggle=True, icon="OVERLAY")
    row.prop(settings, "show_focus_planes", text="Show Planes", toggle=True, icon="GIZMO")


CLASSES = (APLANAT_VIEW3D_PT_focus_overlay,)

_register, _unregister = bpy.utils.register_classes_factory(CLASSES)


def register():
    """Register the panel, and add to Blender's."""
    _register()
    bpy.types.DATA_PT_camera_dof.append(_draw_buttons)


def unregister():
    """Undo `register`."""
    bpy.types.DATA_PT_camera_dof.remove(_draw_buttons)
    _unregister()
