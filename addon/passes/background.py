"""What surrounds the scene, behind it: the world at infinity, seen through the lens (methods 1)."""

from ..device import shader_source, state
from ..device.shaders import ShaderInfo, compile_shader
from . import chromatic
from .environment import ENVIRONMENT_PARAMS
from .surface import HIGHLIGHT_PARAMS, VIEW_PARAMS


def _info(define, in_wavelengths=False):
    split = define is not None
    uniforms = [("ViewParams", "view_buf"), ("EnvironmentParams", "environment_buf")]
    uniforms += [("HighlightParams", "highlight_buf")] * split
    structs = VIEW_PARAMS.source + ENVIRONMENT_PARAMS.source
    info = ShaderInfo(
        name="aplanat_background",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/background_frag.glsl"),
        typedefs=structs + HIGHLIGHT_PARAMS.source * split,
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),),
        samplers=(("FLOAT_2D", "environment_tx"),),
        uniforms=tuple(uniforms),
        push_constants=(("VEC4", "lens_sample"),),
        defines=((define, "1"),) if split else (),
    )
    return chromatic.declared(info) if in_wavelengths else info


def draw(
    fullscreen,
    view_buffer,
    environment_buffer,
    image,
    lens_sample,
    highlights=None,
    wavelength=None,
):
    """Draw the world's image where no surface is; needs the surfaces' depth.

    Parameters
    ----------
    fullscreen : GPUBatch
    view_buffer, environment_buffer : GPUUniformBuf
        `ViewParams` and `EnvironmentParams`.
    image : GPUTexture
        Equirectangular, scene linear.
    lens_sample : sequence of 4 float
        Place on the lens in m, jitter in clip units.
    highlights : GPUUniformBuf or None
        `HighlightParams`: without the light that is splatted.
    wavelength : chromatic.ChromaticSample, optional
    """
    state.behind()
    define = None if highlights is None else "HIGHLIGHTS"
    world = (view_buffer, environment_buffer, image)
    _draw(fullscreen, define, *world, lens_sample, highlights, wavelength)


def draw_excess(fullscreen, view_buffer, environment_buffer, image, highlights):
    """Draw the light of the world's image above the threshold, seen from the lens' centre.

    Parameters
    ----------
    fullscreen, view_buffer, environment_buffer, image
        As for `draw`.
    highlights : GPUUniformBuf
        `HighlightParams`.
    """
    state.overwrite()
    center = (0.0, 0.0, 0.0, 0.0)
    _draw(fullscreen, "EXCESS", view_buffer, environment_buffer, image, center, highlights)


def _draw(
    fullscreen,
    define,
    view_buffer,
    environment_buffer,
    image,
    lens_sample,
    highlights,
    wavelength=None,
):
    shader = compile_shader(_info(define, wavelength is not None))
    shader.bind()
    shader.uniform_block("view_buf", view_buffer)
    shader.uniform_block("environment_buf", environment_buffer)
    if highlights is not None:
        shader.uniform_block("highlight_buf", highlights)
    shader.uniform_sampler("environment_tx", image)
    shader.uniform_float("lens_sample", lens_sample)
    if wavelength is not None:
        wavelength.bind(shader)
    fullscreen.draw(shader)
