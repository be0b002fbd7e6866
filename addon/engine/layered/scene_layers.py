"""Depth layers of a scene: drawn from the middle of the lens, a slice or a peel of the scene each.

What chance makes transparent is left out: it is drawn anew for every lens sample.
"""

import numpy as np

from ...device import state
from ...device.targets import Targets, TargetSpec
from ...device.uniforms import uniform_buffer
from ...layers.cuts import OVERLAP, layer_cuts
from ...passes.layered import joining, layers
from ...passes.surface import surface
from .layer_raster import (
    DeviceLayers,
    clip_planes,
    clipped_projection,
    layer_raster,
)

# Of a depth: what lies on the outermost planes is inside.
_ROUNDING = 1e-4


def draw_scene_layers(plan, drawing, draws, instances, mattes, resources):
    """Draw a scene into depth layers.

    Parameters
    ----------
    plan : FramePlan
        With `layered`.
    drawing : SceneDrawing
        Aimed at the frame.
    draws : list of Draw
        Of what is drawn, for `passes.surface.surface_target.of_layers`.
    instances : GPUTexture
    mattes : bool
        The draws have a second target, of mattes.
    resources : dict
        ``highlights`` and ``optics`` of `passes.surface.surface.draw_sample`.

    Returns
    -------
    DeviceLayers
    """
    near, far = clip_planes(plan.projection)
    nearest, farthest = max(drawing.nearest, near), min(drawing.farthest, far)
    if not nearest < farthest:
        # Nothing is in view, or all at one depth.
        nearest = min(max(farthest, near), nearest)
        farthest = 2.0 * nearest
    nearest = max(near, nearest * (1.0 - _ROUNDING))
    farthest = min(far, farthest * (1.0 + _ROUNDING))
    count = plan.layered.count
    if plan.layered.peeled:
        planes = [(nearest, farthest)] * count
    else:
        cuts = layer_cuts(count, nearest, farthest, plan.orthographic)
        planes = [_planes(cuts, number, plan.orthographic) for number in range(count)]
    raster = layer_raster(plan, nearest, farthest)
    eyes = len(plan.layered.eyes)
    sides = (raster.width, raster.height)
    textures = Targets(*sides, layers.specs(*sides, count, mattes, eyes))
    _draw_layers(plan, raster, planes, draws, instances, textures, resources)
    if not plan.layered.peeled:
        joining.join(textures, count, eyes)
    drawing.counts.draw_calls += count * eyes * len(draws)
    drawing.counts.triangles += count * eyes * sum(d.triangles * d.count for d in draws)
    return DeviceLayers(textures, raster, filtered=False)


def _planes(cuts, number, orthographic):
    """Return the depths between which a layer is drawn, m."""
    near, far = cuts[number : number + 2]
    if number + 2 < len(cuts):
        if orthographic:
            far += OVERLAP * (far - near)
        else:
            # In equal steps of the circle of confusion, and no farther than there is anything.
            far = 1.0 / (1.0 / far - OVERLAP * (1.0 / near - 1.0 / far))
        far = min(far, cuts[-1]) if far > 0.0 else cuts[-1]
    return float(near), float(far)


def _draw_layers(plan, raster, planes, draws, instances, textures, resources):
    sides = (raster.width, raster.height)
    grown = [
        size * raster.fine / side
        for size, side in zip((plan.width, plan.height), sides, strict=True)
    ]
    projection = np.diag([*grown, 1.0, 1.0]) @ plan.projection
    mattes = "mattes" in textures
    # Peeled layers take turns with the depths: what is drawn lies behind the one before.
    depths = ("depth", "front")
    specs = [TargetSpec("color", "RGBA32F")]
    specs += [TargetSpec(name, "DEPTH_COMPONENT32F") for name in depths]
    if mattes:
        specs.append(TargetSpec("mattes", "RGBA32F"))
    slots = ("color", "mattes")[: 1 + mattes]
    origin = [
        (first - side) * raster.fine for first, side in zip(plan.origin, raster.margin, strict=True)
    ]
    lens = (plan.focus_distance, float(plan.orthographic), plan.coc_scale, plan.sharp_radius)
    with Targets(*sides, specs) as drawn:
        with drawn.framebuffer(depth="front").bind():
            drawn.framebuffer(depth="front").clear(depth=0.0)
        for number, pair in enumerate(planes):
            depth, front = depths
            clipped = clipped_projection(projection, *pair)
            view = uniform_buffer(
                surface.VIEW_PARAMS.pack(
                    view=plan.view,
                    view_inverse=np.linalg.inv(plan.view),
                    projection=clipped,
                    lens=lens,
                    film=(*sides, *origin),
                )
            )
            for turn, eye in enumerate(plan.layered.eyes):
                for name in slots:
                    drawn.clear(name, (0.0, 0.0, 0.0, 0.0))
                framebuffer = drawn.framebuffer(*slots, depth=depth)
                bindings = (("front_tx", drawn[front]), ("eye", tuple(eye.tolist())))
                with framebuffer.bind():
                    framebuffer.clear(depth=1.0)
                    state.opaque()
                    surface.draw_sample(
                        draws, view, instances, (0.0,) * 4, 0, bindings, **resources
                    )
                color_layer = turn * len(planes) + number
                seen = {name: drawn[name] for name in slots} | {"depth": drawn[depth]}
                layers.pack(seen, number, textures, clipped, plan.projection, color_layer)
            if plan.layered.peeled:
                depths = (front, depth)
