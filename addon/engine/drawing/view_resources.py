"""Uniform blocks of a frame's view and chromatic aberration."""

import numpy as np

from ...passes.surface import chromatic, surface
from ...sampling.chromatic import LEAST_SCALE


def chromatic_resources(plan):
    """Upload a `ChromaticPlan`; see `passes.surface.chromatic.resources`."""
    strengths = plan.lateral_strengths
    return chromatic.resources(
        table=plan.table,
        radius=plan.radius,
        parallel=plan.parallel,
        focus=(plan.inverse_focus, 1.0 / plan.focal_length, 0.0, LEAST_SCALE),
        raster=plan.raster,
        extremes=(plan.focal_errors.min(), plan.focal_errors.max(), np.abs(strengths).max()),
        typical=plan.typical_errors,
    )


def view_params(plan):
    """Return the `ViewParams` of a `FramePlan`, packed."""
    return surface.VIEW_PARAMS.pack(
        view=plan.view,
        view_inverse=np.linalg.inv(plan.view),
        projection=plan.projection,
        lens=(plan.focus_distance, float(plan.orthographic), plan.coc_scale, plan.sharp_radius),
        film=(plan.width * plan.subpixels, plan.height * plan.subpixels, *plan.origin),
    )
