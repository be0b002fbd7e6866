"""Subsample blur: a lens sample blurred over the part of the lens it stands for (methods 6)."""

from ..device import shader_source, state
from ..device.shader_variants import variants
from ..device.shaders import ShaderInfo, compile_shader
from ..device.targets import TargetSpec
from ..device.uniform_block import UniformStruct
from ..device.uniforms import uniform_buffer
from ..sampling.sequence import SETS
from .surface import chromatic, real_lens

_SAMPLERS = (
    ("FLOAT_2D", "sample_tx"),
    ("FLOAT_2D", "depth_tx"),
    ("FLOAT_2D", "offsets_tx"),
    ("FLOAT_2D_ARRAY", "means_tx"),
    ("FLOAT_2D_ARRAY", "ranges_tx"),
)

SUBSAMPLE_PARAMS = UniformStruct("shared/subsample_params.glsl", "SubsampleParams")

# What a pixel sees with sets: blurred in front of the focus, all else, shares and blur.
SORTED = ("near", "others", "shares")


@variants(
    lambda dispersed, through_lens, sets: not (sets and dispersed),
    dispersed=(False, True),
    through_lens=(False, True),
    sets=(False, True),
)
def _info(dispersed, through_lens, sets=False):
    info = ShaderInfo(
        name="aplanat_subsample",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/subsample_frag.glsl"),
        typedefs=SUBSAMPLE_PARAMS.source,
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),)
        if not sets
        else (("VEC4", "out_near"), ("VEC4", "out_color"), ("VEC4", "out_shares")),
        samplers=_SAMPLERS,
        uniforms=(("SubsampleParams", "subsample_buf"),),
        push_constants=(
            ("VEC2", "jitter"),
            ("VEC2", "apart"),
            ("FLOAT", "weight"),
            ("INT", "sample_index"),
            ("INT", "count"),
        ),
        defines=(("PIXEL_SETS", str(SETS)),) * sets,
    )
    if dispersed:
        info = chromatic.declared(info, (("VEC4", "tint"),))
    if through_lens:
        samplers = (("FLOAT_2D", "turns_tx"), *real_lens.LIGHT_SAMPLERS)
        info = real_lens.declared(info, samplers)
    return info


def sorted_specs():
    """Return the render targets of a blur with sets."""
    near, others, shares = SORTED
    return (
        TargetSpec(near, "RGBA32F"),
        TargetSpec(others, "RGBA32F"),
        TargetSpec(shares, "RGBA32F"),
    )


def params(*, sweep, spread, depths, cell, top, levels, gain=None):
    """Upload what is the same for all lens samples.

    Parameters
    ----------
    sweep : sequence of 4 float
        See ``lib/bokeh/sweep_lib.glsl``.
    spread : sequence of 2 float
        Largest offset of any sample along x and y, m.
    depths : sequence of 2 float
        Least and largest value that the depth buffer may have.
    cell : float
        Side of the part of the lens that a subsample's ray stands for, m.
    top : int
        Levels of the pyramid's mean colours that are used; 0 uses none.
    levels : int
        Levels of its depth ranges.
    gain : sequence of 4 float, optional
        With chromatic aberration: change of `sweep` by the inverse of the focus distance.

    Returns
    -------
    GPUUniformBuf
    """
    gain = (0.0,) * 4 if gain is None else gain
    block = {"bounds": (*spread, *depths), "cell": (cell, float(top), float(levels), 0.0)}
    return uniform_buffer(SUBSAMPLE_PARAMS.pack(sweep=sweep, gain=gain, **block))


def blur(
    fullscreen,
    textures,
    block,
    *,
    jitter,
    apart,
    weight,
    index,
    count,
    wavelength=None,
    lens=None,
    sets=False,
):
    """Blur a lens sample and add it to the bound frame buffer.

    Parameters
    ----------
    fullscreen : GPUBatch
    textures : sequence of 5 GPUTexture
        Colour and depth of the sample; subsamples, one row a sample: places on the lens relative to
        the sample's, m, and from a pixel's centre to the place that is looked at, texels of the
        sample; means and ranges of the sample's pyramid.
    block : GPUUniformBuf
        Of `params`.
    jitter : sequence of 2 float
        From a pixel's centre to the place that is looked at where the picture ends too near for
        those of the subsamples, texels; less than half of one.
    apart : sequence of 2 float
        Largest of the subsamples' distances from a pixel's centre, along x and y, texels.
    weight : float
    index, count : int
        Row of the offsets, and number of subsamples in it.
    wavelength : passes.surface.chromatic.ChromaticSample, optional
        The sample's; its subsamples have the same.
    lens : passes.surface.real_lens.LensSample, optional
        The sample's, with ``turns``.
    sets : bool
        Pixels have different places on the lens: `SETS` x `SETS` rows of the subsamples a sample.
        The frame buffer has the `SORTED` targets, and is overwritten. Not with wavelengths.
    """
    if sets:
        state.overwrite()
    else:
        state.additive()
    shader = compile_shader(_info(wavelength is not None, lens is not None, sets))
    shader.bind()
    for (_, name), texture in zip(_SAMPLERS, textures, strict=True):
        shader.uniform_sampler(name, texture)
    shader.uniform_block("subsample_buf", block)
    shader.uniform_float("jitter", tuple(jitter))
    shader.uniform_float("apart", tuple(apart))
    shader.uniform_float("weight", weight)
    shader.uniform_int("sample_index", index)
    shader.uniform_int("count", count)
    if lens is not None:
        lens.bind(shader)
        shader.uniform_sampler("turns_tx", lens.turns)
        shader.uniform_sampler("light_tx", lens.light.texture)
    if wavelength is not None:
        wavelength.bind(shader)
        shader.uniform_float("tint", wavelength.tint)
    shader.draw(fullscreen)
