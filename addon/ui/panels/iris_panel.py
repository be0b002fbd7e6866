"""Camera > Lens > Iris: the shape of the opening, of the whole picture's blur and of its discs."""

import bpy

from ...engine.shared_resources import real_lens_of, resources
from ...scene.camera.irises import read_opening
from .panel_bases import CameraPanel
from .sentences import draw_alert, draw_sentences, letters_across


class APLANAT_CAMERA_PT_iris(CameraPanel, bpy.types.Panel):
    """The iris: curvature of its blades, the round stop in front of them, or an image."""

    bl_label = "Iris"
    bl_parent_id = "DATA_PT_lens"
    bl_options = {"DEFAULT_CLOSED"}
    group = "bokeh"

    def draw(self, context):
        """Draw the settings, and what is wrong with an image."""
        camera = context.camera
        settings, column = self.owner(context), self.column()
        column.use_property_decorate = True
        lens, letters = real_lens_of(camera), letters_across(context)
        blades = column.column()
        blades.active = settings.iris_image is None and camera.dof.aperture_blades > 2
        blades.prop(settings, "blade_curvature", text="Curvature", slider=True)
        stop = blades.column()
        stop.active = blades.active and lens is not None
        stop.prop(settings, "use_round_stop")
        image = column.column()
        image.use_property_decorate = False
        image.template_ID(settings, "iris_image", open="image.open", text="Image")
        notes = column.column(align=True)
        text = "Blades, rotation and ratio (anamorphic): Depth of Field > Aperture."
        draw_sentences(notes, text, letters, icon="INFO")
        if camera.dof.use_dof:
            opening, problems = read_opening(camera, lens, resources().panels.sources.irises)
            for problem in problems:
                draw_alert(notes, f"{problem[0].upper()}{problem[1:]}.", letters)
            if not problems and getattr(opening, "closing", None) and opening.is_round:
                text = f"Round at f/{lens.f_number:.3g}: the blades show when it is stopped down."
                draw_sentences(notes, text, letters, icon="INFO")


CLASSES = (APLANAT_CAMERA_PT_iris,)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
