"""The nodes of a world as one equirectangular image: images turned, mixed and coloured.

They are computed once when the world changes, so that background, highlights and lighting read a
world of one image.
"""

import numpy as np

from ...device import geometry, readback, shader_source, state
from ...device.shaders import ShaderInfo, compile_shader
from ...device.targets import Targets, TargetSpec
from ...device.uniforms import uniform_buffer
from ..nodes import surface_code

# Images below the first size (texels along the longer side) are baked twice as finely, and none
# smaller than the second: the baked result is interpolated after the nodes, not before.
_SMALL, _LEAST = 2048, 1024


def bake(graph, images, textures):
    """Evaluate the nodes of a world into one image.

    Parameters
    ----------
    graph : SurfaceGraph
        With an emission as its surface.
    images : dict of int to ImageSnapshot
    textures : dict of int to GPUTexture
        The images on the device, by the same numbers.

    Returns
    -------
    ndarray of shape (height, width, 3)
        Scene linear, as large as the largest of its images, or larger where that is small.
    """
    code = surface_code.generate(graph, ())
    height, width = np.max([images[uid].pixels.shape[:2] for uid in code.images], axis=0).tolist()
    longest = max(width, height)
    finer = max(2 if longest <= _SMALL else 1, -(-_LEAST // longest))
    width, height = finer * width, finer * height
    # It must live until the device has drawn.
    constants = uniform_buffer(np.array(code.constants, np.float32).tobytes())
    with Targets(width, height, [TargetSpec("world", "RGBA32F")]) as targets:
        framebuffer = targets.framebuffer("world")
        with framebuffer.bind():
            state.overwrite()
            shader = compile_shader(_info(code))
            shader.bind()
            shader.uniform_block("material_buf", constants)
            for i, uid in enumerate(code.images):
                shader.uniform_sampler(f"image_{i}_tx", textures[uid])
            shader.uniform_float("texel_size", (1.0 / width, 1.0 / height))
            shader.draw(geometry.fullscreen_batch())
        pixels = readback.read_color(framebuffer, width, height)
    return np.ascontiguousarray(pixels[..., :3])


def _info(code):
    libraries = (
        "lib/surface/color_lib.glsl",
        "lib/surface/environment_sample_lib.glsl",
        "lib/surface/vector_lib.glsl",
        "lib/surface/closure_lib.glsl",
        *code.libraries,
    )
    text = shader_source.Text(code.source)
    return ShaderInfo(
        name="aplanat_environment_bake",
        vertex=shader_source.load("passes/fullscreen_vert.glsl"),
        fragment=shader_source.join(
            (*libraries, text, "passes/surface/environment_bake_frag.glsl")
        ),
        typedefs=f"struct MaterialParams {{ vec4 constants[{len(code.constants)}]; }};\n",
        attributes=(("VEC2", "pos"),),
        outputs=(("VEC4", "out_color"),),
        samplers=tuple(("FLOAT_2D", f"image_{i}_tx") for i in range(len(code.images))),
        uniforms=(("MaterialParams", "material_buf"),),
        push_constants=(("VEC2", "texel_size"),),
    )
