"""The background: the world at infinity, seen through the lens (methods 1)."""

from ..device import shader_source, state
from ..device.shader_variants import variants
from ..device.shaders import ShaderInfo, compile_shader
from ..device.uniforms import bind_resource
from .bokeh.highlights import APPEND_CONSTANTS, APPEND_DEFINES, APPEND_IMAGES
from .surface import chromatic, real_lens
from .surface.environment import ENVIRONMENT_PARAMS
from .surface.surface import HIGHLIGHT_PARAMS, VIEW_PARAMS


@variants(
    # The search for highlights has no wavelength of its own.
    allowed=lambda define, in_wavelengths, through_lens: (
        define != "EXCESS" or not (in_wavelengths or through_lens)
    ),
    define=(None, "HIGHLIGHTS", "EXCESS"),
    in_wavelengths=(False, True),
    through_lens=(False, True),
)
def _info(define, in_wavelengths=False, through_lens=False):
    split = define is not None
    lists = define == "EXCESS"
    uniforms = [("ViewParams", "view_buf"), ("EnvironmentParams", "environment_buf")]
    uniforms += [("HighlightParams", "highlight_buf")] * split
    structs = VIEW_PARAMS.source + ENVIRONMENT_PARAMS.source
    info = ShaderInfo(
        name="aplanat_background",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/background_frag.glsl"),
        typedefs=structs + HIGHLIGHT_PARAMS.source * split,
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),) * (not lists),
        samplers=(
            ("FLOAT_2D", "environment_tx"),
            *(("FLOAT_2D", "surroundings_tx"),) * split,
            *(("FLOAT_2D", "through_tx"),) * lists,
        ),
        images=APPEND_IMAGES * lists,
        uniforms=tuple(uniforms),
        push_constants=(("VEC4", "lens_sample"), *APPEND_CONSTANTS * lists),
        defines=((define, "1"),) * split + APPEND_DEFINES * lists,
    )
    info = chromatic.declared(info) if in_wavelengths else info
    return real_lens.declared(info) if through_lens else info


def draw(
    fullscreen,
    view_buffer,
    environment_buffer,
    image,
    lens_sample,
    highlights=None,
    wavelength=None,
    lens=None,
):
    """Draw the world's image where the depth buffer shows no surface.

    Parameters
    ----------
    fullscreen : GPUBatch
    view_buffer, environment_buffer : GPUUniformBuf
        `ViewParams` and `EnvironmentParams`.
    image : GPUTexture
        Equirectangular, scene linear.
    lens_sample : sequence of 4 float
        Place on the lens in m, jitter in clip units.
    highlights : bokeh.split_light.SplitLight or None
        The light that is splatted as bokeh is left out.
    wavelength : passes.surface.chromatic.ChromaticSample, optional
    lens : passes.surface.real_lens.LensSample, optional
    """
    state.behind()
    define = None if highlights is None else "HIGHLIGHTS"
    world = (view_buffer, environment_buffer, image)
    _draw(fullscreen, define, *world, lens_sample, highlights, wavelength, lens)


def list_highlights(fullscreen, view_buffer, environment_buffer, image, split, lists, through):
    """Append the texels of the world's image above the highlight threshold to fragment lists.

    Parameters
    ----------
    fullscreen, view_buffer, environment_buffer, image
        As for `draw`; seen from the lens' centre.
    split : bokeh.split_light.SplitLight
    lists : passes.bokeh.highlights.FragmentLists
        Cleared.
    through : GPUTexture
        Share of the light that passes what covers the world from the whole lens, by texel.
    """
    state.overwrite()
    center = (0.0, 0.0, 0.0, 0.0)
    world = (view_buffer, environment_buffer, image)
    bindings = (("through_tx", through), *lists.bindings())
    _draw(fullscreen, "EXCESS", *world, center, split, bindings=bindings)


def _draw(
    fullscreen,
    define,
    view_buffer,
    environment_buffer,
    image,
    lens_sample,
    highlights=None,
    wavelength=None,
    lens=None,
    bindings=(),
):
    shader = compile_shader(_info(define, wavelength is not None, lens is not None))
    shader.bind()
    shader.uniform_block("view_buf", view_buffer)
    shader.uniform_block("environment_buf", environment_buffer)
    if highlights is not None:
        highlights.bind(shader)
    shader.uniform_sampler("environment_tx", image)
    shader.uniform_float("lens_sample", lens_sample)
    if wavelength is not None:
        wavelength.bind(shader)
    if lens is not None:
        lens.bind(shader)
    for name, resource in bindings:
        bind_resource(shader, name, resource)
    shader.draw(fullscreen)
