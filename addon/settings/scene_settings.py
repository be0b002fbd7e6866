"""Settings of a scene and of its view layers: sampling, levels of detail, passes."""

from .setting import Item, Section, Setting

# Lens samples of a frame, also on the command line.
MAX_SAMPLES = 65536

# A table: what belongs to a setting stands together.
# fmt: off
SAMPLING = Section("Sampling", "Render Properties > Sampling", (
    Setting("method", "ADAPTIVE", "Method", "How the picture is put together from views through"
            " the lens", field="method", told="method", kept=True, items=(
            Item(0, "ADAPTIVE", "Adaptive", "Draw blurred objects with fewer triangles, share"
                 " drawings of what is in focus, and blur each lens sample over the part of the"
                 " lens it stands for"),
            Item(1, "REFERENCE", "Reference", "Draw everything in full detail for every lens"
                 " sample: exact, the slowest"),
            Item(2, "LAYERED", "Layered", "Draw the scene once for each depth layer, and cast the"
                 " rays of all lens samples through the layers: the time hardly depends on the"
                 " number of triangles"),
    )),
    Setting("use_target_error", True, "Noise Threshold", "Draw samples until the picture is as"
            " good as one number for quality asks, where they are needed; the error is measured"
            " while the picture is drawn", kept=True),
))

RENDER = Section("Samples of the final render", "Render Properties > Sampling > Render", (
    Setting("render_error", 0.01, "Render Noise Threshold", "Noise at which the final render stops"
            " drawing samples. Lower values reduce noise and take longer: 0.03 is a draft, 0.01"
            " looks clean, 0.002 is for large prints. The amount of blur stays the same",
            limits=(0.0005, 0.5), soft=(None, 0.05), step=0.1, precision=4, told="target_error",
            kept=True),
    Setting("render_max_samples", 4096, "Render Max Samples", "Lens samples at which the final"
            " render stops even if it is above its noise threshold", limits=(1, MAX_SAMPLES),
            field="most_samples", told="max_samples", kept=True),
    Setting("render_min_samples", 16, "Render Min Samples", "Lens samples that every part of the"
            " final render gets at least. More find small and rare things that few samples miss",
            limits=(1, MAX_SAMPLES), soft=(None, 4096), field="least_samples", told="min_samples",
            kept=True),
    Setting("render_samples", 256, "Render", "Places on the lens from which the final render sees"
            " the scene. More make blurred parts smoother; the amount of blur stays the same",
            limits=(1, MAX_SAMPLES), soft=(None, 4096), field="lens_samples", told="samples",
            kept=True),
    Setting("render_time_limit", 0.0, "Render Time Limit", "Seconds of drawing at which sampling"
            " stops, but not before Min Samples; 0 is no limit. With a limit, the noise depends"
            " on how fast and how busy the machine is", limits=(0.0, None), soft=(None, 3600.0),
            subtype="TIME_ABSOLUTE", told="time_limit_s"),
))

PREVIEW = Section("Samples of the viewport", "Render Properties > Sampling > Viewport", (
    Setting("preview_error", 0.03, "Viewport Noise Threshold", "Noise at which the viewport"
            " stops drawing samples. Lower values reduce noise and take longer",
            limits=(0.0005, 0.5), soft=(None, 0.1), step=0.1, precision=4, kept=True),
    Setting("preview_max_samples", 1024, "Viewport Max Samples", "Lens samples at which the"
            " viewport rests even if it is above its noise threshold", limits=(1, MAX_SAMPLES),
            field="most_samples", kept=True),
    Setting("preview_min_samples", 16, "Viewport Min Samples", "Lens samples that every part of"
            " the viewport gets at least", limits=(1, MAX_SAMPLES), soft=(None, 1024),
            field="least_samples", kept=True),
    Setting("preview_samples", 64, "Viewport", "Lens samples after which the viewport rests",
            limits=(1, MAX_SAMPLES), soft=(None, 1024), field="lens_samples", kept=True),
    Setting("preview_time_limit", 0.0, "Viewport Time Limit", "Seconds of drawing at which it"
            " rests, but not before Min Samples; 0 is no limit", limits=(0.0, None),
            soft=(None, 60.0), subtype="TIME_ABSOLUTE"),
    Setting("preview_frame_time", 0.0, "Viewport Frame Time", "Seconds that a picture may take"
            " while the view moves: where it takes longer, its pixels are drawn 2 or 4 times as"
            " large. At rest the picture is as fine as ever. 0 never draws larger pixels",
            limits=(0.0, None), soft=(None, 1.0), step=1, precision=3, subtype="TIME_ABSOLUTE"),
    Setting("show_preview_times", False, "Timings", "Tell in the 3D view how many times a second"
            " it is redrawn, and what the time goes into"),
))

