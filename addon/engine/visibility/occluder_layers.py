"""Depth-peeled layers, seen by a pinhole at the lens' centre, as occluders of highlights.

Rays from highlights to the lens are cast through these layers, and N-buffers over them bound the
occluders that a cone of rays can meet.

References
----------
Decoret, *N-buffers for efficient depth map query*, EG 2005.
"""

import numpy as np

from ...device import readback
from ...device.targets import Targets, TargetSpec
from ...device.uniforms import uniform_buffer
from ...passes.bokeh import peel
from ...passes.surface import surface
from ...passes.visibility import culling, visibility_warp

# Most cells of the N-buffers over the peeled raster.
_MOST_CELLS = 1 << 18
# Most texels of the layers along a side of a pixel (coarser ones miss thin occluders), and in all.
_TEXELS_PER_PIXEL = 3
_LARGEST_RASTER = 1 << 23
_LONGEST_SIDE = 16384
_DRAFT_LAYERS = 2


def texels_per_pixel(bokeh):
    """Return how many texels the layers have along a side of a pixel.

    Parameters
    ----------
    bokeh : BokehPlan

    Returns
    -------
    int
    """
    if bokeh.draft:
        return 1
    affordable = int(np.sqrt(_LARGEST_RASTER / (bokeh.width * bokeh.height)))
    longest = _LONGEST_SIDE // max(bokeh.width, bokeh.height)
    return max(1, min(_TEXELS_PER_PIXEL, affordable, longest))


def number_of(bokeh):
    """Return how many layers are drawn."""
    return _DRAFT_LAYERS if bokeh.draft else visibility_warp.MOST_LAYERS


def draw_layers(plan, drawing, instances, fine):
    """Draw the layers.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.
    drawing : SceneDrawing
        Aimed at the frame.
    instances : GPUTexture
        The instance table.
    fine : int
        Texels along a side of a pixel.

    Returns
    -------
    Targets
        ``layers`` and ``opacity``, see `passes.visibility.visibility_warp.pack`.
    """
    size = (plan.bokeh.width * fine, plan.bokeh.height * fine)
    raster = Targets(*size, [TargetSpec("layers", "RGBA32F"), TargetSpec("opacity", "RGBA8")])
    view = uniform_buffer(
        surface.VIEW_PARAMS.pack(
            view=plan.view,
            view_inverse=np.linalg.inv(plan.view),
            projection=plan.bokeh.projection,
            lens=(plan.focus_distance, float(plan.orthographic), plan.coc_scale, plan.sharp_radius),
            film=(*size, 0.0, 0.0),
        )
    )
    draws = drawing.full_detail_draws(peel.OCCLUDERS)
    number = number_of(plan.bokeh)
    specs = [TargetSpec("color", "RGBA8")]
    specs += [TargetSpec(name, "DEPTH_COMPONENT32F") for name in ("depth", "front")]
    with Targets(*size, specs) as layers:
        depth, front = "depth", "front"
        nothing = layers.framebuffer("color", depth=front)
        with nothing.bind():
            nothing.clear(depth=0.0)
        for channel in range(number):
            framebuffer = layers.framebuffer("color", depth=depth)
            with framebuffer.bind():
                framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0), depth=1.0)
                peel.draw_layer(draws, view, instances, [layers[front]])
            visibility_warp.pack(
                layers["color"], layers[depth], channel, raster["layers"], raster["opacity"]
            )
            depth, front = front, depth
        # The layers may be released only after the device has read them.
        readback.wait(layers.framebuffer("color", depth=front))
    drawing.counts.draw_calls += number * len(draws)
    drawing.counts.triangles += number * sum(d.triangles * d.count for d in draws)
    return raster


def cull_by_layers(sources, count, parameters, raster, again, states):
    """Cull sources by the layers: hidden, visible, or in need of a mask.

    Parameters
    ----------
    sources, count, parameters, again, states
        As for `passes.visibility.culling.cull`.
    raster : Targets
        Of `draw_layers`.

    Returns
    -------
    Targets
        To be released when the device has read it.
    """
    layers = raster["layers"]
    cell = 1
    while -(-layers.width // cell) * -(-layers.height // cell) > _MOST_CELLS:
        cell += 1
    cells = (-(-layers.width // cell), -(-layers.height // cell))
    levels = max(cells).bit_length()
    stack = Targets(*cells, [TargetSpec("bounds", "RGBA32F", levels)])
    culling.build_bounds(layers, raster["opacity"], stack["bounds"], levels, cell)
    culling.cull(sources, count, parameters, layers, stack["bounds"], cell, again, states)
    return stack
