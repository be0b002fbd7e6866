"""What Aplanat adds to Blender's data-blocks: one property group each."""

import bpy
from bpy.props import EnumProperty, IntProperty, PointerProperty


class AplanatSceneSettings(bpy.types.PropertyGroup):
    """How a scene is sampled."""

    render_samples: IntProperty(
        name="Render",
        description="Lens samples of the final render",
        default=256,
        min=1,
        max=65536,
        soft_max=4096,
    )
    preview_samples: IntProperty(
        name="Viewport",
        description="Lens samples after which the viewport rests",
        default=64,
        min=1,
        max=65536,
        soft_max=1024,
    )
    seed: IntProperty(name="Seed", description="Rotates the sample sequence", default=0, min=0)
    pixel_filter: EnumProperty(
        name="Pixel Filter",
        description="How samples are gathered into a pixel; the width is the scene's filter size",
        items=(
            ("BLACKMAN_HARRIS", "Blackman-Harris", "Smooth edges without ringing"),
            ("BOX", "Box", "Every sample counts for the pixel it falls into"),
        ),
        default="BLACKMAN_HARRIS",
    )


CLASSES = (AplanatSceneSettings,)

_register, _unregister = bpy.utils.register_classes_factory(CLASSES)


def register():
    """Register the groups and hang them on Blender's data-blocks."""
    _register()
    bpy.types.Scene.aplanat = PointerProperty(type=AplanatSceneSettings)


def unregister():
    """Undo `register`."""
    del bpy.types.Scene.aplanat
    _unregister()
