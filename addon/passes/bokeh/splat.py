"""Splatting highlights: a disc each, in the shape of the opening, added up (methods 13).

Shader variants add to the shape of the opening: PROFILE (radial bokeh profile of a traced lens),
RIMS (analytic optical vignetting), TILES (patterns of a real lens over the field), with CYLINDERS
of one that is not of revolution, and OPENED where an opening that is not even masks them.

The light of each disc is found before its square is drawn, by a pass of its own: of small discs it
takes a sum over the pixels.
"""

from ...device import shader_source, state
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader, dispatch
from ...device.targets import Targets, TargetSpec
from ...device.uniform_block import UniformStruct
from ...device.uniforms import bind_resource
from ..surface import chromatic, real_lens
from ..surface.surface import VIEW_PARAMS
from ..visibility.culling import VISIBILITY_PARAMS
from .highlights import COLUMNS

SPLAT_PARAMS = UniformStruct("shared/splat_params.glsl", "SplatParams")

_SOURCES = ("sources_a_tx", "sources_b_tx", "tiles_tx")
# Of a group that finds the light of discs.
_THREADS = 64
_RAYS = ("layers_tx", "opacity_tx", "states_tx")
MOST_RIMS = 4
# Textures and varyings of the variants.
_LOOK_TEXTURES = {
    "CYLINDERS": (),
    "PROFILE": (("FLOAT_2D_ARRAY", "profile_tx"),),
    "RIMS": (("FLOAT_2D_ARRAY", "left_tx"),),
    "TILES": (
        ("FLOAT_2D_ARRAY", "sharp_tx"),
        ("FLOAT_2D_ARRAY", "soft_tx"),
        ("FLOAT_2D", "places_tx"),
    ),
    "OPENED": (("FLOAT_2D_ARRAY", "opening_tx"), ("FLOAT_2D_ARRAY", "left_tx")),
}
_LOOK_VARYINGS = {
    "CYLINDERS": (("FLAT FLOAT", "v_tile_up"),),
    "PROFILE": (("FLAT FLOAT", "v_row"),),
    "RIMS": (("FLAT VEC3", "v_left_lower"), ("FLAT VEC3", "v_left_upper")),
    "TILES": (
        ("FLAT FLOAT", "v_row"),
        ("FLAT VEC2", "v_tile_at"),
        ("FLAT FLOAT", "v_upright"),
    ),
    "OPENED": (("FLAT VEC3", "v_left_lower"), ("FLAT VEC3", "v_left_upper")),
}


_VARIANTS = (
    *((), ("PROFILE",), ("RIMS",), ("PROFILE", "RIMS")),
    *(("TILES",), ("TILES", "OPENED"), ("TILES", "CYLINDERS"), ("TILES", "CYLINDERS", "OPENED")),
)


def _look_samplers(variants):
    samplers = () if "TILES" in variants else (("FLOAT_2D_ARRAY", "opening_tx"),)
    return samplers + tuple(texture for name in variants for texture in _LOOK_TEXTURES[name])


@variants(variants=_VARIANTS, in_wavelengths=(False, True), through_lens=(False, True))
def _density_info(variants, in_wavelengths=False, through_lens=False):
    info = ShaderInfo(
        name="aplanat_splat_density",
        compute=shader_source.load("passes/bokeh/splat_density_comp.glsl"),
        typedefs=VIEW_PARAMS.source + SPLAT_PARAMS.source,
        samplers=tuple(("FLOAT_2D", name) for name in _SOURCES) + _look_samplers(variants),
        images=(("RGBA32F", "FLOAT_2D", "density_img", ("WRITE",)),),
        uniforms=(("ViewParams", "view_buf"), ("SplatParams", "splat_buf")),
        push_constants=(("INT", "discs"),),
        defines=(("SOURCE_COLUMNS", str(COLUMNS)), *((variant, "1") for variant in variants)),
        local_size=(_THREADS, 1, 1),
    )
    info = chromatic.over_field(info) if in_wavelengths else info
    samplers = real_lens.LIGHT_SAMPLERS + real_lens.AREA_SAMPLERS
    return real_lens.declared(info, samplers) if through_lens else info


