"""Adding a drawn lens sample to the sums of a frame: colours, Focus Matte, Cryptomattes."""

import numpy as np

from ...passes import accumulate, cryptomatte


def add(batch, targets, plan, index, wavelength, blur, cryptomattes, active, light=None):
    """Add a lens sample to the sums.

    Parameters
    ----------
    batch : GPUBatch
        Covers the pixels that the sample is drawn for.
    targets : Targets
    plan : FramePlan
    index : int
        The sample.
    wavelength : passes.surface.chromatic.ChromaticSample or None
        The sample's.
    blur : SubsampleBlur or None
    cryptomattes : dict of str to int
        See `render_passes.cryptomatte_kinds`.
    active : GPUTexture or None
        Of the tiles that the sample is drawn for; see `passes.cryptomatte.count`.
    light : passes.surface.real_lens.SampleLight or None
        What the real lens lets through.

    Returns
    -------
    int
        Number of draw calls.
    """
    weights = plan.subpixel_weights[index]
    with targets.framebuffer("sum").bind():
        if blur:
            blur.add(batch, targets, index)
        else:
            tint = wavelength.tint if wavelength else None
            accumulate.accumulate(batch, targets["sample"], weights, tint, light)
    # Mattes have no subsamples: that of the sample's own place gets the weight of all.
    places = np.array([[1.0 + plan.subsample_counts[index]], [1.0]])
    if plan.chromatic:
        # As its alpha.
        places[0] *= plan.chromatic.weights[index, 3]
    if "focus_sum" in targets:
        with targets.framebuffer("focus_sum").bind():
            accumulate.accumulate_focus(batch, targets["mattes"], weights * places, light)
    if cryptomattes:
        cryptomatte.count(
            targets["mattes"], targets["tables"], cryptomattes, weights * places, active, light
        )
    return 1 + ("focus_sum" in targets)
