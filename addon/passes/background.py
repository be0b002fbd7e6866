"""What surrounds the scene, behind it: the world at infinity, seen through the lens (methods 1)."""

from ..device import shader_source, state
from ..device.shaders import ShaderInfo, compile_shader
from . import chromatic
from .environment import ENVIRONMENT_PARAMS
from .surface import VIEW_PARAMS

_INFO = ShaderInfo(
    name="aplanat_background",
    vertex=shader_source.load("passes/fullscreen_vert.glsl"),
    fragment=shader_source.load("passes/background_frag.glsl"),
    typedefs=VIEW_PARAMS.source + ENVIRONMENT_PARAMS.source,
    attributes=(("VEC2", "pos"),),
    outputs=(("VEC4", "out_color"),),
    samplers=(("FLOAT_2D", "environment_tx"),),
    uniforms=(("ViewParams", "view_buf"), ("EnvironmentParams", "environment_buf")),
    push_constants=(("VEC4", "lens_sample"),),
)
_IN_WAVELENGTHS = chromatic.declared(_INFO)


def draw(fullscreen, view_buffer, environment_buffer, image, lens_sample, wavelength=None):
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
    wavelength : chromatic.ChromaticSample, optional
    """
    state.behind()
    shader = compile_shader(_INFO if wavelength is None else _IN_WAVELENGTHS)
    shader.bind()
    shader.uniform_block("view_buf", view_buffer)
    shader.uniform_block("environment_buf", environment_buffer)
    shader.uniform_sampler("environment_tx", image)
    shader.uniform_float("lens_sample", lens_sample)
    if wavelength is not None:
        wavelength.bind(shader)
    fullscreen.draw(shader)
