"""Depth layers of a scene: drawn from the middle of the lens, a slice of the scene each.

What chance makes transparent is left out: it is drawn anew for every lens sample.
"""

import numpy as np

from ...device import state
from ...device.targets import Targets, TargetSpec
from ...device.uniforms import uniform_buffer
from ...layers.cuts import OVERLAP, layer_cuts
from ...passes.layered import layers
from ...passes.surface import surface
from .layer_raster import (
    DeviceLayers,
    clip_planes,
    clipped_projection,
    layer_raster,
    window_depth,
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
        Of what is drawn.
    instances : GPUTexture
    mattes : bool
        The draws have a second target, of mattes.
    resources : dict
        ``highlights`` and ``wavelength`` of `passes.surface.surface.draw_sample`.

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
    cuts = layer_cuts(count, nearest, farthest, plan.orthographic)
    planes = [_planes(cuts, number, plan.orthographic) for number in range(count)]
    raster = layer_raster(plan, nearest, farthest)
    textures = Targets(
        raster.width, raster.height, layers.specs(raster.width, raster.height, count, mattes)
    )
    _draw_slices(plan, raster, planes, draws, instances, textures, resources)
    drawing.counts.draw_calls += count * len(draws)
    drawing.counts.triangles += count * sum(d.triangles * d.count for d in draws)
    bounds = np.array([[window_depth(plan, depth) for depth in pair] for pair in planes])
    return DeviceLayers(textures, raster, bounds, filtered=False)


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


def _draw_slices(plan, raster, planes, draws, instances, textures, resources):
    sides = (raster.width, raster.height)
    grown = [
        size * raster.fine / side
        for size, side in zip((plan.width, plan.height), sides, strict=True)
    ]
    projection = np.diag([*grown, 1.0, 1.0]) @ plan.projection
    mattes = "mattes" in textures
    specs = [TargetSpec("color", "RGBA32F"), TargetSpec("depth", "DEPTH_COMPONENT32F")]
    if mattes:
        specs.append(TargetSpec("mattes", "RGBA32F"))
    slots = ("color", "mattes")[: 1 + mattes]
    origin = [
        (first - side) * raster.fine for first, side in zip(plan.origin, raster.margin, strict=True)
    ]
    lens = (plan.focus_distance, float(plan.orthographic), plan.coc_scale, plan.sharp_radius)
    with Targets(*sides, specs) as drawn:
        for number, pair in enumerate(planes):
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
            for name in slots:
                drawn.clear(name, (0.0, 0.0, 0.0, 0.0))
            framebuffer = drawn.framebuffer(*slots, depth="depth")
            with framebuffer.bind():
                framebuffer.clear(depth=1.0)
                state.opaque()
                surface.draw_sample(draws, view, instances, (0.0,) * 4, 0, **resources)
            layers.pack(drawn, number, textures, clipped, plan.projection)
