"""Drawing the surfaces of a scene for one lens sample (methods 1).

One shader a shape of node tree and set of mesh attributes; draws are sorted by shader, then by
material, so that a frame changes state as rarely as it can.
"""

import itertools
import math
from dataclasses import replace

from ...device import state
from ...device.shaders import compile_shader
from ...device.uniforms import bind_resource
from ..nodes import surface_code
from . import deferred
from .draw import Draw
from .surface_shader import GLASS_PARAMS, HIGHLIGHT_PARAMS, VIEW_PARAMS, surface_info
from .surface_target import COLOR, whole

__all__ = (
    "GLASS_PARAMS",
    "HIGHLIGHT_PARAMS",
    "VIEW_PARAMS",
    "build_draws",
    "build_veils",
    "draw_sample",
    "draw_veils",
    "surface_info",
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
                whether = target if split else whole(target)
                code, kind = _code_and_kind(material, mesh, group.holdout, target, part)
                shader = once = None
                if kind is not None:
                    once = _shaded_once(made, code, mesh, group.holdout, whether)
                    how = (code, mesh.attributes, group.holdout, mesh.motion is not None, part)
                    shader = compile_shader(once[0] if once else surface_info(whether, *how))
                # What is split must not change the order either.
                order = kinds.setdefault(kind, len(kinds))
                made[alike] = code, shader, order, once and once[1]
            code, shader, order, once = made[alike]
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
                deferred=once,
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


def _code_and_kind(material, mesh, holdout, target, part):
    """Return a surface's code, and the kind of its shader, None where it is not drawn.

    The kind is that of the target, the same whether and how the surface's own light is split.
    """
    code = surface_code.generate(material.graph, mesh.attributes, target.straight)
    has_part = {None: True, "GLOW": code.glows, "FILTER": code.filters}
    if not has_part[part] or (part and holdout):
        return code, None
    how = (mesh.attributes, holdout, mesh.motion is not None, part)
    return code, surface_info(target, replace(code, mirrors=False, reflects=False), *how)


def _shaded_once(made, code, mesh, holdout, target):
    """Return what shades a surface once a pixel, and its `Deferred`; None if that is not done."""
    number = 1 + sum(once is not None for *_, once in made.values())
    if holdout or number > deferred.MOST_MATERIALS:
        return None
    found = deferred.infos(target, code, mesh.attributes, mesh.motion is not None)
    if found is None:
        return None
    places, shading, count = found
    return shading, deferred.Deferred(compile_shader(places), number, count)


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
    canvas=None,
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
    highlights : GPUUniformBuf or None
        `HighlightParams`, for a target that splits light.
    optics : chromatic.ChromaticSample, real_lens.LensSample or real_lens.SampleOptics, optional
        Of a target `in_wavelengths`, `through_lens`, or both.
    lights : light_map.Lighting or None
        For a target that shades.
    canvas : deferred.Canvas, optional
        What the bound frame buffer is made of, with nothing in it yet; for a deferred target.
    """

    def bind(shader, draw):
        shader.bind()
        shader.uniform_block("view_buf", view_buffer)
        shader.uniform_sampler("instances_tx", instances)
        shader.uniform_float("lens_sample", lens_sample)
        shader.uniform_int("sample_index", sample_index)
        for name, resource in (*draw.lighting, *bindings):
            bind_resource(shader, name, resource)
        if shader.declares("highlight_buf"):
            shader.uniform_block("highlight_buf", highlights)
        if optics is not None:
            optics.bind(shader)
        if shader.declares("lights_tx"):
            lights.bind(shader)

    if shaded_once := [draw for draw in draws if draw.deferred]:
        # First of all: what is drawn after them may hide them.
        deferred.draw(shaded_once, canvas, bind, _give_material)
        state.opaque()
    current = None
    for draw in draws:
        if draw.deferred:
            continue
        shader = draw.shader
        if shader is not current:
            current = shader
            bind(shader, draw)
        _give_material(shader, draw)
        if shader.declares("slack"):
            shader.uniform_float("slack", draw.slack)
        shader.uniform_int("instance_base", draw.first)
        shader.draw_instanced(draw.batch, draw.count)


def _give_material(shader, draw):
    if draw.material_id is not None:
        shader.uniform_float("material_id", draw.material_id)
    if draw.constants is not None:
        shader.uniform_block("material_buf", draw.constants)
    for name, texture in draw.textures:
        shader.uniform_sampler(name, texture)
