"""Drawing the surfaces of a scene for one lens sample (methods 1).

One shader a shape of node tree and set of mesh attributes; draws are sorted by shader, then by
material, so that a frame changes state as rarely as it can.
"""

import itertools
import math
from dataclasses import replace

from ...device import shader_source, state
from ...device.geometry import attribute_identifier, attribute_type
from ...device.shaders import ShaderInfo, compile_shader
from ...device.uniform_block import UniformStruct
from ...device.uniforms import bind_resource
from ..nodes import surface_code
from . import environment
from .draw import Draw
from .surface_target import COLOR, whole

# Samplers of a lit surface: the light table, the world's image and its prefiltered levels, and the
# reflectance table of GGX lobes.
LIGHTING_TEXTURES = (
    "lights_tx",
    "environment_tx",
    "environment_levels_tx",
    "ggx_tx",
)
# The same with shadows: the atlas of light maps, and which light samples a drawing is lit by.
SHADOW_TEXTURES = ("light_maps_tx", "lit_by_tx")
# How far a coarser level of detail may be from the true surface, in the mesh's units.
SHADOW_CONSTANTS = (("FLOAT", "slack"),)
# What glass reads: the picture and depth of what is behind it, its backs, and a probe of the scene.
GLASS_TEXTURES = ("behind_tx", "behind_depth_tx", "exits_tx", "probe_tx", "probe_depth_tx")

VIEW_PARAMS = UniformStruct("shared/view_params.glsl", "ViewParams")
HIGHLIGHT_PARAMS = UniformStruct("shared/highlight_params.glsl", "HighlightParams")
GLASS_PARAMS = UniformStruct("shared/glass_params.glsl", "GlassParams")

GLASS_LIBRARIES = ("lib/lens_lib.glsl", "lib/depth_lib.glsl", "lib/surface/probe_lib.glsl")
LENS_LIBRARIES = (
    ("CHROMATIC", "lib/chromatic_lib.glsl"),
    ("REAL_LENS", "lib/real_lens_lib.glsl"),
)
_LIBRARIES = (
    "lib/hash_lib.glsl",
    "lib/surface/color_lib.glsl",
    "lib/surface/texture_lib.glsl",
    "lib/surface/vector_lib.glsl",
    "passes/surface/surface_lighting.glsl",
)


def surface_info(target, code, mesh_attributes, holdout=False, deforms=False, part=None):
    """Return the declarations and sources of the shader of a surface on a mesh.

    Parameters
    ----------
    target : SurfaceTarget
    code : SurfaceCode
    mesh_attributes : dict of str to ndarray
    holdout : bool
    deforms : bool
        The mesh has positions in the neighbouring frames.
    part : {None, 'GLOW', 'FILTER'}
        Only the light that the surface adds, or the colour that it filters light with.

    Returns
    -------
    ShaderInfo
    """
    if holdout or part == "FILTER":
        # No light to split.
        target = whole(target)
    attributes = [("VEC3", "pos")]
    varyings = [("VEC3", "world_position"), ("FLAT INT", "instance_row"), *target.varyings]
    forward = []
    transparent = code.transparent and not holdout
    shades = not holdout and (target.shades or transparent)
    own = tuple(key for key in target.attributes if key in mesh_attributes)
    defines = [*target.defines, *["HOLDOUT"] * holdout, *["TRANSPARENT"] * transparent]
    if target.shades and not holdout:
        defines += [*["SHADES"], *["LIT"] * code.lit, *code.features]
        if code.glows or part:
            defines.append(part or "GLOW_APART")
    if "HAS_VECTOR" in defines and deforms:
        defines.append("HAS_DEFORMATION")
        attributes += [("VEC3", "pos_previous"), ("VEC3", "pos_next")]
    defines = dict.fromkeys(defines, "1") | dict(target.values)
    for key in dict.fromkeys((code.attributes if shades else ()) + own):
        name = attribute_identifier(key)
        kind = attribute_type(mesh_attributes[key].shape[1])
        attributes.append((kind, name))
        if key == "normal":
            varyings.append(("VEC3", "world_normal"))
            defines |= {"HAS_NORMAL": "1", "ATTRIBUTE_NORMAL": name}
        varyings.append((kind, f"v_{name}"))
        forward.append(f"  v_{name} = {name};")
    if shades and code.reads_place:
        varyings.append(("VEC3", "v_object_position"))
        forward.append("  v_object_position = pos;")
    vertex = "void forward_attributes()\n{\n" + "\n".join(forward) + "\n}\n"
    vertex = shader_source.join((shader_source.Text(vertex), target.vertex))
    libraries_of_parts = []
    if target.splits and target.shades and not holdout:
        # Lighting asks whether light may be splatted.
        libraries_of_parts += ["lib/lens_lib.glsl", "lib/bokeh/highlight_lib.glsl"]
    structs, uniforms = target.structs, [*target.uniforms]
    samplers = [("FLOAT_2D", "instances_tx"), *target.samplers]
    push_constants = [("INT", "instance_base"), *target.push_constants]
    if target.seen:
        structs = VIEW_PARAMS.source + structs
        uniforms.insert(0, ("ViewParams", "view_buf"))
        push_constants += [("VEC4", "lens_sample"), ("INT", "sample_index")]
        defines["SEEN"] = "1"
    generated = ""
    if shades:
        generated = code.source
        structs += f"struct MaterialParams {{ vec4 constants[{len(code.constants)}]; }};\n"
        uniforms.append(("MaterialParams", "material_buf"))
        samplers += [("FLOAT_2D", f"image_{i}_tx") for i in range(len(code.images))]
    if target.splits and shades:
        structs += HIGHLIGHT_PARAMS.source
        uniforms.append(("HighlightParams", "highlight_buf"))
        samplers.append(("FLOAT_2D", "surroundings_tx"))
        defines |= {"MIRRORING": "1"} if code.mirrors else {}
        if code.reflects:
            defines["REFLECTING"] = "1"
            samplers.append(("UINT_2D", "candidates_tx"))
    if "LIT" in defines:
        structs += environment.ENVIRONMENT_PARAMS.source
        uniforms.append(("EnvironmentParams", "environment_buf"))
        samplers += [("FLOAT_2D", name) for name in LIGHTING_TEXTURES]
        if "SHADOWS" in defines:
            samplers += [("FLOAT_2D", name) for name in SHADOW_TEXTURES]
            push_constants += SHADOW_CONSTANTS
    if code.refracts and target.refracts and not (holdout or part):
        defines["REFRACTS"] = "1"
        libraries_of_parts += GLASS_LIBRARIES
        libraries_of_parts += [path for name, path in LENS_LIBRARIES if name in defines]
        structs += GLASS_PARAMS.source
        uniforms.append(("GlassParams", "glass_buf"))
        samplers += [("FLOAT_2D", name) for name in GLASS_TEXTURES]
    if target.names_material and not holdout:
        push_constants.append(("FLOAT", "material_id"))
    libraries = (*libraries_of_parts, *_LIBRARIES, *(code.libraries if shades else ()))
    fragment = shader_source.join((*libraries, shader_source.Text(generated), target.fragment))
    return ShaderInfo(
        name="aplanat_surface",
        vertex=vertex,
        fragment=fragment,
        typedefs=structs,
        attributes=tuple(attributes),
        varyings=tuple(varyings),
        outputs=target.outputs,
        samplers=tuple(samplers),
        images=target.images,
        uniforms=tuple(uniforms),
        push_constants=tuple(push_constants),
        defines=tuple(defines.items()),
    )