ADVANCED = Section("Sampling of both", "Render Properties > Sampling > Advanced", (
    Setting("subsamples", 4, "Subsamples", "Places on the lens for which each lens sample is"
            " blurred besides its own. They cost less than samples, but see only what the sample"
            " sees", limits=(0, 64), soft=(None, 8), field="subsamples", told="subsamples",
            kept=True),
    Setting("use_sharing", True, "Share Drawings", "Draw what is nearly in focus once for all"
            " lens samples that put it at the same place of the raster", told="share_drawings",
            kept=True),
    Setting("sharing_cells", 2, "Cells", "Places along a pixel that are told apart when drawings"
            " are shared. More give smoother edges, fewer share more", limits=(1, 8),
            told="share_drawings", kept=True),
    Setting("layers", 8, "Layers", "Depth layers of the layered method. More keep more of what"
            " hides behind one another, and take more time and memory", limits=(1, 64),
            soft=(4, 16), field="layers", told="layers"),
    Setting("layer_source", "SLICES", "Layers From", "What a layer of the layered method is",
            field="layer_source", told="layer_source", items=(
        Item(0, "SLICES", "Slices", "What lies between two depths: layers in equal steps of blur"),
        Item(1, "PEELING", "Depth Peeling", "What lies behind the layer before: nothing that is"
             " among the first surfaces is lost, however near one another they are"),
    )),
    Setting("use_view_dependence", False, "View-Dependent Shading", "Draw the colours of each layer"
            " as they are seen from five places on the lens, so that reflections move as they do in"
            " a real picture; takes five times the time and memory for the layers",
            field="layers_from_eyes", told="view_dependent_layers"),
    Setting("seed", 0, "Seed", "Chooses another pattern of samples; the same seed gives the same"
            " picture", limits=(0, None), field="seed", told="seed"),
    Setting("pixel_filter", "BLACKMAN_HARRIS", "Pixel Filter", "How samples are gathered into a"
            " pixel", told="filter", kept=True, items=(
            Item(0, "BLACKMAN_HARRIS", "Blackman-Harris", "Smooth edges without ringing"),
            Item(1, "BOX", "Box", "Every place of the pixel counts the same"),
    )),
))

CAPTURE = Section("Capture of depth layers", "Render Properties > Depth Layers", (
    Setting("layers", 8, "Layers", "How many depth layers a captured frame has, besides"
            " the world's. More layers keep apart what lies behind one another, and take longer",
            limits=(1, 64), soft=(None, 16)),
    Setting("overscan", 0.1, "Overscan", "Share of the picture's width and height that a"
            " captured frame is larger on each side, so that blur finds what lies beyond the"
            " border", limits=(0.0, 1.0), soft=(None, 0.3), precision=2, subtype="FACTOR"),
    Setting("path", "//layers_####.exr", "Layers File", "Where Capture Depth Layers"
            " writes: an .exr file a frame, #### is its number", subtype="FILE_PATH"),
))

MEASURING = Section("Measuring", "Only in Python", (
    Setting("use_reference_bokeh", False, "Separate Highlights", "Draw the cameras' bokeh with"
            " the reference method, too. Without it, highlights are sampled as everything else",
            field="reference_bokeh"),
))

