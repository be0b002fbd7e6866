"""What `aplanat bench --bokeh` found, one line a measure."""


def line(run):
    """Return a run as one line.

    Parameters
    ----------
    run : dict
        With its ``measure``.

    Returns
    -------
    str
    """
    text = _LINES[run["measure"]](run)
    return f"{run['scene']}: {text}" if "scene" in run else text


def _likeness(compared):
    if compared is None:
        return "no reference"
    return (
        f"SSIM {compared['ssim_srgb']:.4f}, worst tile {compared['ssim_tile']:.4f}, energy"
        f" {compared['energy']:.4f}"
    )


def _pictures(run):
    same = "is" if run["sum_is_combined"] else "is not"
    return (
        f"points ({run['samples']}, {run['subsamples']}) {_likeness(run['compared'])}; Defocus +"
        f" Bokeh {same} Combined"
    )


def _truth(run):
    return (
        f"against the reference method with {run['samples']} samples {_likeness(run['compared'])}"
        f" (its own: {_likeness(run['truth_compared'])})"
    )


def _models(run):
    seconds = run["seconds"]
    text = (
        f"clusters against points {_likeness(run['compared'])}; {run['sources_left']:.1%} of"
        f" {run['found']} sources left; visibility {seconds['POINT']['visibility']:.2f} s and"
        f" {seconds['CLUSTERED']['visibility']:.2f} s: {run['visibility_speedup']:.1f} times"
    )
    if "point_compared" in run:
        ssim = [run[f"{model}_compared"]["ssim_srgb"] for model in ("point", "clustered")]
        text += f"; against the reference SSIM {ssim[0]:.4f} and {ssim[1]:.4f}"
    return text


def _culling(run):
    shares = ", ".join(f"{name} {share:.1%}" for name, share in run["shares"].items())
    return (
        f"{run['culled']:.1%} of {run['sources']} sources culled ({shares}); the bokeh changes by"
        f" {run['largest_change']:.1e} at most, as displayed {run['largest_change_shown']:.1e}"
    )


def _visibility(run):
    told = "; ".join(
        f"{name} {_likeness(found)}, {found['psnr_db']:.1f} dB, {found['seconds']:.2f} s"
        for name, found in run["compared"].items()
    )
    return f"against projected masks: {told}"


def _time(run):
    samples, subsamples, ssim = run["tried"][-1]
    plain = run["accumulation"]
    extended = ", extended from its curve" if plain["extended"] else ""
    return (
        f"({samples}, {subsamples}) SSIM {ssim:.4f} in {run['frame_seconds']:.2f} s; plain"
        f" accumulation as good with {plain['samples_to_equal']:.0f} samples{extended}:"
        f" {run['speedup']:.1f} times as long"
    )


def _peers(run):
    each = run["engines"]
    text = f"ours {each['adaptive']['seconds']:.2f} s"
    others = [("Cycles", each["cycles"]), ("EEVEE", each["eevee"])]
    others += [("Cycles, denoised", found) for found in each["cycles_denoised"]]
    for name, found in others:
        if "missing" not in found:
            text += (
                f"; {name}, {found['samples']} samples: {found['seconds']:.2f} s,"
                f" {_likeness(found['compared'])}, {found['speedup']:.1f} times as long"
            )
    return text


def _pan(run):
    told = ", ".join(f"{name} {share:+.1%}" for name, share in run["excess"].items())
    return f"flicker of {run['frames']} frames beyond the reference's: {told}"


def _scaling(run):
    told = ", ".join(
        f"{each['lamps']} lamps {each['seconds']['bokeh']:.2f} s ({each['highlights']['found']}"
        f" highlights, {each['method']})"
        for each in run["scenes"]
    )
    return f"{told}; from 10000 to 100000: {run['growth']:.2f} times"


def _focus_pull(run):
    told = ", ".join(
        f"{frame['focus_m']:.1f} m {frame['ssim_srgb']:.4f} (mirrored {frame['ssim_mirrored']:.4f})"
        for frame in run["frames"]
    )
    return f"focus pull, SSIM against {run['samples']} samples: {told}"


def _lens(run):
    if "missing" in run:
        return f"real lenses: {run['missing']}"
    told = "; ".join(
        f"{each['lens']} f/{each['f_number']:.3g} {each['least_psnr_db']:.1f} dB (noise of Cycles"
        f" {each['least_noise_db']:.1f} dB)"
        for each in run["lenses"]
    )
    return f"lamps through real lenses against Cycles, the least alike of {run['lamps']}: {told}"


def _discs(run):
    told = "; ".join(
        f"{each['lens']} {each['least_psnr_db']:.1f} dB (noise {each['least_noise_db']:.1f} dB)"
        for each in run["lenses"]
    )
    return f"discs of lamps against lens samples, the least alike of each lens: {told}"


_LINES = {
    "pictures": _pictures,
    "truth": _truth,
    "models": _models,
    "culling": _culling,
    "visibility": _visibility,
    "time": _time,
    "peers": _peers,
    "pan": _pan,
    "scaling": _scaling,
    "focus-pull": _focus_pull,
    "lens": _lens,
    "discs": _discs,
}
