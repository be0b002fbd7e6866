"""Settings of a camera's bokeh: which light is a highlight, and what its disc looks like."""

from .setting import Item, Section, Setting

# A table: what belongs to a setting stands together.
# fmt: off
LIGHT = Section("Which light", "Camera Properties > Bokeh", (
    Setting("use", True, "Bokeh", "Draw blurred highlights one by one, as discs in the shape of"
            " the opening, instead of as many dots as there are lens samples", told="bokeh"),
    Setting("threshold", 1.0, "Threshold", "Brightness above which light is a highlight; 1 is"
            " white. What lies below it stays in the rest of the picture", limits=(0.001, 1e6),
            soft=(None, 10.0), step=10, field="threshold", told="bokeh.threshold"),
    # Behind the threshold: who sets that chooses it, and a record of both is applied in this order.
    Setting("highlights", "AUTO", "Highlights", "Which light is a highlight", field="highlights",
            told="bokeh.highlights", items=(
            Item(0, "AUTO", "Automatic", "What the lens samples cannot draw: light brighter than"
                 " white that is several times brighter than its surroundings, as far as it is"
                 " blurred"),
            Item(1, "THRESHOLD", "Threshold", "Light above a brightness that is the same"
                 " everywhere"),
    )),
    Setting("gain", 1.0, "Gain", "Factor of the highlights' light; 1 is what the scene has",
            limits=(0.0, 1000.0), soft=(None, 4.0), step=10, field="gain", told="bokeh.gain"),
    Setting("model", "AUTO", "Sources", "What a disc is drawn for", field="model",
            told="bokeh.model",
            items=(
            Item(0, "AUTO", "Automatic", "Each pixel of a highlight. Beyond 10,000 of them faint"
                 " ones that lie close together are one, where that changes nothing that can be"
                 " seen"),
            Item(1, "POINT", "Points", "Each pixel of a highlight, however many there are: exact"),
            Item(2, "CLUSTERED", "Clusters", "Neighbouring pixels that are alike are one source:"
                 " faster where highlights are large or many"),
    )),
    Setting("cluster_levels", 4, "Levels", "How often neighbours are merged at most; each level"
            " doubles the side of the largest cluster", limits=(1, 8), field="cluster_levels",
            told="bokeh.cluster_levels"),
    Setting("similarity", 1.0, "Similarity", "How far apart in the scene merged pixels may be: 1"
            " is chosen from the scene's size, more merges more", limits=(0.0, 100.0),
            soft=(None, 4.0), step=10, field="similarity", told="bokeh.similarity"),
    Setting("use_global_merge", False, "Merge All", "Merge clusters that are alike wherever they"
            " lie in the picture, so that they keep together while the camera moves. Up to 8192"
            " clusters are compared with one another; where more are left, neighbours are merged"
            " instead, and the report says so", field="global_merge", told="bokeh.global_merge"),
))

SEARCH = Section("Search and visibility", "Camera Properties > Bokeh > Search and Visibility", (
    Setting("visibility", "AUTO", "Visibility", "How it is found which part of the lens sees a"
            " highlight", field="visibility", told="bokeh.visibility", items=(
            Item(0, "AUTO", "Automatic", "What is likely to be faster in this frame"),
            Item(1, "RASTER", "Projected", "Draw the objects between highlight and lens as the"
                 " highlight sees them: exact"),
            Item(2, "WARP", "Warped", "Cast rays from the highlight through layers of the"
                 " picture; does not depend on the number of triangles"),
            Item(3, "SPLAT", "Per Pixel", "Cast the rays while a disc is drawn, one a pixel, nine"
                 " where it stands for merged highlights; for very many highlights"),
    )),
    Setting("layers", 4, "Layers", "How many highlights behind one another are found in a pixel",
            limits=(1, 8), field="layers", told="bokeh.layers"),
    Setting("lens_views", 4, "Lens Views", "Places on the lens from which mirroring surfaces are"
            " searched: 1, 4, 9 or 16. More keep apart what they show to different parts of the"
            " lens", limits=(1, 16), field="lens_views", told="bokeh.lens_views"),
    Setting("overscan", 0.25, "Overscan", "How far outside the picture highlights are searched at"
            " most, as a share of its longer side. Only as far as their discs reach into the"
            " picture; light from farther out is sampled as everything else", limits=(0.0, 2.0),
            soft=(None, 1.0), subtype="FACTOR", field="overscan", told="bokeh.overscan"),
    Setting("use_world", True, "World", "Find highlights in the world's image, too", field="world",
            told="bokeh.world"),
))

APPEARANCE = Section("Appearance", "Camera Properties > Bokeh > Appearance", (
    Setting("hardness", 0.0, "Hardness", "Spherical aberration of a thin lens, behind the focus:"
            " -1 creamy, with a soft edge and a bright middle; 0 even; 1 a soap bubble with a"
            " bright edge. In front of the focus it is the other way round", limits=(-1.0, 1.0),
            subtype="FACTOR", told="bokeh.hardness", kept=True),
    Setting("profile_strength", 1.0, "Lens Profile", "How much of the real lens' own distribution"
            " of light a disc shows: 1 as it is traced, 0 an even disc", limits=(0.0, 1.0),
            subtype="FACTOR", field="profile_strength", told="bokeh.profile_strength", kept=True),
))

