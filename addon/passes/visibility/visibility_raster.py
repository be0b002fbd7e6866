"""Visibility masks by rasterising the scene from each highlight onto the lens (methods 11).

Seen from a highlight, a point of the scene hides one place on the lens, so a projection from the
highlight onto the lens makes its mask, without gaps and without noise. All masks are drawn at once
into an atlas, and of the scene only the clusters of triangles that meet a highlight's cone. Opaque
triangles clear the mask and transparent surfaces multiply it by their transmittance: neither needs
an order.

References
----------
Jeong et al., TVCG 2020, section 4.2.
"""

from ...device import shader_source, state
from ...device.shaders import ShaderInfo, compile_shader
from ..surface import surface_target
from .cones import CLUSTER_CORNERS, CLUSTER_DEFINES
from .culling import TILE_LAYOUT, VISIBILITY_PARAMS
from .prefix_sums import COLUMNS

_CLIP_DISTANCES = 6
# Pairs of source and cluster a GPU instance: instances of few vertices leave devices idle.
_PAIRS_A_DRAW = 256
BATCH_CORNERS = _PAIRS_A_DRAW * CLUSTER_CORNERS
_DEFINES = (("SOURCE_COLUMNS", str(COLUMNS)),)
_STRUCTS = VISIBILITY_PARAMS.source + TILE_LAYOUT.source
_UNIFORMS = (("VisibilityParams", "visibility_buf"), ("TileLayout", "layout_buf"))

_RASTER = ShaderInfo(
    name="aplanat_visibility_raster",
    vertex=shader_source.load("passes/visibility/visibility_raster_vert.glsl"),
    fragment=shader_source.load("passes/visibility/visibility_raster_frag.glsl"),
    typedefs=_STRUCTS,
    attributes=(("FLOAT", "corner"),),
    varyings=(("FLAT VEC3", "v_tile"),),
    outputs=(("FLOAT", "out_mask"),),
    samplers=tuple(
        ("FLOAT_2D", f"{name}_tx") for name in ("pairs", "sources", "tiles", "instances", "corners")
    ),
    uniforms=_UNIFORMS,
    push_constants=(("INT", "count"),),
    defines=(
        *_DEFINES,
        *CLUSTER_DEFINES,
        ("PAIRS_A_DRAW", str(_PAIRS_A_DRAW)),
    ),
)

# Transparent surfaces, drawn with their materials.
TARGET = surface_target.SurfaceTarget(
    "passes/visibility/visibility_surface_frag.glsl",
    (("VEC4", "out_mask"),),
    varyings=(("FLAT VEC3", "v_tile"),),
    structs=f"#define SOURCE_COLUMNS {COLUMNS}\n{_STRUCTS}",
    uniforms=_UNIFORMS,
    samplers=tuple(("FLOAT_2D", f"{name}_tx") for name in ("pairs", "sources", "tiles")),
    shades=False,
    seen=False,
    vertex="passes/visibility/visibility_surface_vert.glsl",
)


def draw_clusters(batch, count, tables, parameters, layout):
    """Draw pairs of source and cluster into the bound frame buffer of the atlas.

    Parameters
    ----------
    batch : GPUBatch
        Of `device.geometry.numbered_batch`, with BATCH_CORNERS corners.
    count : int
        Pairs.
    tables : dict of str to GPUTexture
        ``pairs``, ``sources``, ``tiles``, ``instances``, ``corners``.
    parameters, layout : GPUUniformBuf
        `VisibilityParams`, `TileLayout`.
    """
    shader = compile_shader(_RASTER)
    with state.clipped(_CLIP_DISTANCES):
        state.overwrite()
        shader.bind()
        for name, texture in tables.items():
            shader.uniform_sampler(f"{name}_tx", texture)
        shader.uniform_block("visibility_buf", parameters)
        shader.uniform_block("layout_buf", layout)
        shader.uniform_int("count", count)
        shader.draw_instanced(batch, -(-count // _PAIRS_A_DRAW))


def draw_surfaces(draws, count, tables, parameters, layout):
    """Draw pairs of source and instance of a transparent surface.

    Parameters
    ----------
    draws : sequence of passes.surface.surface.Draw
        Of the instances' group, made for `TARGET`.
    count : int
        Pairs.
    tables : dict of str to GPUTexture
        ``pairs``, ``sources``, ``tiles``, ``instances``.
    parameters, layout : GPUUniformBuf
    """
    with state.clipped(_CLIP_DISTANCES):
        state.multiply()
        for draw in draws:
            shader = draw.shader
            shader.bind()
            for name, texture in (*((f"{n}_tx", t) for n, t in tables.items()), *draw.textures):
                shader.uniform_sampler(name, texture)
            shader.uniform_block("visibility_buf", parameters)
            shader.uniform_block("layout_buf", layout)
            shader.uniform_block("material_buf", draw.constants)
            shader.uniform_int("instance_base", 0)
            shader.draw_instanced(draw.batch, count)
