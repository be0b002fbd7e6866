"""The debug view of highlights: a mark for each on the dimmed picture (methods 10).

Dots and outlines have a fixed size in pixels, whatever the disc's; a ring shows the edge of the
disc. Marks are blended one over the other in the order of the list, with edges a pixel wide.
"""

from dataclasses import dataclass

from ...device import shader_source, state
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader
from ...device.uniform_block import UniformStruct
from ..surface.surface import VIEW_PARAMS
from ..visibility.culling import VISIBILITY_PARAMS
from .highlights import COLUMNS

MARK_PARAMS = UniformStruct("shared/mark_params.glsl", "MarkParams")

# Fates of highlights (culled, masked, splatted, ...), by their numbers in lib/bokeh/mark_lib.glsl.
FATES = ("SHARP", "OUTSIDE", "HIDDEN", "VISIBLE", "FREE", "MASKED", "IN_SPLAT")
# Straight pieces of a ring: their corners are a third of a pixel off where it is 300 px wide.
_RING_PIECES = 64


@dataclass(frozen=True)
class Marks:
    """Shape and colour of the marks.

    Parameters
    ----------
    shape : {'DOT', 'OUTLINE', 'RING'}
        A dot, the square of pixels that a source stands for, or its disc's edge.
    color : {'OWN', 'FATES', 'SHARP'}
        The source's own colour, or that of its fate; `SHARP` marks only sources whose circle of
        confusion is too small to be splatted.
    """

    shape: str
    color: str

    @property
    def defines(self):
        """Names of the shader's variants."""
        return tuple(name for name in (self.shape, self.color) if name not in {"DOT", "OWN"})


@variants(
    marks=(
        Marks(shape, color)
        for shape in ("DOT", "OUTLINE", "RING")
        for color in ("OWN", "FATES", "SHARP")
    )
)
def _info(marks):
    samplers = [("FLOAT_2D", "sources_a_tx")]
    if marks.color == "OWN":
        samplers.append(("FLOAT_2D", "sources_b_tx"))
    if marks.color == "FATES":
        samplers += [("FLOAT_2D", "tiles_tx"), ("FLOAT_2D", "states_tx")]
    return ShaderInfo(
        name="aplanat_bokeh_marks",
        vertex=shader_source.load("passes/bokeh/bokeh_marks_vert.glsl"),
        fragment=shader_source.load("passes/bokeh/bokeh_marks_frag.glsl"),
        # The library of sources names the last one.
        typedefs=VIEW_PARAMS.source + MARK_PARAMS.source + VISIBILITY_PARAMS.source,
        attributes=(("VEC2", "pos"),),
        varyings=(("VEC2", "v_offset"), ("FLAT FLOAT", "v_size"), ("FLAT VEC3", "v_color")),
        outputs=(("VEC4", "out_color"),),
        samplers=tuple(samplers),
        uniforms=(("ViewParams", "view_buf"), ("MarkParams", "mark_buf")),
        push_constants=(("INT", "stride"),),
        defines=(
            ("SOURCE_COLUMNS", str(COLUMNS)),
            ("RING_PIECES", str(_RING_PIECES)),
            *((name, "1") for name in marks.defines),
        ),
    )


def draw_marks(square, marks, count, textures, view_buffer, parameters, stride=1):
    """Lay marks over the bound frame buffer.

    Parameters
    ----------
    square : GPUBatch
        Two triangles over the unit square.
    marks : Marks
    count : int
        How many highlights.
    textures : dict of str to GPUTexture
        ``sources_a_tx`` and, by the marks' colour, ``sources_b_tx`` (see
        `passes.bokeh.highlights`), or ``tiles_tx`` and ``states_tx`` (see
        `engine.visibility.stage.Visibility`); more are ignored.
    view_buffer : GPUUniformBuf
        `ViewParams` of the frame.
    parameters : GPUUniformBuf
        `MarkParams`.
    stride : int
        1 marks every highlight, 2 every second one, and so on.
    """
    number = -(-count // stride)
    if number == 0:
        return
    state.over()
    info = _info(marks)
    shader = compile_shader(info)
    shader.bind()
    for _, name in info.samplers:
        shader.uniform_sampler(name, textures[name])
    shader.uniform_block("view_buf", view_buffer)
    shader.uniform_block("mark_buf", parameters)
    shader.uniform_int("stride", stride)
    pieces = _RING_PIECES if marks.shape == "RING" else 1
    shader.draw_instanced(square, number * pieces)


@variants()
def _picture_info():
    return ShaderInfo(
        name="aplanat_marked_picture",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/bokeh/marked_picture_frag.glsl"),
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),),
        samplers=(("FLOAT_2D", "picture_tx"), ("FLOAT_2D", "marks_tx")),
        push_constants=(("IVEC2", "origin"), ("INT", "pixel_size")),
    )


def draw_picture(fullscreen, picture, marks, origin=(0, 0), pixel_size=1):
    """Draw a picture, dimmed, with marks into the bound frame buffer.

    Parameters
    ----------
    fullscreen : GPUBatch
    picture, marks : GPUTexture
        Premultiplied.
    origin : tuple of 2 int
        Where the picture's lower left pixel goes, in pixels of the frame buffer.
    pixel_size : int
        Side of the square of the frame buffer that shows one pixel of the picture.
    """
    state.overwrite()
    shader = compile_shader(_picture_info())
    shader.bind()
    shader.uniform_sampler("picture_tx", picture)
    shader.uniform_sampler("marks_tx", marks)
    shader.uniform_int("origin", origin)
    shader.uniform_int("pixel_size", pixel_size)
    shader.draw(fullscreen)