@variants(
    casts=(False, True),
    variants=_VARIANTS,
    in_wavelengths=(False, True),
    through_lens=(False, True),
)
def _info(casts, variants, in_wavelengths=False, through_lens=False):
    names = (*_SOURCES, "masks_tx", "density_tx", *_RAYS * casts)
    uniforms = (("ViewParams", "view_buf"), ("SplatParams", "splat_buf"))
    uniforms += (("VisibilityParams", "visibility_buf"),) * casts
    structs = VIEW_PARAMS.source + SPLAT_PARAMS.source
    info = ShaderInfo(
        name="aplanat_splat",
        vertex=shader_source.load("passes/bokeh/splat_vert.glsl"),
        fragment=shader_source.load("passes/bokeh/splat_frag.glsl"),
        typedefs=structs + VISIBILITY_PARAMS.source * casts,
        attributes=(("VEC2", "pos"),),
        varyings=(
            ("VEC2", "v_place"),
            ("FLAT VEC3", "v_density"),
            ("FLAT FLOAT", "v_blur"),
            ("FLAT VEC4", "v_tile"),
            ("FLAT INT", "v_source"),
            ("FLAT FLOAT", "v_region"),
            ("FLAT VEC2", "v_chief"),
            *(("FLAT VEC3", "v_area"), ("FLAT FLOAT", "v_dot")) * in_wavelengths,
            *(varying for variant in variants for varying in _LOOK_VARYINGS[variant]),
        ),
        outputs=(("VEC4", "out_color"),),
        samplers=tuple(("FLOAT_2D", name) for name in names) + _look_samplers(variants),
        uniforms=uniforms,
        defines=(
            ("SOURCE_COLUMNS", str(COLUMNS)),
            *(("IN_SPLAT", "1"),) * casts,
            *((variant, "1") for variant in variants),
        ),
    )
    info = chromatic.over_field(info) if in_wavelengths else info
    return real_lens.declared(info) if through_lens else info


def splat(square, count, textures, look, view_buffer, rays=None):
    """Add highlights to the bound frame buffer.

    Parameters
    ----------
    square : GPUBatch
        Two triangles over the unit square.
    count : int
        How many highlights.
    textures : sequence of 4 GPUTexture
        The list of highlights (see `passes.bokeh.highlights`), the mask of each, and the atlas
        of masks (see `engine.visibility.stage`).
    look : engine.bokeh.look.BokehLook
        Shape of the discs, as ``variants``, ``textures`` and, for each band of wavelengths,
        ``blocks``; ``field`` as in `passes.bokeh.highlights.SearchedRaster`, empty without bands;
        ``lens``, the `LensSample` of the middle of a real lens, or None.
    view_buffer : GPUUniformBuf
        `ViewParams` of the frame.
    rays : tuple or None
        For visibility that is tested by rays while splatting: peeled layers, opacity and states
        (GPUTexture), and `VisibilityParams` (GPUUniformBuf).

    Returns
    -------
    Targets or None
        To be released when the device has drawn the discs.
    """
    if count == 0:
        return None
    variant = look.variants, bool(look.field), look.lens is not None
    sources, masks = textures[:3], textures[3]
    tables = Targets(COLUMNS, -(-count // COLUMNS), [TargetSpec("density", "RGBA32F")])
    weighing = compile_shader(_density_info(*variant))
    drawing = compile_shader(_info(rays is not None, *variant))
    for number in range(len(look.blocks)):
        _bind(weighing, sources, look, view_buffer, number)
        weighing.image("density_img", tables["density"])
        weighing.uniform_int("discs", count)
        if look.lens is not None:
            weighing.uniform_sampler("light_tx", look.lens.light.texture)
        dispatch(weighing, -(-COLUMNS // _THREADS), -(-count // COLUMNS))
        state.additive()
        _bind(drawing, sources, look, view_buffer, number)
        drawing.uniform_sampler("masks_tx", masks)
        drawing.uniform_sampler("density_tx", tables["density"])
        if rays is not None:
            for name, texture in zip(_RAYS, rays[:3], strict=True):
                drawing.uniform_sampler(name, texture)
            drawing.uniform_block("visibility_buf", rays[3])
        drawing.draw_instanced(square, count)
    return tables


def _bind(shader, sources, look, view_buffer, band):
    """Bind a shader with what tells the place and the shape of discs in a band of wavelengths."""
    shader.bind()
    for name, resource in look.field:
        bind_resource(shader, name, resource)
    if look.lens is not None:
        look.lens.bind(shader)
        if look.lens.tables > 1:
            shader.uniform_int("lens_slot", band)
    for name, texture in (*zip(_SOURCES, sources, strict=True), *look.textures):
        shader.uniform_sampler(name, texture)
    shader.uniform_block("view_buf", view_buffer)
    shader.uniform_block("splat_buf", look.blocks[band])