IRIS = Section("Iris", "Camera Properties > Lens > Iris", (
    Setting("blade_curvature", 0.0, "Blade Curvature", "How round the iris' blades are: 0"
            " straight, 1 a circle", limits=(0.0, 1.0), subtype="FACTOR",
            told="blade_curvature", kept=True),
    Setting("use_round_stop", True, "Round Wide Open", "With a real lens: its blades lie behind a"
            " round stop, so that the opening is round at the lens' widest f-number and shows"
            " blades as it is stopped down. Off: the same blades at every f-number, as with a thin"
            " lens", told="round_wide_open", kept=True),
    Setting("iris_image", None, "Iris Image", "Picture of the opening, white where light passes;"
            " its longer side is the opening's diameter. It takes the place of the blades",
            told="iris_image"),
))

FIELD = Section("Vignetting", "Camera Properties > Bokeh > Appearance > Vignetting", (
    Setting("vignetting", "LENS", "Vignetting", "Whether discs towards the picture's corners are"
            " cut to cat's eyes", told="bokeh.vignetting", kept=True, items=(
            Item(0, "NONE", "None", "All discs are whole"),
            Item(1, "ANALYTIC", "Cat's Eyes", "Cut by two rims, in front of and behind the iris"),
            Item(2, "LENS", "Real Lens", "Cut as the real lens cuts them; a thin lens does not"),
    )),
    Setting("vignetting_strength", 0.3, "Strength", "How far the rims move until the corner of"
            " the picture, in radii of the opening: 0.5 leaves a narrow eye there, 1 nothing",
            limits=(0.0, 1.0), subtype="FACTOR", kept=True),
    Setting("vignetting_softness", 0.0, "Softness", "How soft the cut edges are, as in a lens"
            " where many rims take their share", limits=(0.0, 1.0), subtype="FACTOR", kept=True),
))

TEXTURE = Section("Grain and dust", "Camera Properties > Bokeh > Appearance > Grain and Dust", (
    Setting("grain", 0.0, "Grain", "How strongly the brightness varies over a disc",
            limits=(0.0, 1.0), subtype="FACTOR", told="bokeh.grain", kept=True),
    Setting("grain_size", 0.05, "Size", "Of the grains, in radii of the disc", limits=(0.005, 1.0),
            soft=(None, 0.3), step=1, precision=3, kept=True),
    Setting("dust", 0, "Dust", "Number of dark spots in a disc", limits=(0, 1000), soft=(None, 100),
            told="bokeh.dust", kept=True),
    Setting("dust_size", 0.06, "Size", "Of the largest spot, in radii of the disc; the smallest"
            " has a third", limits=(0.001, 1.0), soft=(None, 0.3), step=1, precision=3, kept=True),
    Setting("dust_depth", 0.5, "Depth", "Share of the light that the middle of a spot takes away",
            limits=(0.0, 1.0), subtype="FACTOR", kept=True),
    Setting("texture_seed", 0, "Seed", "Chooses another pattern of grain, dust and onion rings",
            limits=(0, None), kept=True),
))

RINGS = Section("Rings", "Camera Properties > Bokeh > Appearance > Rings", (
    Setting("diffraction", 0.0, "Diffraction", "How much of the ringing along the edge is shown"
            " that the wave nature of light makes: 1 as it is. The smaller the opening, the wider"
            " it is", limits=(0.0, 1.0), subtype="FACTOR", told="bokeh.diffraction", kept=True),
    Setting("onion", 0.0, "Onion Rings", "Contrast of the rings that turned aspheric surfaces"
            " leave in a disc; moulded lenses have 0.05 to 0.15", limits=(0.0, 1.0),
            subtype="FACTOR", told="bokeh.onion", kept=True),
    Setting("onion_pitch", 0.045, "Distance", "From ring to ring, in radii of the disc",
            limits=(0.005, 1.0), soft=(None, 0.2), step=1, precision=3, kept=True),
    Setting("onion_irregularity", 0.5, "Irregularity", "How much the rings differ in depth and"
            " place", limits=(0.0, 1.0), subtype="FACTOR", kept=True),
))

DEBUG = Section("Debug view", "Camera Properties > Bokeh > Debug View", (
    Setting("debug_view", "NONE", "Show", "Show marks of what the bokeh is made of on the dimmed"
            " picture, in the viewport and in Combined; the other passes stay as they are",
            field="debug_view", told="bokeh.debug_view", items=(
            Item(0, "NONE", "Picture", "The picture as it is"),
            Item(1, "SOURCES", "Sources", "A dot in its own colour for every highlight that was"
                 " found, before merging"),
            Item(2, "CLUSTERS", "Clusters", "What is left after merging: the square of pixels"
                 " that each stands for, and the edge of its disc"),
            Item(3, "VISIBILITY", "Visibility", "What became of each source, by colour, and the"
                 " edge of its disc"),
    )),
))
# fmt: on

BOKEH = (LIGHT, SEARCH, APPEARANCE, IRIS, FIELD, TEXTURE, RINGS, DEBUG)
