"""Property groups that Aplanat adds to Blender's data-blocks, one each."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
)

from ..previews.spectrum_bar import AplanatSpectrumBar
from .bokeh_properties import AplanatBokehSettings
from .camera_properties import AplanatCameraSettings
from .capture_properties import AplanatCaptureSettings
from .chromatic_properties import AplanatChromaticSettings
from .overrides import OVERRIDABLE, setting_changed

# Also what the command line accepts.
MAX_SAMPLES = 65536


class AplanatSceneSettings(bpy.types.PropertyGroup):
    """Sampling, level of detail and performance settings of a scene."""

    method: EnumProperty(
        name="Method",
        description="How the picture is put together from views through the lens",
        items=(
            (
                "ADAPTIVE",
                "Adaptive",
                "Draw blurred objects with fewer triangles, share drawings of what is in focus, and"
                " blur each lens sample over the part of the lens it stands for",
            ),
            (
                "REFERENCE",
                "Reference",
                "Draw everything in full detail for every lens sample: exact, the slowest",
            ),
            (
                "LAYERED",
                "Layered",
                "Draw the scene once for each depth layer, and cast the rays of all lens samples"
                " through the layers: the time hardly depends on the number of triangles",
            ),
        ),
        default="ADAPTIVE",
    )
    layers: IntProperty(
        name="Layers",
        description="Depth layers of the layered method. More keep more of what hides behind one"
        " another, and take more time and memory",
        default=8,
        min=1,
        max=64,
        soft_min=4,
        soft_max=16,
    )
    use_target_error: BoolProperty(
        name="Noise Threshold",
        description="Draw samples until the picture is as good as one number for quality asks,"
        " where they are needed; the error is measured while the picture is drawn",
        default=True,
    )
    render_error: FloatProperty(
        name="Render Noise Threshold",
        description="How much the final render may differ from a perfect one, as 1 - SSIM: 0.02 is"
        " a draft, 0.01 looks clean, 0.002 is for large prints. It changes the noise, never the"
        " amount of blur",
        default=0.01,
        min=0.0005,
        max=0.5,
        soft_max=0.05,
        precision=4,
        step=0.1,
    )
    preview_error: FloatProperty(
        name="Viewport Noise Threshold",
        description="How much the picture may differ from a perfect one when the viewport rests, as"
        " 1 - SSIM",
        default=0.03,
        min=0.0005,
        max=0.5,
        soft_max=0.1,
        precision=4,
        step=0.1,
    )
    render_min_samples: IntProperty(
        name="Render Min Samples",
        description="Lens samples that every part of the final render gets at least. More find"
        " small and rare things that few samples miss",
        default=16,
        min=1,
        max=MAX_SAMPLES,
        soft_max=4096,
    )
    render_max_samples: IntProperty(
        name="Render Max Samples",
        description="Lens samples at which the final render stops even if it is above its noise"
        " threshold",
        default=4096,
        min=1,
        max=MAX_SAMPLES,
    )
    render_time_limit: FloatProperty(
        name="Render Time Limit",
        description="Seconds of drawing at which sampling stops, but not before Min Samples; 0 is"
        " no limit. With a limit, the noise depends on how fast and how busy the machine is",
        default=0.0,
        min=0.0,
        soft_max=3600.0,
        subtype="TIME_ABSOLUTE",
        unit="TIME_ABSOLUTE",
    )
    preview_min_samples: IntProperty(
        name="Viewport Min Samples",
        description="Lens samples that every part of the viewport gets at least",
        default=16,
        min=1,
        max=MAX_SAMPLES,
        soft_max=1024,
    )
    preview_max_samples: IntProperty(
        name="Viewport Max Samples",
        description="Lens samples at which the viewport rests even if it is above its noise"
        " threshold",
        default=1024,
        min=1,
        max=MAX_SAMPLES,
    )
    preview_time_limit: FloatProperty(
        name="Viewport Time Limit",
        description="Seconds of drawing at which it rests, but not before Min Samples; 0 is no"
        " limit",
        default=0.0,
        min=0.0,
        soft_max=60.0,
        subtype="TIME_ABSOLUTE",
        unit="TIME_ABSOLUTE",
    )
    render_samples: IntProperty(
        name="Render",
        description="Places on the lens from which the final render sees the scene. More make"
        " blurred parts smoother; the amount of blur stays the same",
        default=256,
        min=1,
        max=MAX_SAMPLES,
        soft_max=4096,
    )
    preview_samples: IntProperty(
        name="Viewport",
        description="Lens samples after which the viewport rests",
        default=64,
        min=1,
        max=MAX_SAMPLES,
        soft_max=1024,
    )
    subsamples: IntProperty(
        name="Subsamples",
        description="Places on the lens for which each lens sample is blurred besides its own. They"
        " cost less than samples, but see only what the sample sees",
        default=4,
        min=0,
        max=64,
        soft_max=8,
    )
    use_sharing: BoolProperty(
        name="Share Drawings",
        description="Draw what is nearly in focus once for all lens samples that put it at the same"
        " place of the raster",
        default=True,
    )
    sharing_cells: IntProperty(
        name="Cells",
        description="Places along a pixel that are told apart when drawings are shared. More give"
        " smoother edges, fewer share more",
        default=2,
        min=1,
        max=8,
    )
    use_levels: BoolProperty(
        name="Level of Detail",
        description="Draw blurred objects with fewer triangles; what is in focus keeps all of them",
        default=True,
    )
    level_bias: FloatProperty(
        name="Bias",
        description="Levels of detail by which objects are drawn finer (or coarser, if negative)"
        " than their blur asks for; each has twice the triangles",
        default=0.0,
        soft_min=-4.0,
        soft_max=4.0,
        min=-16.0,
        max=16.0,
    )
    least_triangles: IntProperty(
        name="Minimum Triangles",
        description="No level of detail has fewer triangles",
        default=256,
        min=4,
        soft_max=10000,
        max=10000000,
    )
    use_reference_bokeh: BoolProperty(
        name="Separate Highlights",
        description="Draw the cameras' bokeh with the reference method, too. Without it, highlights"
        " are sampled as everything else",
        default=False,
    )
    seed: IntProperty(
        name="Seed",
        description="Chooses another pattern of samples; the same seed gives the same picture",
        default=0,
        min=0,
    )
    pixel_filter: EnumProperty(
        name="Pixel Filter",
        description="How samples are gathered into a pixel",
        items=(
            ("BLACKMAN_HARRIS", "Blackman-Harris", "Smooth edges without ringing"),
            ("BOX", "Box", "Every place of the pixel counts the same"),
        ),
        default="BLACKMAN_HARRIS",
    )
    chunk_milliseconds: IntProperty(
        name="Chunk",
        description="How long a final render may draw before it lets the window answer, in"
        " milliseconds. Longer renders a little faster; shorter keeps Blender more responsive",
        default=50,
        min=10,
        max=2000,
        soft_max=500,
    )
    capture: PointerProperty(
        name="Depth Layers",
        description="How depth layers of the scene are captured",
        type=AplanatCaptureSettings,
    )


def _update_passes(_group, context):
    context.view_layer.update_render_passes()


class AplanatViewLayerSettings(bpy.types.PropertyGroup):
    """Passes that only Aplanat has."""

    use_pass_coc: BoolProperty(
        name="Circle of Confusion",
        description="Radius of the blur disk of the point in each pixel's centre, in pixels;"
        " negative in front of the focus plane",
        default=False,
        update=_update_passes,
    )
    use_pass_detail: BoolProperty(
        name="Detail",
        description="Where the adaptive method saves work: level of detail (X), share of the lens"
        " samples that copy a drawing of the object (Y), and 1 where there is an object (Z)",
        default=False,
        update=_update_passes,
    )
    use_pass_sample_count: BoolProperty(
        name="Sample Count",
        description="Lens samples that each pixel got: with a noise threshold, more where the"
        " picture needs them",
        default=False,
        update=_update_passes,
    )
    use_pass_focus_matte: BoolProperty(
        name="Focus Matte",
        description="Share of each pixel that is in focus, blurred like the picture: 1 up to a"
        " blur of 1/1500 of the picture's diagonal (at least a pixel), then falling to 0",
        default=False,
        update=_update_passes,
    )
    use_pass_defocus: BoolProperty(
        name="Defocus",
        description="What the lens samples show: Combined without the highlights that were drawn"
        " one by one",
        default=False,
        update=_update_passes,
    )
    use_pass_bokeh: BoolProperty(
        name="Bokeh",
        description="The highlights that were drawn one by one. Defocus and Bokeh together are"
        " Combined",
        default=False,
        update=_update_passes,
    )
    use_pass_fringe: BoolProperty(
        name="Fringe",
        description="What chromatic aberration adds and takes away: Combined less the same picture"
        " without it, which is rendered beside it",
        default=False,
        update=_update_passes,
    )


_HIGHLIGHTS = (
    ("AUTOMATIC", "Automatic", "Where it is bright and blurred enough"),
    ("NEVER", "Never", "It is sampled as everything else, however bright it is"),
)


class AplanatMaterialSettings(bpy.types.PropertyGroup):
    """Settings of a material: whether its light may be a highlight."""

    highlights: EnumProperty(
        name="Highlights",
        description="Whether the light of surfaces with this material is drawn as bokeh where it is"
        " brighter than the camera's threshold",
        items=_HIGHLIGHTS,
        default="AUTOMATIC",
        override=OVERRIDABLE,
        update=setting_changed,
    )


class AplanatLightSettings(bpy.types.PropertyGroup):
    """Settings of a light: whether its reflections may be highlights."""

    highlights: EnumProperty(
        name="Highlights",
        description="Whether what surfaces reflect of this light is drawn as bokeh where it is"
        " brighter than the camera's threshold",
        items=_HIGHLIGHTS,
        default="AUTOMATIC",
        override=OVERRIDABLE,
        update=setting_changed,
    )


class AplanatWorldSettings(bpy.types.PropertyGroup):
    """Settings of a world: Amplify Whites."""

    amplification: FloatProperty(
        name="Amplify Whites",
        description="How much brighter white is taken to be in a world image that holds nothing"
        " brighter (8 bits a channel), as background and as light: 100 to 200 makes lamps out of"
        " its white spots, 0 changes nothing. What is brighter than white grows by as much as white"
        " does",
        default=0.0,
        min=0.0,
        max=10000.0,
        soft_max=200.0,
        step=100,
        precision=1,
        override=OVERRIDABLE,
        update=setting_changed,
    )


CLASSES = (
    AplanatCaptureSettings,
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
