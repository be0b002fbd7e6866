"""Every pass in every variant, and something to give to all that a shader declares.

The variants come from the passes themselves: `device.shader_variants`, the infos and the surface
targets that their modules hold. Used by tests in this process and in the real Blender.
"""

import importlib
import pkgutil
from dataclasses import replace
from itertools import combinations, product

import numpy as np

from addon import passes
from addon.device import geometry, shader_variants
from addon.device.shaders import ShaderInfo, compile_shader, dispatch
from addon.device.targets import Targets, TargetSpec
from addon.device.uniforms import uniform_buffer
from addon.passes.bokeh import peel
from addon.passes.nodes import surface_code
from addon.passes.surface import (
    data,
    deferred,
    environment_bake,
    glass,
    surface,
    surface_target,
)
from addon.snapshot.surface_graph import Constant, Link, ShaderNode, SurfaceGraph

_MODULES = [
    importlib.import_module(found.name)
    for found in pkgutil.walk_packages(passes.__path__, f"{passes.__name__}.")
]


def fixed_infos():
    """Infos that a module holds, singly."""
    for module in _MODULES:
        for name, value in vars(module).items():
            if isinstance(value, ShaderInfo):
                yield f"{module.__name__}.{name}", value


def surface_targets():
    """Every target of surfaces, as modules hold them and as the pipeline changes them."""
    for module in _MODULES:
        for name, value in vars(module).items():
            if isinstance(value, surface_target.SurfaceTarget):
                yield f"{module.__name__}.{name}", value
    for target in (surface_target.COLOR, surface_target.COLOR_AND_MATTES):
        for splits, disperses, bends in tuple(product((False, True), repeat=3))[1:]:
            made = surface_target.without_highlights(target) if splits else target
            made = surface_target.in_wavelengths(made) if disperses else made
            made = surface_target.through_lens(made) if bends else made
            yield f"color {splits=} {disperses=} {bends=}", made
    for target in (surface_target.COLOR, surface_target.COLOR_AND_MATTES):
        shadowed = surface_target.lit(target, True)
        yield "shadows", shadowed
        yield "shadows split", surface_target.without_highlights(shadowed)
        yield "layer shadows", surface_target.of_layers(shadowed)
        yield "layer", surface_target.of_layers(target)
        split = surface_target.without_highlights(target)
        yield "layer splits", surface_target.of_layers(split)
        bent = surface_target.of_layers(surface_target.blurred_by_lens(target))
        yield "layer through a real lens", bent
    bent = surface_target.through_lens(surface_target.in_wavelengths(surface_target.COLOR))
    for target in (surface_target.COLOR, bent):
        yield "backs of glass", glass.exits_of(target)
    for target in (peel.HIGHLIGHTS, peel.VEILS):
        yield "shadows searched", surface_target.lit(target, True)
    for number in range(3):
        for names in combinations(("Vector", "Detail"), number):
            for bends in (False, True):
                yield f"data {names} {bends=}", data.target(names, bends)


def _node(kind, settings=(), **inputs):
    given = (
        (name.replace("_", " "), value if isinstance(value, Link) else Constant(value))
        for name, value in inputs.items()
    )
    return ShaderNode(kind, tuple(given), settings)


_GLOW = _node("emission", Color=(1.0, 1.0, 1.0), Strength=(2.0,))
_CLEAR = _node("transparent", Color=(1.0, 0.5, 1.0))


def _pair(kind):
    shaders_in = (("Shader", Link(0, "BSDF")), ("Shader_001", Link(1, "Emission")))
    if kind == "mix_shader":
        shaders_in = (("Fac", Constant((0.5,))), *shaders_in)
    return SurfaceGraph((_CLEAR, _GLOW, ShaderNode(kind, shaders_in)), Link(2, "Shader"))


def _principled(**more):
    principled = _node(
        "principled",
        **{
            "Base Color": (1.0, 1.0, 1.0),
            "Metallic": (0.0,),
            "Roughness": (0.5,),
            "IOR": (1.5,),
            "Specular IOR Level": (0.5,),
            "Specular Tint": (1.0, 1.0, 1.0),
            "Emission Color": (1.0, 1.0, 1.0),
            "Emission Strength": (1.0,),
        },
        **more,
    )
    return SurfaceGraph((principled,), Link(0, "BSDF"))


