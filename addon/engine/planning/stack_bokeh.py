"""The plan of the bokeh of a captured picture: highlights are pixels of its layers."""

import numpy as np

from ...levels.choosing import coc_radius
from ...sampling.highlights import highlight_share
from .bokeh_colors import colors_of_frame
from .bokeh_plan import (
    INFINITY,
    BokehPlan,
    contrast_of,
    filter_width,
    least_splatted,
    shaping_artist,
    shaping_cylinders,
    shaping_lens,
)


def plan_stack_bokeh(snapshot, plan):
    """Plan the highlights of a captured picture.

    They are searched in all that the layers have, whatever overscan is asked for.

    Parameters
    ----------
    snapshot : SceneSnapshot
        With a `stack`.
    plan : FramePlan
        With `layered`.

    Returns
    -------
    BokehPlan or None
        None where nothing is splatted: bokeh is off, or everything is sharp.
    """
    camera, film, stack = snapshot.camera, snapshot.film, snapshot.stack
    if camera.bokeh is None or camera.lens is None or plan.coc_scale == 0.0:
        return None
    least = least_splatted(plan)
    colors = colors_of_frame(camera.chromatic, plan, max(stack.depth_range))
    if _largest_coc(plan, stack, colors) <= least:
        return None
    # With a parallel projection, all pixels show the same point at infinity: no highlight.
    world = camera.bokeh.world and not plan.orthographic
    height, width = stack.layers[0].depth.shape
    grown = np.diag([stack.width / width, stack.height / height, 1.0, 1.0])
    # Of the layers, which do not move with what distortion has drawn of them.
    projection = np.array(plan.projection)
    projection[:2] = np.array(stack.camera.projection)[:2]
    return BokehPlan(
        settings=camera.bokeh,
        shining=frozenset(),
        mirroring=frozenset(),
        uneven=frozenset(),
        unsplit=frozenset(),
        least_coc=least,
        width=width,
        height=height,
        margin=plan.layered.origin,
        projection=grown @ projection,
        subpixels=1,
        small_mirrors=1,
        part=(0, 0, width, height),
        world=world,
        world_share=float(highlight_share(plan.empty_coc, least)) if world else 0.0,
        world_depth=INFINITY * max(plan.focus_distance, 1.0),
        iris=camera.lens.iris,
        real_lens=shaping_lens(camera),
        cylinders=shaping_cylinders(plan),
        contrast=contrast_of(camera.bokeh, plan),
        filter_width=filter_width(film.filter_kind, film.filter_size_px),
        colors=colors,
        artist=shaping_artist(camera),
    )


def _largest_coc(plan, stack, colors):
    changes = (0.0,) if colors is None else colors.focus_changes[:2]
    cocs = [(coc_radius(np.float64(depth), plan), depth) for depth in stack.depth_range]
    if not plan.orthographic:
        cocs.append((plan.empty_coc, 1.0))
    return max(
        abs(float(coc) + plan.coc_scale * change * (depth if plan.orthographic else 1.0))
        for coc, depth in cocs
        for change in changes
    )
