"""Sprites: one drawing of an object that is copied for several lens samples (methods 4)."""

from ..device import shader_source, state
from ..device.shader_variants import variants
from ..device.shaders import ShaderInfo, compile_shader


@variants(stores=(False, True), mattes=(False, True))
def _info(stores, mattes):
    outputs = [("VEC4", "out_color")]
    outputs += [("VEC4", "out_mattes")] * mattes
    outputs += [("FLOAT", "out_depth")] * stores
    samplers = [("FLOAT_2D", "color_tx"), ("FLOAT_2D", "depth_tx")]
    samplers += [("FLOAT_2D", "mattes_tx")] * mattes
    defines = [("STORE", "1")] * stores + [("MATTES", "1")] * mattes
    return ShaderInfo(
        name="aplanat_sprite",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.load("passes/sprite_frag.glsl"),
        attributes=(("VEC2", "pos"),),
        outputs=tuple(outputs),
        samplers=tuple(samplers),
        push_constants=(("IVEC2", "origin"),),
        defines=tuple(defines),
        writes_depth=not stores,
    )


def store(fullscreen, color, depth, mattes, origin):
    """Copy a rectangle of a drawing into the bound frame buffer of a sprite.

    Parameters
    ----------
    fullscreen : GPUBatch
    color, depth : GPUTexture
    mattes : GPUTexture or None
    origin : tuple of 2 int
        Lower left texel of the rectangle.
    """
    state.overwrite()
    _draw(fullscreen, True, color, depth, mattes, origin)


def copy(fullscreen, sprites, mattes):
    """Copy sprites into the bound frame buffer of a lens sample, nearest surface first.

    Parameters
    ----------
    fullscreen : GPUBatch
    sprites : iterable of (Targets, tuple of 4 int)
        Targets ``color``, ``depth`` (which lies in a colour texture, not in a depth buffer) and
        ``mattes`` of each; x, y, width, height of where it comes to lie.
    mattes : bool
        They have mattes.
    """
    state.opaque()
    shader = compile_shader(_info(False, mattes))
    shader.bind()
    with state.viewport_kept():
        for kept, (x, y, width, height) in sprites:
            state.set_viewport(x, y, width, height)
            textures = kept["color"], kept["depth"], kept["mattes"] if mattes else None
            _fill(shader, fullscreen, *textures, (-x, -y))


def _draw(fullscreen, stores, color, depth, mattes, origin):
    shader = compile_shader(_info(stores, mattes is not None))
    shader.bind()
    _fill(shader, fullscreen, color, depth, mattes, origin)


def _fill(shader, fullscreen, color, depth, mattes, origin):
    shader.uniform_sampler("color_tx", color)
    shader.uniform_sampler("depth_tx", depth)
    if mattes is not None:
        shader.uniform_sampler("mattes_tx", mattes)
    shader.uniform_int("origin", origin)
    shader.draw(fullscreen)
