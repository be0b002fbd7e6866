"""Subsample blur: a lens sample blurred over the part of the lens it stands for (methods 6)."""

from ..device import shader_source, state
from ..device.shaders import ShaderInfo, compile_shader

_SAMPLERS = ("sample_tx", "depth_tx", "bounds_tx", "offsets_tx")


def _info(image):
    samplers = [("FLOAT_2D", name) for name in _SAMPLERS]
    constants = [("VEC4", "sweep")]
    if image:
        samplers.append(("FLOAT_2D", "backdrop_tx"))
        constants.append(("VEC4", "lens_sample"))
    else:
        constants.append(("VEC4", "backdrop"))
    constants += [("VEC2", "spread"), ("FLOAT", "weight"), ("INT", "sample_index")]
    return ShaderInfo(
        name="aplanat_subsample",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/subsample_frag.glsl"),
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),),
        samplers=tuple(samplers),
        push_constants=(*constants, ("INT", "count")),
        defines=(("BACKDROP_IMAGE", "1"),) if image else (),
    )


def blur(fullscreen, textures, *, sweep, backdrop, lens_sample, spread, weight, index, count):
    """Blur a lens sample and add it to the bound frame buffer.

    Parameters
    ----------
    fullscreen : GPUBatch
    textures : sequence of 4 GPUTexture
        Colour and depth of the sample; bounds of the depths that reach each pixel; offsets, one row
        a sample.
    sweep : sequence of 4 float
        See ``lib/sweep_lib.glsl``.
    backdrop : sequence of 4 float or GPUTexture
        What is behind everything: a colour, or a picture of it from the lens' centre, without
        movement for the pixel filter.
    lens_sample : sequence of 4 float
        Place on the lens in m, jitter in clip units.
    spread : sequence of 2 float
        Largest offset of any sample along x and y, m.
    weight : float
    index, count : int
        Row of the offsets, and how many there are in it.
    """
    state.additive()
    is_color = isinstance(backdrop, tuple)
    shader = compile_shader(_info(image=not is_color))
    shader.bind()
    for name, texture in zip(_SAMPLERS, textures, strict=True):
        shader.uniform_sampler(name, texture)
    shader.uniform_float("sweep", tuple(sweep))
    if is_color:
        shader.uniform_float("backdrop", backdrop)
    else:
        shader.uniform_sampler("backdrop_tx", backdrop)
        shader.uniform_float("lens_sample", tuple(lens_sample))
    shader.uniform_float("spread", tuple(spread))
    shader.uniform_float("weight", weight)
    shader.uniform_int("sample_index", index)
    shader.uniform_int("count", count)
    fullscreen.draw(shader)
