"""Property groups that Aplanat adds to Blender's data-blocks, one each."""

import bpy
from bpy.props import PointerProperty

from ...settings.scene_part_settings import LAMP, MATERIAL, WORLD
from ...settings.scene_settings import SCENE, VIEW_LAYER
from ..previews.spectrum_bar import AplanatSpectrumBar
from .bokeh_properties import AplanatBokehSettings
from .camera_properties import AplanatCameraSettings
from .capture_properties import AplanatCaptureSettings
from .chromatic_properties import AplanatChromaticSettings
from .declared import properties
from .overrides import OVERRIDABLE, SHARED
from .refocus_properties import AplanatRefocusSettings


class AplanatSceneSettings(bpy.types.PropertyGroup):
    """Sampling, level of detail, performance and capture settings of a scene."""

    __annotations__ = properties(*SCENE) | {
        "capture": PointerProperty(
            name="Depth Layers",
            description="How depth layers of the scene are captured",
            type=AplanatCaptureSettings,
        ),
        "refocus": PointerProperty(
            name="Refocus",
            description="How a captured picture is seen through the lens again",
            type=AplanatRefocusSettings,
        ),
    }


def _update_passes(_group, context):
    context.view_layer.update_render_passes()


class AplanatViewLayerSettings(bpy.types.PropertyGroup):
    """Passes that only Aplanat has."""

    __annotations__ = properties(*VIEW_LAYER, update=_update_passes)


class AplanatMaterialSettings(bpy.types.PropertyGroup):
    """Settings of a material: whether its light may be a highlight."""

    __annotations__ = properties(MATERIAL, **SHARED)


class AplanatLightSettings(bpy.types.PropertyGroup):
    """Settings of a light: whether its reflections may be highlights."""

    __annotations__ = properties(LAMP, **SHARED)


class AplanatWorldSettings(bpy.types.PropertyGroup):
    """Settings of a world: Amplify Whites."""

    __annotations__ = properties(WORLD, **SHARED)


CLASSES = (
    AplanatCaptureSettings,
    AplanatRefocusSettings,
    AplanatSceneSettings,
    AplanatViewLayerSettings,
    AplanatMaterialSettings,
    AplanatLightSettings,
    AplanatWorldSettings,
    AplanatBokehSettings,
    AplanatSpectrumBar,
    AplanatChromaticSettings,
    AplanatCameraSettings,
)

_register, _unregister = bpy.utils.register_classes_factory(CLASSES)


def register():
    """Register the groups and hang them on Blender's data-blocks."""
    _register()
    bpy.types.Scene.aplanat = PointerProperty(type=AplanatSceneSettings)
    bpy.types.ViewLayer.aplanat = PointerProperty(type=AplanatViewLayerSettings)
    bpy.types.Material.aplanat = PointerProperty(type=AplanatMaterialSettings, override=OVERRIDABLE)
    bpy.types.Light.aplanat = PointerProperty(type=AplanatLightSettings, override=OVERRIDABLE)
    bpy.types.World.aplanat = PointerProperty(type=AplanatWorldSettings, override=OVERRIDABLE)
    bpy.types.Camera.aplanat = PointerProperty(type=AplanatCameraSettings, override=OVERRIDABLE)


def unregister():
    """Undo `register`."""
    del bpy.types.Camera.aplanat
    del bpy.types.World.aplanat
    del bpy.types.Light.aplanat
    del bpy.types.Material.aplanat
    del bpy.types.ViewLayer.aplanat
    del bpy.types.Scene.aplanat
    _unregister()
