"""Splatting highlights: a disc each, in the shape of the opening, added up (methods 13)."""

from ..device import shader_source, state
from ..device.shaders import ShaderInfo, compile_shader
from ..device.uniform_block import UniformStruct
from .bokeh_culling import VISIBILITY_PARAMS
from .highlights import COLUMNS
from .surface import VIEW_PARAMS

SPLAT_PARAMS = UniformStruct("shared/splat_params.glsl", "SplatParams")

_TEXTURES = ("sources_a_tx", "sources_b_tx", "tiles_tx", "masks_tx")
_RAYS = ("layers_tx", "opacity_tx", "states_tx")


def _info(casts):
    names = _TEXTURES + _RAYS * casts
    samplers = tuple(("FLOAT_2D", name) for name in names) + (("FLOAT_2D_ARRAY", "opening_tx"),)
    uniforms = (("ViewParams", "view_buf"), ("SplatParams", "splat_buf"))
    uniforms += (("VisibilityParams", "visibility_buf"),) * casts
    structs = VIEW_PARAMS.source + SPLAT_PARAMS.source
    return ShaderInfo(
        name="aplanat_splat",
        vertex=shader_source.load("passes/splat_vert.glsl"),
        fragment=shader_source.load("passes/splat_frag.glsl"),
        typedefs=structs + VISIBILITY_PARAMS.source * casts,
        attributes=(("VEC2", "pos"),),
        varyings=(
            ("VEC2", "v_place"),
            ("FLAT VEC3", "v_density"),
            ("FLAT FLOAT", "v_blur"),
            ("FLAT VEC4", "v_tile"),
            ("FLAT INT", "v_source"),
            ("FLAT FLOAT", "v_region"),
        ),
        outputs=(("VEC4", "out_color"),),
        samplers=samplers,
        uniforms=uniforms,
        defines=(("SOURCE_COLUMNS", str(COLUMNS)), *(("IN_SPLAT", "1"),) * casts),
    )


def splat(square, count, textures, opening, view_buffer, splat_buffer, rays=None):
    """Add highlights to the bound frame buffer.

    Parameters
    ----------
    square : GPUBatch
        Two triangles over the unit square.
    count : int
        How many highlights.
    textures : sequence of 4 GPUTexture
        The list of highlights (see `passes.highlights`), what becomes of each, and the atlas of
        masks (see `engine.bokeh_visibility`).
    opening : GPUTexture
        Array of `bokeh.opening.opening_layers`.
    view_buffer : GPUUniformBuf
        `ViewParams` of the frame.
    splat_buffer : GPUUniformBuf
        `SplatParams`.
    rays : tuple or None
        What sources without a mask cast rays through: layers, opacity and states (GPUTexture),
        and `VisibilityParams` (GPUUniformBuf).
    """
    if count == 0:
        return
    state.additive()
    shader = compile_shader(_info(rays is not None))
    shader.bind()
    for name, texture in zip(_TEXTURES, textures, strict=True):
        shader.uniform_sampler(name, texture)
    if rays is not None:
        for name, texture in zip(_RAYS, rays[:3], strict=True):
            shader.uniform_sampler(name, texture)
        shader.uniform_block("visibility_buf", rays[3])
    shader.uniform_sampler("opening_tx", opening)
    shader.uniform_block("view_buf", view_buffer)
    shader.uniform_block("splat_buf", splat_buffer)
    square.draw_instanced(shader, instance_count=count)