def build_draws(content, buffers, target=COLOR, wanted=None):
    """List the draw calls of a scene, sorted by shader and material.

    Parameters
    ----------
    content : SceneContent
    buffers : engine.drawing.scene_buffers.SceneBuffers
    target : SurfaceTarget
    wanted : set of (int, int) or None
        Group and slot of the surfaces to list; None lists all.

    Returns
    -------
    list of Draw
        At every level of detail that the device has of a mesh.
    """
    return _list_draws(content, buffers, target, wanted=wanted)


def build_veils(content, buffers, target=COLOR):
    """List the draw calls of `draw_veils`: what surfaces do to the picture of what is behind them.

    Returns
    -------
    list of Draw
        Those of the part ``'FILTER'`` multiply it by a colour, those of ``'GLOW'`` add light to it.
    """
    parts = ("FILTER", "GLOW")
    return [d for part in parts for d in _list_draws(content, buffers, target, part)]


def _list_draws(content, buffers, target, part=None, wanted=None):
    draws = []
    kinds, made = {}, {}
    # Where two surfaces lie at one depth, the first one drawn is seen: the order must be that of
    # the content, whenever its parts were read.
    materials, meshes = (
        {uid: place for place, uid in enumerate(part)}
        for part in (content.materials, content.meshes)
    )
    for number, level, group, buffer in _levels_of_groups(content, buffers):
        mesh = content.meshes[group.mesh]
        for slot, (batch, count) in buffer.batches.items():
            if wanted is not None and (number, slot) not in wanted:
                continue
            material = content.materials[group.materials[slot]]
            # Many groups, and all levels of one, are drawn alike.
            widths = tuple((key, values.shape[1]) for key, values in mesh.attributes.items())
            split = material.highlights and (number, slot) not in target.unsplit
            alike = (material.uid, widths, group.holdout, mesh.motion is not None, split)
            if alike not in made:
                code, shader, kind = _code_and_shader(
                    material, mesh, group.holdout, target, part, split
                )
                # What is split must not change the order either.
                made[alike] = code, shader, kinds.setdefault(kind, len(kinds))
            code, shader, order = made[alike]
            if shader is None:
                continue
            constants, textures = None, ()
            transparent = code.transparent and not group.holdout
            shaded = target.shades and not group.holdout
            if shaded or transparent:
                constants = buffers.material_constants(material.uid, code)
                textures = tuple(
                    (f"image_{i}_tx", buffers.images[uid]) for i, uid in enumerate(code.images)
                )
            draw = Draw(
                shader,
                batch,
                count,
                group.first,
                group.count,
                constants,
                textures,
                # The data passes decide by a threshold, not by chance.
                transparent=transparent and shaded and not part,
                lighting=buffers.lighting if shaded and code.lit else (),
                material_id=(
                    material.cryptomatte_id if target.names_material and not group.holdout else None
                ),
                group=number,
                level=level,
                slot=slot,
                slack=_slack(buffers, mesh, level),
                part=part,
                refracts=code.refracts and target.refracts and not (group.holdout or part),
            )
            place = (order, materials[material.uid], meshes[group.mesh], slot, level)
            draws.append((place, draw))
    draws.sort(key=lambda item: item[0])
    return [draw for _, draw in draws]


