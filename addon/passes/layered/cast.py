"""Rays of one lens sample through depth layers (methods 7)."""

from ...device import shader_source, state
from ...device.shader_variants import variants
from ...device.shaders import ShaderInfo, compile_shader
from ...device.uniform_block import UniformStruct
from ..surface import chromatic, real_lens

LAYERED_PARAMS = UniformStruct("shared/layered_params.glsl", "LayeredParams")

_SAMPLERS = (
    *(("FLOAT_2D_ARRAY", f"{name}_tx") for name in ("colors", "depths", "means", "ranges")),
    ("FLOAT_2D", "behind_tx"),
    ("FLOAT_2D", "places_tx"),
)


@variants(
    allowed=lambda mattes, colored, eyes, counted, through_lens: not (counted and mattes),
    mattes=(False, True),
    colored=(False, True),
    eyes=(False, True),
    counted=(False, True),
    through_lens=(False, True),
)
def _info(mattes=False, colored=False, eyes=False, counted=False, through_lens=False):
    info = ShaderInfo(
        name="aplanat_layered",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/layered/layered_frag.glsl"),
        typedefs=LAYERED_PARAMS.source,
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"), *[("VEC4", "out_mattes")] * mattes),
        samplers=(*_SAMPLERS, *[("FLOAT_2D_ARRAY", "mattes_tx")] * mattes),
        uniforms=(("LayeredParams", "layered_buf"),),
        push_constants=(
            ("VEC4", "sweep"),
            ("VEC2", "offset"),
            ("INT", "sample_index"),
            ("INT", "culls"),
            *[("FLOAT", "empty_focus")] * mattes,
            *[("INT", "lens_sets")] * through_lens,
        ),
        defines=(
            *(("MATTES", "1"),) * mattes,
            *(("EYES", "1"),) * eyes,
            *(("COUNTED", "1"),) * counted,
        ),
        writes_depth=True,
    )
    info = chromatic.declared(info, (("VEC4", "gain"),)) if colored else info
    return real_lens.declared(info) if through_lens else info


def cast(
    fullscreen,
    layers,
    behind,
    places,
    params,
    *,
    sweep,
    offset,
    index,
    empty_focus,
    gain=None,
    wavelength=None,
    lens=None,
    eyes=False,
    culls=True,
    counts=False,
):
    """Draw a lens sample into the bound frame buffer, with its depth.

    Parameters
    ----------
    fullscreen : GPUBatch
    layers : Targets
        See `layers.specs`; with mattes, the frame buffer has a second target.
    behind : GPUTexture
        What surrounds the scene, as large as the sample; of one texel where it is one colour.
    places : GPUTexture
        Places on the lens, m: a row a set, a column a sample.
    params : GPUUniformBuf
        `LayeredParams`.
    sweep : sequence of 4 float
        See ``lib/bokeh/sweep_lib.glsl``.
    offset : sequence of 2 float
        Of the sample in its pixel, texels.
    index : int
    empty_focus : float
        Share of sharpness where nothing is.
    gain : sequence of 4 float, optional
        With chromatic aberration: of the sweep, by the inverse of the focus distance.
    wavelength : chromatic.ChromaticSample, optional
    lens : real_lens.LensSample, optional
        What bends the rays.
    eyes : bool
        Layers have colours from five places on the lens, whose first is the middle.
    culls : bool
        Layers that a ray cannot meet are skipped; the picture is the same without.
    counts : bool
        Draw what was done instead: layers, layers that were looked into, depths that were read.
    """
    state.always()
    mattes = "mattes" in layers and not counts
    variant = (mattes, wavelength is not None, eyes, counts, lens is not None)
    shader = compile_shader(_info(*variant))
    shader.bind()
    for name in ("colors", "depths", "means", "ranges"):
        shader.uniform_sampler(f"{name}_tx", layers[name])
    shader.uniform_sampler("behind_tx", behind)
    shader.uniform_sampler("places_tx", places)
    shader.uniform_block("layered_buf", params)
    shader.uniform_float("sweep", tuple(sweep))
    shader.uniform_float("offset", tuple(offset))
    shader.uniform_int("sample_index", index)
    shader.uniform_int("culls", int(culls))
    if mattes:
        shader.uniform_sampler("mattes_tx", layers["mattes"])
        shader.uniform_float("empty_focus", empty_focus)
    if wavelength is not None:
        wavelength.bind(shader)
        shader.uniform_float("gain", tuple(gain))
    if lens is not None:
        lens.bind(shader)
        shader.uniform_int("lens_sets", lens.sets)
    shader.draw(fullscreen)