def _rarer():
    """A mix of glass and of a coated surface that lets light pass."""
    coat = {"Coat Weight": (1.0,), "Coat Roughness": (0.1,), "Coat IOR": (1.5,)}
    coated = _principled(**coat, **{"Coat Tint": (1.0, 1.0, 1.0), "Transmission Weight": (0.5,)})
    glass = _node("glass", (("mirrors", "1"),), Color=(1.0,), Roughness=(0.1,), IOR=(1.4,))
    shaders_in = (("Fac", Constant((0.5,))), ("Shader", Link(0, "BSDF")))
    mixed = ShaderNode("mix_shader", (*shaders_in, ("Shader_001", Link(1, "BSDF"))))
    return SurfaceGraph((*coated.nodes, glass, mixed), Link(2, "Shader"))


def _fibres():
    """A mix of a toon and of a rough surface with fibres on top."""
    sheen = {"Sheen Weight": (1.0,), "Sheen Roughness": (0.5,), "Sheen Tint": (1.0, 1.0, 1.0)}
    cloth = _principled(**sheen, **{"Diffuse Roughness": (0.5,)})
    toon = _node("toon", (("component", "TOON"),), Color=(1.0,), Size=(0.5,), Smooth=(0.1,))
    shaders_in = (("Fac", Constant((0.5,))), ("Shader", Link(0, "BSDF")))
    mixed = ShaderNode("mix_shader", (*shaders_in, ("Shader_001", Link(1, "BSDF"))))
    return SurfaceGraph((*cloth.nodes, toon, mixed), Link(2, "Shader"))


_FOG = _node("fog", Absorption=(1.0,), Scatter=(1.0,), Emission=(0.0,), Anisotropy=(0.2,))
_COLOURS = _node("color_attribute", (("name", "Col"),))
_LIT_BY_ATTRIBUTE = SurfaceGraph(
    (_COLOURS, _node("diffuse", Color=Link(0, "Color"))), Link(1, "BSDF")
)
# Shapes of materials that differ in what their shaders read: light, opacity, attributes.
GRAPHS = {
    "nothing": SurfaceGraph(),
    "emission": SurfaceGraph((_GLOW,), Link(0, "Emission")),
    "transparent": SurfaceGraph((_CLEAR,), Link(0, "BSDF")),
    "mixed": _pair("mix_shader"),
    "added": _pair("add_shader"),
    "lit": _principled(),
    "lit and transparent": _principled(Alpha=(0.5,)),
    "rarer closures": _rarer(),
    "fibres": _fibres(),
    "fog": SurfaceGraph((_FOG,), Link(0, "Volume")),
    "mirroring": SurfaceGraph(
        (_node("glossy", Color=(1.0, 1.0, 1.0), Roughness=(0.5,)),), Link(0, "BSDF")
    ),
    "attribute": _LIT_BY_ATTRIBUTE,
}
# Graphs on meshes that between them read all that shaders can read: what a target changes in one of
# the others it changes in these. The others are tried with one plain target on each mesh.
_TELLING = {
    ("nothing", "bare"),
    ("emission", "whole"),
    ("mixed", "bare"),
    ("rarer closures", "whole"),
    ("mirroring", "bare"),
    ("attribute", "bare"),
}
# Those of which shaders that shade once a pixel are tried, too.
_SHADED_ONCE = ("mirroring", "attribute")
_PLAIN = (surface_target.COLOR, surface_target.COLOR_AND_MATTES)
_TARGET_OF = {"bare": surface_target.COLOR, "whole": surface_target.COLOR_AND_MATTES}
# With and without what a mesh may lack.
MESHES = {
    "bare": {},
    "whole": {"normal": np.zeros((3, 3)), "color:Col": np.zeros((3, 4))},
}


