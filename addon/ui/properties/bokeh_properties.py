"""Bokeh settings of a camera."""

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
)

from .overrides import OVERRIDABLE, setting_changed

# What every property here has in common.
_SHARED = {"override": OVERRIDABLE, "update": setting_changed}


class AplanatBokehSettings(bpy.types.PropertyGroup):
    """Bokeh settings of a camera."""

    use: BoolProperty(
        name="Bokeh",
        description="Draw blurred highlights one by one, as discs in the shape of the opening,"
        " instead of as many dots as there are lens samples",
        default=True,
        **_SHARED,
    )
    threshold: FloatProperty(
        name="Threshold",
        description="Brightness above which light is a highlight; 1 is white. What lies below it"
        " stays in the rest of the picture",
        default=1.0,
        min=0.001,
        max=1e6,
        soft_max=10.0,
        step=10,
        **_SHARED,
    )
    gain: FloatProperty(
        name="Gain",
        description="Factor of the highlights' light; 1 is what the scene has",
        default=1.0,
        min=0.0,
        max=1000.0,
        soft_max=4.0,
        step=10,
        **_SHARED,
    )
    model: EnumProperty(
        name="Sources",
        description="What a disc is drawn for",
        items=(
            (
                "AUTO",
                "Automatic",
                "Each pixel of a highlight. Beyond 10,000 of them faint ones that lie close"
                " together are one, where that changes nothing that can be seen",
            ),
            ("POINT", "Points", "Each pixel of a highlight, however many there are: exact"),
            (
                "CLUSTERED",
                "Clusters",
                "Neighbouring pixels that are alike are one source: faster where highlights are"
                " large or many",
            ),
        ),
        default="AUTO",
        **_SHARED,
    )
    cluster_levels: IntProperty(
        name="Levels",
        description="How often neighbours are merged at most; each level doubles the side of the"
        " largest cluster",
        default=4,
        min=1,
        max=8,
        **_SHARED,
    )
    similarity: FloatProperty(
        name="Similarity",
        description="How far apart in the scene merged pixels may be: 1 is chosen from the scene's"
        " size, more merges more",
        default=1.0,
        min=0.0,
        max=100.0,
        soft_max=4.0,
        step=10,
        **_SHARED,
    )
    use_global_merge: BoolProperty(
        name="Merge All",
        description="Merge clusters that are alike wherever they lie in the picture, so that they"
        " keep together while the camera moves. Up to 8192 clusters are compared with one another;"
        " where more are left, neighbours are merged instead, and the report says so",
        default=False,
        **_SHARED,
    )
    visibility: EnumProperty(
        name="Visibility",
        description="How it is found which part of the lens sees a highlight",
        items=(
            ("AUTO", "Automatic", "What is likely to be faster in this frame"),
            (
                "RASTER",
                "Projected",
                "Draw the objects between highlight and lens as the highlight sees them: exact",
            ),
            (
                "WARP",
                "Warped",
                "Cast rays from the highlight through layers of the picture; does not depend on the"
                " number of triangles",
            ),
            (
                "SPLAT",
                "Per Pixel",
                "Cast the rays while a disc is drawn, one a pixel, nine where it stands for merged"
                " highlights; for very many highlights",
            ),
        ),
        default="AUTO",
        **_SHARED,
    )
    layers: IntProperty(
        name="Layers",
        description="How many highlights behind one another are found in a pixel",
        default=4,
        min=1,
        max=8,
        **_SHARED,
    )
    overscan: FloatProperty(
        name="Overscan",
        description="How far outside the picture highlights are searched at most, as a share of its"
        " longer side. Only as far as their discs reach into the picture",
        default=0.25,
        min=0.0,
        max=2.0,
        soft_max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    lens_views: IntProperty(
        name="Lens Views",
        description="Places on the lens from which mirroring surfaces are searched: 1, 4, 9 or 16."
        " More keep apart what they show to different parts of the lens",
        default=4,
        min=1,
        max=16,
        **_SHARED,
    )
    use_world: BoolProperty(
        name="World",
        description="Find highlights in the world's image, too",
        default=True,
        **_SHARED,
    )
    hardness: FloatProperty(
        name="Hardness",
        description="Spherical aberration of a thin lens, behind the focus: -1 creamy, with a soft"
        " edge and a bright middle; 0 even; 1 a soap bubble with a bright edge. In front of the"
        " focus it is the other way round",
        default=0.0,
        min=-1.0,
        max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    profile_strength: FloatProperty(
        name="Lens Profile",
        description="How much of the real lens' own distribution of light a disc shows: 1 as it is"
        " traced, 0 an even disc",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    iris_image: PointerProperty(
        name="Iris Image",
        description="Picture of the opening, white where light passes; its longer side is the"
        " opening's diameter. It takes the place of the blades",
        type=bpy.types.Image,
        **_SHARED,
    )
    blade_curvature: FloatProperty(
        name="Blade Curvature",
        description="How round the iris' blades are: 0 straight, 1 a circle",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    vignetting: EnumProperty(
        name="Vignetting",
        description="Whether discs towards the picture's corners are cut to cat's eyes",
        items=(
            ("NONE", "None", "All discs are whole"),
            ("ANALYTIC", "Cat's Eyes", "Cut by two rims, in front of and behind the iris"),
            ("LENS", "Real Lens", "Cut as the real lens cuts them; a thin lens does not"),
        ),
        default="LENS",
        **_SHARED,
    )
    vignetting_strength: FloatProperty(
        name="Strength",
        description="How far the rims move until the corner of the picture, in radii of the"
        " opening: 0.5 leaves a narrow eye there, 1 nothing",
        default=0.3,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    vignetting_softness: FloatProperty(
        name="Softness",
        description="How soft the cut edges are, as in a lens where many rims take their share",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    distortion_source: EnumProperty(
        name="Distortion",
        description="How the lens bends straight lines: of the whole picture, in all its passes,"
        " with and without depth of field, as long as Bokeh is switched on",
        items=(
            ("NONE", "None", "Straight lines stay straight"),
            ("DIVISION", "Division Model", "By one number"),
            ("LENS", "Real Lens", "That number, fitted to the real lens"),
        ),
        default="NONE",
        **_SHARED,
    )
    distortion: FloatProperty(
        name="K",
        description="Coefficient of the division model, for distances as shares of that from the"
        " middle of the picture to its corner: negative is a barrel, which shows more of the scene"
        " than the frame holds, positive a pincushion",
        default=-0.1,
        min=-0.5,
        max=0.25,
        step=1,
        precision=3,
        **_SHARED,
    )
    grain: FloatProperty(
        name="Grain",
        description="How strongly the brightness varies over a disc",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    grain_size: FloatProperty(
        name="Size",
        description="Of the grains, in radii of the disc",
        default=0.05,
        min=0.005,
        max=1.0,
        soft_max=0.3,
        step=1,
        precision=3,
        **_SHARED,
    )
    dust: IntProperty(
        name="Dust",
        description="Number of dark spots in a disc",
        default=0,
        min=0,
        max=1000,
        soft_max=100,
        **_SHARED,
    )
    dust_size: FloatProperty(
        name="Size",
        description="Of the largest spot, in radii of the disc; the smallest has a third",
        default=0.06,
        min=0.001,
        max=1.0,
        soft_max=0.3,
        step=1,
        precision=3,
        **_SHARED,
    )
    dust_depth: FloatProperty(
        name="Depth",
        description="Share of the light that the middle of a spot takes away",
        default=0.5,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    texture_seed: IntProperty(
        name="Seed",
        description="Chooses another pattern of grain, dust and onion rings",
        default=0,
        min=0,
        **_SHARED,
    )
    diffraction: FloatProperty(
        name="Diffraction",
        description="How much of the ringing along the edge is shown that the wave nature of light"
        " makes: 1 as it is. The smaller the opening, the wider it is",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    onion: FloatProperty(
        name="Onion Rings",
        description="Contrast of the rings that turned aspheric surfaces leave in a disc; moulded"
        " lenses have 0.05 to 0.15",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    onion_pitch: FloatProperty(
        name="Distance",
        description="From ring to ring, in radii of the disc",
        default=0.045,
        min=0.005,
        max=1.0,
        soft_max=0.2,
        step=1,
        precision=3,
        **_SHARED,
    )
    onion_irregularity: FloatProperty(
        name="Irregularity",
        description="How much the rings differ in depth and place",
        default=0.5,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        **_SHARED,
    )
    debug_view: EnumProperty(
        name="Show",
        description="Show marks of what the bokeh is made of on the dimmed picture, in the viewport"
        " and in Combined; the other passes stay as they are",
        items=(
            ("NONE", "Picture", "The picture as it is"),
            (
                "SOURCES",
                "Sources",
                "A dot in its own colour for every highlight that was found, before merging",
            ),
            (
                "CLUSTERS",
                "Clusters",
                "What is left after merging: the square of pixels that each stands for, and the"
                " edge of its disc",
            ),
            (
                "VISIBILITY",
                "Visibility",
                "What became of each source, by colour, and the edge of its disc",
            ),
        ),
        default="NONE",
        **_SHARED,
    )


# What a disc looks like: this a preset and a lens keep. An image cannot be kept as a value.
APPEARANCE_NAMES = (
    *("hardness", "profile_strength", "blade_curvature"),
    *("vignetting", "vignetting_strength", "vignetting_softness"),
    *("distortion_source", "distortion"),
    *("grain", "grain_size", "dust", "dust_size", "dust_depth", "texture_seed"),
    *("diffraction", "onion", "onion_pitch", "onion_irregularity"),
)
