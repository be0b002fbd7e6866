"""Visibility masks by warping: rays from highlights to the lens through peeled layers (methods 11).

No geometry is drawn: the rays move straight through the raster of the depth-peeled layers. An
occluder behind four other surfaces, or outside the raster, is missed.

References
----------
Jeong et al., TVCG 2020, section 4.4; Lee, Eisemann and Seidel, SIGGRAPH 2010.
"""

from ...device import shader_source, state
from ...device.shaders import ShaderInfo, compile_shader, dispatch
from .culling import TILE_LAYOUT, VISIBILITY_PARAMS
from .prefix_sums import COLUMNS

# Most layers: as many as a texel has channels.
MOST_LAYERS = 4

_GROUP = 8

_PACK = ShaderInfo(
    name="aplanat_visibility_pack",
    compute=shader_source.load("passes/visibility/visibility_pack_comp.glsl"),
    samplers=(("FLOAT_2D", "depth_tx"), ("FLOAT_2D", "color_tx")),
    images=(
        ("RGBA32F", "FLOAT_2D", "layers_img", ("READ", "WRITE")),
        ("RGBA8", "FLOAT_2D", "opacity_img", ("READ", "WRITE")),
    ),
    push_constants=(("INT", "channel"),),
    local_size=(_GROUP, _GROUP, 1),
)

_WARP = ShaderInfo(
    name="aplanat_visibility_warp",
    vertex=shader_source.load("passes/visibility/visibility_warp_vert.glsl"),
    fragment=shader_source.load("passes/visibility/visibility_warp_frag.glsl"),
    typedefs=VISIBILITY_PARAMS.source + TILE_LAYOUT.source,
    attributes=(("VEC2", "pos"),),
    varyings=(("VEC2", "v_lens"), ("FLAT INT", "v_source")),
    outputs=(("FLOAT", "out_mask"),),
    samplers=tuple(
        ("FLOAT_2D", f"{name}_tx")
        for name in ("sources", "masked", "tiles", "states", "layers", "opacity")
    ),
    uniforms=(("VisibilityParams", "visibility_buf"), ("TileLayout", "layout_buf")),
    defines=(("SOURCE_COLUMNS", str(COLUMNS)),),
)


def pack(color, depth, channel, layers, opacity):
    """Write a layer into one channel of two textures; the first layer clears the other channels.

    Parameters
    ----------
    color, depth : GPUTexture
        Of the layer; the colour's alpha is its opacity.
    channel : int
        Less than MOST_LAYERS.
    layers, opacity : GPUTexture
        RGBA32F and RGBA8, of the same size.
    """
    shader = compile_shader(_PACK)
    shader.bind()
    shader.image("layers_img", layers)
    shader.image("opacity_img", opacity)
    shader.uniform_sampler("depth_tx", depth)
    shader.uniform_sampler("color_tx", color)
    shader.uniform_int("channel", channel)
    dispatch(shader, -(-layers.width // _GROUP), -(-layers.height // _GROUP))


def draw_masks(square, count, tables, parameters, layout):
    """Draw masks into the bound frame buffer of the atlas.

    Parameters
    ----------
    square : GPUBatch
        Two triangles over the unit square.
    count : int
        Sources that have a mask.
    tables : dict of str to GPUTexture
        ``sources``, ``masked``, ``tiles``, ``states``, ``layers``, ``opacity``.
    parameters : GPUUniformBuf
        `VisibilityParams`.
    layout : GPUUniformBuf
        `TileLayout`.
    """
    state.overwrite()
    shader = compile_shader(_WARP)
    shader.bind()
    for name, texture in tables.items():
        shader.uniform_sampler(f"{name}_tx", texture)
    shader.uniform_block("visibility_buf", parameters)
    shader.uniform_block("layout_buf", layout)
    shader.draw_instanced(square, count)