def _slack(buffers, mesh, level):
    """Return how far a level of detail may be from the true surface: about an edge's length."""
    if not level:
        return 0.0
    return math.sqrt(buffers.level_meshes(mesh)[level].triangle_area)


def _code_and_shader(material, mesh, holdout, target, part, split):
    """Return a surface's code, its shader or None where it is not drawn, and the kind of shader.

    The kind is that of the target, the same whether and how the surface's own light is split.
    """
    code = surface_code.generate(material.graph, mesh.attributes, target.straight)
    has_part = {None: True, "GLOW": code.glows, "FILTER": code.filters}
    if not has_part[part] or (part and holdout):
        return code, None, None
    how = (mesh.attributes, holdout, mesh.motion is not None, part)
    kind = surface_info(target, replace(code, mirrors=False, reflects=False), *how)
    shader = compile_shader(surface_info(target if split else whole(target), code, *how))
    return code, shader, kind


def _levels_of_groups(content, buffers):
    for number, group in enumerate(content.groups):
        for level, buffer in enumerate(buffers.mesh_levels(group.mesh)):
            yield number, level, group, buffer


def draw_veils(draws, *given, **resources):
    """Filter what the frame buffer shows by the colours of surfaces, and add their light to it.

    Opacity is decided by a random number per sample. A surface that was seen through filters what
    the sample shows. Its light is added wherever no surface of the sample is in front, so that its
    mean is exact even where the surface is fully transparent.

    Parameters
    ----------
    draws : list of Draw
        Of `build_veils`, in the order in which they are drawn: those behind others first, where
        some filter and some glow. The same depth buffer as `draw_sample`'s must be bound.
    *given, **resources
        As for `draw_sample`.
    """
    states = {"FILTER": state.filter_light, "GLOW": state.glow}
    for part, run in itertools.groupby(draws, key=lambda draw: draw.part):
        states[part]()
        draw_sample(list(run), *given, **resources)


def draw_sample(
    draws,
    view_buffer,
    instances,
    lens_sample,
    sample_index,
    bindings=(),
    highlights=None,
    optics=None,
    lights=None,
):
    """Draw one lens sample into the bound frame buffer.

    Parameters
    ----------
    draws : list of Draw
    view_buffer : GPUUniformBuf
        `ViewParams`.
    instances : GPUTexture
        The instance table.
    lens_sample : sequence of 4 float
        Place on the lens in m, jitter in clip units.
    sample_index : int
    bindings : iterable of (str, GPUUniformBuf, GPUTexture, int or tuple of float)
        Of the target's own uniform blocks, samplers, images, whole numbers and vectors.
    highlights : bokeh.split_light.SplitLight or None
        For a target that splits light.
    optics : chromatic.ChromaticSample, real_lens.LensSample or real_lens.SampleOptics, optional
        Of a target `in_wavelengths`, `through_lens`, or both.
    lights : light_map.Lighting or None
        For a target that shades.
    """
    current = None
    for draw in draws:
        shader = draw.shader
        if shader is not current:
            current = shader
            shader.bind()
            shader.uniform_block("view_buf", view_buffer)
            shader.uniform_sampler("instances_tx", instances)
            shader.uniform_float("lens_sample", lens_sample)
            shader.uniform_int("sample_index", sample_index)
            for name, resource in (*draw.lighting, *bindings):
                bind_resource(shader, name, resource)
            if shader.declares("highlight_buf"):
                highlights.bind(shader)
            if optics is not None:
                optics.bind(shader)
            if shader.declares("lights_tx"):
                lights.bind(shader)
        if draw.material_id is not None:
            shader.uniform_float("material_id", draw.material_id)
        if draw.constants is not None:
            shader.uniform_block("material_buf", draw.constants)
        for name, texture in draw.textures:
            shader.uniform_sampler(name, texture)
        if shader.declares("slack"):
            shader.uniform_float("slack", draw.slack)
        shader.uniform_int("instance_base", draw.first)
        shader.draw_instanced(draw.batch, draw.count)
