"""Splatting highlights: a disc each, in the shape of the opening, added up (methods 13)."""

from ..device import shader_source, state
from ..device.shaders import ShaderInfo, compile_shader
from ..device.uniform_block import UniformStruct
from .highlights import COLUMNS
from .surface import VIEW_PARAMS

SPLAT_PARAMS = UniformStruct("shared/splat_params.glsl", "SplatParams")

_INFO = ShaderInfo(
    name="aplanat_splat",
    vertex=shader_source.load("passes/splat_vert.glsl"),
    fragment=shader_source.load("passes/splat_frag.glsl"),
    typedefs=VIEW_PARAMS.source + SPLAT_PARAMS.source,
    attributes=(("VEC2", "pos"),),
    varyings=(("VEC2", "v_place"), ("FLAT VEC3", "v_density"), ("FLAT FLOAT", "v_blur")),
    outputs=(("VEC4", "out_color"),),
    samplers=(
        ("FLOAT_2D", "sources_a_tx"),
        ("FLOAT_2D", "sources_b_tx"),
        ("FLOAT_2D_ARRAY", "opening_tx"),
    ),
    uniforms=(("ViewParams", "view_buf"), ("SplatParams", "splat_buf")),
    defines=(("SOURCE_COLUMNS", str(COLUMNS)),),
)


def splat(square, sources, count, opening, view_buffer, splat_buffer):
    """Add highlights to the bound frame buffer.

    Parameters
    ----------
    square : GPUBatch
        Two triangles over the unit square.
    sources : tuple of 2 GPUTexture
        See `passes.highlights`.
    count : int
        How many of them.
    opening : GPUTexture
        Array of `bokeh.opening.opening_layers`.
    view_buffer : GPUUniformBuf
        `ViewParams` of the frame.
    splat_buffer : GPUUniformBuf
        `SplatParams`.
    """
    if count == 0:
        return
    state.additive()
    shader = compile_shader(_INFO)
    shader.bind()
    for name, texture in zip(("sources_a_tx", "sources_b_tx"), sources, strict=True):
        shader.uniform_sampler(name, texture)
    shader.uniform_sampler("opening_tx", opening)
    shader.uniform_block("view_buf", view_buffer)
    shader.uniform_block("splat_buf", splat_buffer)
    square.draw_instanced(shader, instance_count=count)
