"""The targets on the device that a frame of one plan needs."""

from ...device.targets import TargetSpec
from ...passes import cryptomatte
from ...snapshot.render_passes import cryptomatte_kinds, made_by
from .frame_pictures import FramePictures


def needs_mattes(plan):
    """Whether objects also draw ids and the focus matte with each sample."""
    return bool(made_by(plan.passes, "MATTE", "CRYPTOMATTE"))


def target_specs(plan):
    """Return the targets of the samples, their sums and the passes.

    Those of the drawing, of subsample blur, of tiles and of layers come from these.

    Parameters
    ----------
    plan : FramePlan

    Returns
    -------
    list of TargetSpec
    """
    fine = plan.subpixels
    specs = [
        TargetSpec("sample", "RGBA32F", scale=fine),
        TargetSpec("sample_depth", "DEPTH_COMPONENT32F", scale=fine),
        TargetSpec("sum", "RGBA32F"),
        *FramePictures.target_specs(plan),
    ]
    if plan.bokeh:
        specs.append(TargetSpec("bokeh", "RGBA32F"))
    if needs_mattes(plan):
        specs.append(TargetSpec("mattes", "RGBA32F", scale=fine))
    if "Focus Matte" in plan.passes:
        specs.append(TargetSpec("focus_sum", "R32F"))
    if kinds := cryptomatte_kinds(plan.passes):
        layers = len(kinds) * cryptomatte.slot_pairs(kinds)
        specs.append(TargetSpec("tables", "RGBA32F", layers))
    return specs