LEVELS = Section("Level of detail", "Render Properties > Level of Detail", (
    Setting("use_levels", True, "Level of Detail", "Draw blurred objects with fewer triangles;"
            " what is in focus keeps all of them", field="uses_levels", told="levels_of_detail"),
    Setting("level_bias", 0.0, "Bias", "Levels of detail by which objects are drawn finer (or"
            " coarser, if negative) than their blur asks for; each has twice the triangles",
            limits=(-16.0, 16.0), soft=(-4.0, 4.0), field="level_bias", told="level_bias"),
    Setting("least_triangles", 256, "Minimum Triangles", "No level of detail has fewer triangles",
            limits=(4, 10_000_000), soft=(None, 10000), field="least_triangles",
            told="least_triangles"),
))

LIGHT = Section("Light", "Render Properties > Light", (
    Setting("use_shadows", False, "Shadows", "Objects shadow one another. Each lens sample sees the"
            " scene from one place on one light, too, so that shadows become as soft as the lights"
            " are large while the blur becomes smooth. A frame takes several times as long",
            field="shadows", told="shadows"),
))

PERFORMANCE = Section("Performance", "Render Properties > Performance", (
    Setting("chunk_milliseconds", 50, "Chunk", "How long a final render may draw before it lets"
            " the window answer, in milliseconds. Longer renders a little faster; shorter keeps"
            " Blender more responsive", limits=(10, 2000), soft=(None, 500)),
))

FOCUS_OVERLAY = Section("Focus overlay", "3D View > Viewport Overlays > Focus", (
    Setting("show_coc", False, "Circle of Confusion", "Color what a 3D view shows by its blur:"
            " red in front of the focus, green in focus, blue behind it"),
    Setting("show_focus_planes", False, "Depth of Field", "Show the plane of the focus and the"
            " nearest and farthest planes that are acceptably sharp, with their distances. The"
            " plane of the focus can be dragged"),
    Setting("acceptable_blur", 2.0, "Acceptable Blur", "Diameter of the circle of confusion, in"
            " pixels of the picture, that still counts as in focus", limits=(0.01, 1000.0),
            soft=(0.25, 20.0), step=10, precision=2, subtype="PIXEL"),
))

PASSES = Section("Passes", "View Layer Properties > Passes > Data", (
    Setting("use_pass_coc", False, "Circle of Confusion", "Radius of the blur disk of the point"
            " in each pixel's centre, in pixels; negative in front of the focus plane",
            field="CoC"),
    Setting("use_pass_focus_matte", False, "Focus Matte", "Share of each pixel that is in focus,"
            " blurred like the picture: 1 up to a blur of 1/1500 of the picture's diagonal (at"
            " least a pixel), then falling to 0",
            field="Focus Matte"),
    Setting("use_pass_fringe", False, "Fringe", "What chromatic aberration adds and takes away:"
            " Combined less the same picture without it, which is rendered beside it",
            field="Fringe"),
    Setting("use_pass_defocus", False, "Defocus", "What the lens samples show: Combined without"
            " the highlights that were drawn one by one",
            field="Defocus"),
    Setting("use_pass_bokeh", False, "Bokeh", "The highlights that were drawn one by one. Defocus"
            " and Bokeh together are Combined",
            field="Bokeh"),
    Setting("use_pass_detail", False, "Detail", "Where the adaptive method saves work: level of"
            " detail (X), share of the lens samples that copy a drawing of the object (Y), and 1"
            " where there is an object (Z)",
            field="Detail"),
    Setting("use_pass_sample_count", False, "Sample Count", "Lens samples that each pixel got:"
            " with a noise threshold, more where the picture needs them",
            field="Sample Count"),
))
# fmt: on

SCENE = (
    *(SAMPLING, RENDER, PREVIEW, ADVANCED, LEVELS, LIGHT, PERFORMANCE, MEASURING),
    FOCUS_OVERLAY,
)
VIEW_LAYER = (PASSES,)
