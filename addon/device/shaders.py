"""Compiled shaders, kept for the life of the process.

A freed shader's address can be reused and the new one is then never bound, so nothing is ever
removed here; the number of shaders is bounded by the number of shapes of node trees.
"""

import atexit
import re
from contextlib import suppress
from dataclasses import dataclass, field

from ..errors import ShaderCompileError
from . import compiler_log, shader_source
from .bound_shader import Shader

_cache = {}
# The device goes before Python does when the process ends; no shader may outlive it.
atexit.register(_cache.clear)


@dataclass(frozen=True)
class ShaderInfo:
    """Sources and declarations of a shader; equal infos share one compiled shader.

    Parameters
    ----------
    name : str
        For messages.
    vertex, fragment, compute : str
        GLSL text, empty where unused.
    typedefs : str
        Struct declarations for the uniform blocks.
    attributes, varyings : tuple of (str, str)
        GLSL type (upper case) and name. A varying's type may start with ``"FLAT "``.
    outputs : tuple of (str, str)
        Type and name by colour slot.
    samplers, images, uniforms : tuple of tuples
        (type, name), (format, type, name, qualifiers), (struct type, name); slots by position.
    push_constants : tuple of (str, str) or (str, str, int)
    defines : tuple of (str, str)
    local_size : tuple of int
        Of a compute shader.
    writes_depth : bool
    """

    name: str
    vertex: str = ""
    fragment: str = ""
    compute: str = ""
    typedefs: str = ""
    attributes: tuple[tuple[str, str], ...] = ()
    varyings: tuple[tuple[str, str], ...] = ()
    outputs: tuple[tuple[str, str], ...] = ()
    samplers: tuple[tuple[str, str], ...] = ()
    images: tuple[tuple, ...] = ()
    uniforms: tuple[tuple[str, str], ...] = ()
    push_constants: tuple[tuple, ...] = ()
    defines: tuple[tuple[str, str], ...] = ()
    local_size: tuple[int, ...] = field(default=())
    writes_depth: bool = False


def compile_shader(info):
    """Return the compiled shader for `info`, compiling it at its first use.

    Returns
    -------
    Shader

    Raises
    ------
    ShaderCompileError
        With the compiler's log.
    """
    shader = _cache.get(info)
    if shader is None:
        shader = _cache[info] = Shader(info, _compile(info))
    return shader


def compiled_count():
    """Return how many shaders this process has compiled."""
    return len(_cache)


def dispatch(shader, groups_x, groups_y, groups_z=1):
    """Run a compute shader; what it wrote can be read by the next draw or dispatch."""
    import gpu

    shader.check_given()
    gpu.compute.dispatch(shader.program, groups_x, groups_y, groups_z)


def _compile(info):
    import gpu

    try:
        return gpu.shader.create_from_info(_create_info(info))
    except Exception as error:
        # Blender raises a plain Exception here, and prints the driver's log to its own console.
        with compiler_log.caught_console() as console, suppress(Exception):
            gpu.shader.create_from_info(_create_info(info))
        stages = {"Vert": info.vertex, "Frag": info.fragment, "Comp": info.compute}
        messages = compiler_log.locate_messages("".join(console), stages)
        raise ShaderCompileError(info.name, messages or str(error)) from error


def _create_info(info):
    import gpu

    create = gpu.types.GPUShaderCreateInfo()
    if info.typedefs:
        create.typedef_source(info.typedefs)
    for name, value in info.defines:
        create.define(name, value)
    for constant in info.push_constants:
        create.push_constant(*constant)
    for slot, (struct, name) in enumerate(info.uniforms):
        create.uniform_buf(slot, struct, name)
    for slot, (kind, name) in enumerate(info.samplers):
        create.sampler(slot, kind, name)
    for slot, (texel_format, kind, name, qualifiers) in enumerate(info.images):
        create.image(slot, texel_format, kind, name, qualifiers=set(qualifiers))
    for slot, (kind, name) in enumerate(info.attributes):
        create.vertex_in(slot, kind, name)
    for slot, (kind, name) in enumerate(info.outputs):
        create.fragment_out(slot, kind, name)
    if info.compute:
        create.local_group_size(*info.local_size)
        create.compute_source(info.compute)
    else:
        if info.varyings:
            # Interface names are global to the driver: one for each distinct set of varyings.
            interface = gpu.types.GPUStageInterfaceInfo(_interface_name(info.varyings))
            for kind, name in info.varyings:
                if kind.startswith("FLAT "):
                    interface.flat(kind.removeprefix("FLAT "), name)
                else:
                    interface.smooth(kind, name)
            create.vertex_out(interface)
        if info.writes_depth:
            create.depth_write("ANY")
        create.vertex_source(info.vertex)
        create.fragment_source(info.fragment)
    return create


def _interface_name(varyings):
    text = "_".join(f"{kind}_{name}" for kind, name in varyings)
    return "varyings_" + re.sub(r"\W", "", text)


load = shader_source.load
