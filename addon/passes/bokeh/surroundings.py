"""Mean brightness around each place of the picture, from which automatic thresholds are taken.

For each of eight depths, a pyramid of means over squares of pixels, from two by two on, of what is
not in front, and from it the mean within the circle of confusion that the depth has; see
``gpu_shaders/lib/split/threshold_lib.glsl``. And the tiles in which reflecting surfaces are
searched.
"""

from ...device import shader_source
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader, dispatch
from ...device.targets import level_sizes
from ..surface.surface import HIGHLIGHT_PARAMS, VIEW_PARAMS

# Side of a tile in which reflecting surfaces are searched or not, px.
TILE = 16
# Of the pyramid, in an atlas (`device.targets.atlas_size`), and of what is found.
MEANS_FORMAT = SURROUNDINGS_FORMAT = "RGBA16F"

_DEPTHS = 8
_GROUP = 8


@variants(
    allowed=lambda level, clipped: level or not clipped,
    level=(False, True),
    clipped=(False, True),
)
def _info(level, clipped=False):
    samplers = ("color_tx", "depth_tx", *("before_tx",) * clipped) if level else ("means_tx",)
    if level:
        image = (MEANS_FORMAT, "FLOAT_2D", "means_img", ("READ", "WRITE"))
    else:
        image = (SURROUNDINGS_FORMAT, "FLOAT_2D", "surroundings_img", ("READ", "WRITE"))
    return ShaderInfo(
        name="aplanat_surroundings",
        compute=shader_source.load("passes/split/surroundings_comp.glsl"),
        typedefs=VIEW_PARAMS.source * level + HIGHLIGHT_PARAMS.source,
        samplers=tuple(("FLOAT_2D", name) for name in samplers),
        images=(image,),
        uniforms=(
            *(("ViewParams", "view_buf"),) * level,
            ("HighlightParams", "highlight_buf"),
        ),
        push_constants=(("INT", "depth"), ("IVEC2", "size"), *(("INT", "level"),) * level),
        defines=(("LEVEL", "1"),) * level + (("CLIPPED", "1"),) * clipped,
        local_size=(_GROUP, _GROUP, 1),
    )


_SPREAD = ShaderInfo(
    name="aplanat_candidates_spread",
    compute=shader_source.load("passes/split/candidates_spread_comp.glsl"),
    samplers=(("UINT_2D", "marks_tx"),),
    images=(("R32UI", "UINT_2D", "candidates_img", ("WRITE",)),),
    local_size=(_GROUP, _GROUP, 1),
)


def surroundings_size(width, height):
    """Return the size of the texture of a picture's surroundings: half of it, twice."""
    return 2 * (-(-width // 2)), -(-height // 2)


def find(picture, size, means, found, view, split, before=None):
    """Find the mean brightness around each place of a picture.

    Parameters
    ----------
    picture : tuple of 2 GPUTexture
        Colour, scene linear, and window depth of the picture as the lens' middle sees it, of half
        its size, rounded up.
    size : tuple of 2 int
        Of the picture, px.
    means : GPUTexture
        `MEANS_FORMAT`, of `device.targets.atlas_size`; gets the pyramid of the last depth.
    found : GPUTexture
        `SURROUNDINGS_FORMAT`, of `surroundings_size`.
    view, split : GPUUniformBuf
        `ViewParams` and `HighlightParams` of the frame.
    before : GPUTexture, optional
        What was found before: light above the threshold that follows from it counts as the
        threshold.
    """
    of_level, of_depth = (
        compile_shader(_info(True, before is not None)),
        compile_shader(_info(False)),
    )
    sizes = level_sizes(*size)
    for depth in reversed(range(_DEPTHS)):
        of_level.bind()
        of_level.uniform_sampler("color_tx", picture[0])
        of_level.uniform_sampler("depth_tx", picture[1])
        if before is not None:
            of_level.uniform_sampler("before_tx", before)
        of_level.uniform_block("view_buf", view)
        of_level.image("means_img", means)
        _set(of_level, split, size, depth)
        for level, texels in enumerate(sizes, 1):
            of_level.uniform_int("level", level)
            _dispatch(of_level, texels)
        of_depth.bind()
        of_depth.uniform_sampler("means_tx", means)
        of_depth.image("surroundings_img", found)
        _set(of_depth, split, size, depth)
        _dispatch(of_depth, sizes[0])


def spread(marks, candidates):
    """Copy marks of tiles, each also to its eight neighbours.

    Parameters
    ----------
    marks, candidates : GPUTexture
        R32UI, of the same size.
    """
    shader = compile_shader(_SPREAD)
    shader.bind()
    shader.uniform_sampler("marks_tx", marks)
    shader.image("candidates_img", candidates)
    _dispatch(shader, (marks.width, marks.height))


def _set(shader, split, size, depth):
    shader.uniform_block("highlight_buf", split)
    shader.uniform_int("size", size)
    shader.uniform_int("depth", depth)


def _dispatch(shader, texels):
    dispatch(shader, *(-(-side // _GROUP) for side in texels))
