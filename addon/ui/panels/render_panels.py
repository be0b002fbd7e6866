"""Panels of render, view layer, object, material, light and world in the properties editor."""

import bpy

from ...engine.shared_resources import resources
from ..operators.level_operators import APLANAT_OT_rebuild_levels
from .panel_bases import EnginePanel, SwitchHeader

_GEOMETRY = frozenset({"MESH", "CURVE", "SURFACE", "FONT", "META"})


class APLANAT_RENDER_PT_level_of_detail(SwitchHeader, EnginePanel, bpy.types.Panel):
    """Level of detail of blurred objects."""

    bl_label = "Level of Detail"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "use_levels"

    @classmethod
    def poll(cls, context):
        """Whether the method simplifies anything."""
        return super().poll(context) and context.scene.aplanat.method == "ADAPTIVE"

    def draw(self, context):
        """Draw the settings, and the memory of the levels."""
        settings = context.scene.aplanat
        column = self.column()
        column.active = settings.use_levels
        column.prop(settings, "level_bias")
        column.prop(settings, "least_triangles", text="Triangles")
        store = resources().levels
        done, total = store.progress
        if done < total:
            column.progress(factor=done / total, text=f"{done:,} of {total:,} triangles")
        row = column.row()
        row.label(text=f"{store.memory_bytes / 2**20:.0f} MB in memory")
        row.operator(APLANAT_OT_rebuild_levels.bl_idname, icon="FILE_REFRESH", text="Rebuild")


class APLANAT_RENDER_PT_light(EnginePanel, bpy.types.Panel):
    """How lights reach surfaces."""

    bl_label = "Light"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw the settings of the scene."""
        self.column().prop(context.scene.aplanat, "use_shadows")


class APLANAT_RENDER_PT_film(EnginePanel, bpy.types.Panel):
    """Film: transparency."""

    bl_label = "Film"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw the settings of the scene."""
        self.column().prop(context.scene.render, "film_transparent", text="Transparent")


class APLANAT_RENDER_PT_performance(EnginePanel, bpy.types.Panel):
    """Performance: settings without influence on the picture."""

    bl_label = "Performance"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw the settings of the scene."""
        column = self.column()
        column.prop(context.scene.aplanat, "chunk_milliseconds", text="Chunk (ms)")
        render = context.scene.render
        column.prop(render, "preview_pixel_size", text="Pixel Size")
        compositor = column.column()
        compositor.prop(render, "compositor_device", text="Compositor")
        compositor.prop(render, "compositor_precision", text="Precision")


class APLANAT_RENDER_PT_simplify(SwitchHeader, EnginePanel, bpy.types.Panel):
    """Blender's simplification; Blender's own panel would stand above all others."""

    bl_label = "Simplify"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}
    switch = "use_simplify"

    def owner(self, context):
        """Return Blender's settings."""
        return context.scene.render

    def draw(self, context):
        """Draw Blender's settings."""
        render = context.scene.render
        column = self.column()
        column.active = render.use_simplify
        subdivision = column.column(align=True)
        subdivision.label(text="Max Subdivision")
        subdivision.prop(render, "simplify_subdivision", text="Viewport")
        subdivision.prop(render, "simplify_subdivision_render", text="Render")
        particles = column.column(align=True)
        particles.label(text="Max Child Particles")
        particles.prop(render, "simplify_child_particles", text="Viewport")
        particles.prop(render, "simplify_child_particles_render", text="Render")
        column.prop(render, "use_simplify_normals", text="Viewport Normals")


class APLANAT_VIEWLAYER_PT_data(EnginePanel, bpy.types.Panel):
    """Passes that describe the scene."""

    bl_label = "Data"
    bl_context = "view_layer"
    bl_parent_id = "VIEWLAYER_PT_layer_passes"

    def draw(self, context):
        """Draw Blender's switches and ours."""
        layer = context.view_layer
        column = self.column()
        include = column.column(heading="Include")
        include.prop(layer, "use_pass_z", text="Depth")
        include.prop(layer, "use_pass_normal", text="Normal")
        include.prop(layer, "use_pass_position", text="Position")
        include.prop(layer, "use_pass_vector", text="Vector")
        whole = column.column()
        whole.use_property_split = False
        whole.prop(layer, "pass_alpha_threshold")
        lens = column.column(heading="Lens")
        lens.prop(layer.aplanat, "use_pass_coc")
        lens.prop(layer.aplanat, "use_pass_focus_matte")
        lens.prop(layer.aplanat, "use_pass_fringe")
        parts = column.column(heading="Combined")
        parts.prop(layer.aplanat, "use_pass_defocus")
        parts.prop(layer.aplanat, "use_pass_bokeh")
        diagnosis = column.column(heading="Diagnosis")
        diagnosis.prop(layer.aplanat, "use_pass_detail")
        diagnosis.prop(layer.aplanat, "use_pass_sample_count")