def surface_infos():
    """Infos of every surface target for every kind of surface."""
    for (target_name, target), (graph_name, graph), (mesh_name, mesh) in product(
        surface_targets(), GRAPHS.items(), MESHES.items()
    ):
        if (graph_name, mesh_name) not in _TELLING and target is not _TARGET_OF[mesh_name]:
            continue
        code = surface_code.generate(graph, mesh)
        if graph_name in _SHADED_ONCE and target.fragment == surface_target.COLOR.fragment:
            once = replace(target, deferred="OF_LAYER" not in target.defines)
            for info in (deferred.infos(once, code, mesh, deforms=False) or ())[:2]:
                yield f"{info.name}, {target_name}, {graph_name}, {mesh_name}", info
        parts = (None, *["GLOW"] * code.glows, *["FILTER"] * code.filters)
        for holdout, deforms, part in product((False, True), (False, True), parts):
            if part and holdout:
                continue
            # Deforming is of corners, the others are of the end of a fragment: singly with the
            # plain targets, together with the others.
            ends = holdout or bool(part)
            if (deforms and ends) if target in _PLAIN else (deforms != ends):
                continue
            label = f"{target_name}, {graph_name}, {mesh_name}, {holdout=}, {deforms=}, {part=}"
            yield label, surface.surface_info(target, code, mesh, holdout, deforms, part)


def world_infos():
    """Infos of worlds that are computed as one image: of one image, and of an encoded one."""
    for settings in ((), (("encoding", "srgb"),)):
        axes = {axis: Constant((1.0, 0.0, 0.0)) for axis in "XYZ"}
        image = ShaderNode("environment_texture", tuple(axes.items()), settings, image=1)
        light = _node("emission", Color=Link(0, "Color"), Strength=(1.0,))
        graph = SurfaceGraph((image, light), Link(1, "Emission"))
        code = surface_code.generate(graph, ())
        yield f"world {settings}", environment_bake._info(code)


def every_info():
    """All of them once, by what they are made of."""
    found = {}
    for label, info in (
        *shader_variants.every_info(),
        *fixed_infos(),
        *surface_infos(),
        *world_infos(),
    ):
        found.setdefault(info, label)
    return found


def give(shader, kind, name, texture_of):
    """Bind something that fits to a declared resource."""
    if kind == "block":
        shader.uniform_block(name, texture_of(name))
    elif kind == "sampler":
        shader.uniform_sampler(name, texture_of(name))
    elif kind == "image":
        shader.image(name, texture_of(name))
    else:
        glsl = texture_of(name)
        size = {"VEC2": 2, "VEC3": 3, "VEC4": 4, "IVEC2": 2, "IVEC4": 4}.get(glsl, 1)
        value = (0,) * size if size > 1 else 0
        whole = glsl.startswith("I")
        (shader.uniform_int if whole else shader.uniform_float)(
            name, value if whole or size > 1 else 0.0
        )


def make_texture(kind, texel_format):
    import gpu

    layers = {"layers": 2} if kind.endswith("ARRAY") else {}
    return gpu.types.GPUTexture((8, 8), format=texel_format, **layers)


def resources_of(info):
    """Kinds and names that a shader was declared with, and what to give it or a GLSL type."""
    textures = {}
    for kind, name in info.samplers:
        textures[name] = make_texture(kind, "R32UI" if kind.startswith("UINT") else "RGBA32F")
    for texel_format, kind, name, _ in info.images:
        textures[name] = make_texture(kind, texel_format)
    constants = {name: kind for kind, name, *_ in info.push_constants}
    blocks = {name: uniform_buffer(bytes(1 << 14)) for _, name in info.uniforms}
    found = [("block", name) for name in blocks]
    found += [("sampler", name) for _, name in info.samplers]
    found += [("image", image[2]) for image in info.images]
    found += [("constant", name) for name in constants]
    return found, (textures | blocks | constants).__getitem__


def try_every_shader():
    """Compile every variant, give it all that it declares, and draw where it fits a square.

    Returns
    -------
    tried : int
    failures : list of str
    """
    failures = []
    infos = every_info()
    batch = geometry.fullscreen_batch()
    with Targets(8, 8, [TargetSpec("color", "RGBA32F")]) as targets:
        for info, label in infos.items():
            try:
                shader = compile_shader(info)
                names, texture_of = resources_of(info)
                shader.bind()
                for kind, name in names:
                    give(shader, kind, name, texture_of)
                shader.check_given()
                if info.compute:
                    dispatch(shader, 1, 1)
                elif len(info.outputs) == 1 and info.attributes == (("VEC2", "pos"),):
                    with targets.framebuffer("color").bind():
                        shader.draw(batch)
            except Exception as error:
                failures.append(f"{label}: {error}")
    return len(infos), failures