class APLANAT_VIEWLAYER_PT_cryptomatte(EnginePanel, bpy.types.Panel):
    """Mattes by name."""

    bl_label = "Cryptomatte"
    bl_context = "view_layer"
    bl_parent_id = "VIEWLAYER_PT_layer_passes"

    def draw(self, context):
        """Draw Blender's switches."""
        layer = context.view_layer
        column = self.column()
        include = column.column(heading="Include")
        include.prop(layer, "use_pass_cryptomatte_object", text="Object")
        include.prop(layer, "use_pass_cryptomatte_material", text="Material")
        levels = column.column()
        levels.active = layer.use_pass_cryptomatte_object or layer.use_pass_cryptomatte_material
        levels.prop(layer, "pass_cryptomatte_depth", text="Levels")


class APLANAT_VIEWLAYER_PT_filter(EnginePanel, bpy.types.Panel):
    """What a view layer is made of."""

    bl_label = "Filter"
    bl_context = "view_layer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw those of Blender's switches that are followed."""
        column = self.column()
        include = column.column(heading="Include")
        include.prop(context.view_layer, "use_sky", text="Environment")
        include.prop(context.view_layer, "use_solid", text="Surfaces")


class APLANAT_VIEWLAYER_PT_override(EnginePanel, bpy.types.Panel):
    """What a view layer shows in the place of materials and of the world."""

    bl_label = "Override"
    bl_context = "view_layer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw those of Blender's settings that are followed."""
        column = self.column()
        column.prop(context.view_layer, "material_override", text="Material")
        column.prop(context.view_layer, "world_override", text="World")


class APLANAT_LIGHT_PT_shadow(EnginePanel, bpy.types.Panel):
    """Whether what lies in a light's way hides it."""

    bl_label = "Shadow"
    bl_context = "data"
    bl_parent_id = "DATA_PT_EEVEE_light"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw Blender's switch."""
        self.column().prop(context.light, "use_shadow", text="Cast Shadow")


class APLANAT_LIGHT_PT_influence(EnginePanel, bpy.types.Panel):
    """How strongly a light is seen in reflections of each kind."""

    bl_label = "Influence"
    bl_context = "data"
    bl_parent_id = "DATA_PT_EEVEE_light"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw those of Blender's settings that are followed."""
        column = self.column()
        column.use_property_decorate = True
        column.prop(context.light, "diffuse_factor", text="Diffuse")
        column.prop(context.light, "specular_factor", text="Glossy")


class APLANAT_OBJECT_PT_ray_visibility(EnginePanel, bpy.types.Panel):
    """Whether the camera sees an object, and whether it hides light."""

    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    @classmethod
    def poll(cls, context):
        """Whether the active object has a surface."""
        obj = context.object
        return super().poll(context) and obj is not None and obj.type in _GEOMETRY

    def draw(self, context):
        """Draw those of Blender's switches that are followed."""
        column = self.column()
        column.prop(context.object, "visible_camera", text="Camera")
        column.prop(context.object, "visible_shadow", text="Shadow")


class APLANAT_MATERIAL_PT_settings(EnginePanel, bpy.types.Panel):
    """Settings of a material besides its surface."""

    bl_label = "Settings"
    bl_context = "material"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        """Whether there is a material for surfaces."""
        material = context.material
        return super().poll(context) and material is not None and not material.grease_pencil

    def draw(self, context):
        """Draw Blender's settings and ours."""
        column = self.column()
        column.prop(context.material, "use_backface_culling")
        column.prop(context.material.aplanat, "highlights")


class APLANAT_LIGHT_PT_bokeh(EnginePanel, bpy.types.Panel):
    """Whether a light's reflections are bokeh."""

    bl_label = "Bokeh"
    bl_context = "data"
    bl_parent_id = "DATA_PT_EEVEE_light"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        """Draw the choice."""
        self.column().prop(context.light.aplanat, "highlights")


class APLANAT_WORLD_PT_whites(EnginePanel, bpy.types.Panel):
    """Amplify Whites: the brightness of clipped whites of the world's image."""

    bl_label = "Whites"
    bl_context = "world"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        """Whether there is a world."""
        return super().poll(context) and context.world is not None

    def draw(self, context):
        """Draw the setting."""
        self.column().prop(context.world.aplanat, "amplification", text="Amplify")


CLASSES = (
    APLANAT_RENDER_PT_level_of_detail,
    APLANAT_RENDER_PT_light,
    APLANAT_RENDER_PT_film,
    APLANAT_RENDER_PT_performance,
    APLANAT_RENDER_PT_simplify,
    APLANAT_VIEWLAYER_PT_data,
    APLANAT_VIEWLAYER_PT_cryptomatte,
    APLANAT_VIEWLAYER_PT_filter,
    APLANAT_VIEWLAYER_PT_override,
    APLANAT_OBJECT_PT_ray_visibility,
    APLANAT_MATERIAL_PT_settings,
    APLANAT_LIGHT_PT_shadow,
    APLANAT_LIGHT_PT_influence,
    APLANAT_LIGHT_PT_bokeh,
    APLANAT_WORLD_PT_whites,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
