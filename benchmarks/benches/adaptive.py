"""`aplanat bench --method adaptive`: how much sooner the adaptive method is as good.

The truth is the reference method with many samples (512), of the same scene and process. Beside
the adaptive picture, plain accumulation is looked at on its way: from its structural similarity
at growing numbers of samples follows at which number it is as good as the adaptive picture, and the
times of the two are compared. Plain accumulation is the reference method with the raster that it
chooses, and once more with one place a pixel.

The first samples of accumulation are also the first of the truth, which makes them look better than
others of their number would: what is found is unfair to the adaptive method, if to either.
"""

import math
import os

import numpy as np

from addon.cli.render import statistics
from addon.cli.words.json_file import write_json
from addon.device.context import ensure_context
from addon.files.whole_file import check_writable, removed_on_signals
from addon.scene.camera.camera import CameraSources

from ..referees.picture_metrics import compare, read_picture
from .curve import Curve, samples_to_reach
from .focus_pull import focus_pull, focus_pull_line
from .frames import BenchScene
from .peers import peers, peers_lines
from .scenes import check_folder, find_cases, open_scene, save_picture

_RESOLUTION = (1024, 576)
_TRUTH = 512
# Samples and subsamples of the adaptive method, the balanced setting of the paper.
SAMPLES, SUBSAMPLES = 32, 4
# Samples at which accumulation is looked at.
_MARKS = (8, 16, 32, 48, 64, 96, 128, 192, 256, 384)
# The two take turns in short rounds, and the middle one of their ratios counts: other work of the
# machine then touches both alike.
_ROUNDS = 5


def bench_adaptive(arguments, console):
    """Carry out `bench --method adaptive`; parameters and result as `reference_method.bench`."""
    with removed_on_signals():
        if arguments.output:
            check_writable(arguments.output)
        check_folder(arguments.pictures)
        measured = _measurement(arguments)
        cases = find_cases(arguments, console, default_samples=_TRUTH)
        runs = []
        for case in cases:
            runs.append(measured(case, arguments, console))
            if arguments.output:
                # What is measured is kept if a later scene fails.
                write_json(arguments.output, _answer(runs))
    return _answer(runs)


def _measurement(arguments):
    if arguments.focus_pull:
        return _run_focus_pull
    return _run_peers if arguments.peers else _run


def _answer(runs):
    return {"command": "bench", "method": "adaptive", **statistics.machine(), "runs": runs}


def _run_focus_pull(case, arguments, console):
    scene = open_scene(case, arguments.resolution or (480, 270))
    found = focus_pull(scene, case, (SAMPLES, SUBSAMPLES), arguments, console)
    console.say(focus_pull_line(found))
    return found


def _run_peers(case, arguments, console):
    scene = open_scene(case, arguments.resolution or (480, 270))
    found = peers(scene, case, arguments, console)
    for line in peers_lines(found):
        console.say(line)
    return found


def _run(case, arguments, console):
    scene = open_scene(case, arguments.resolution or _RESOLUTION)
    ensure_context()
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None

    def progress(text):
        return lambda done: console.progress(f"{case.name}, {text}: sample {done}")

    bench = BenchScene(scene)
    try:
        adaptive = bench.sampled("ADAPTIVE", SAMPLES, subsamples=SUBSAMPLES)
        reference = bench.sampled("REFERENCE", case.samples)
        # As the reference, but with one place a pixel.
        single = bench.sampled(
            "ADAPTIVE", case.samples, subsamples=0, uses_levels=False, reuse_grid=0
        )
        console.progress(f"{case.name}: levels of detail")
        levels = bench.make_levels(adaptive)
        # The first time also compiles.
        drawn = [bench.draw(adaptive) for _ in range(2)][1]
        marks = [mark for mark in _MARKS if mark < case.samples]
        pictures = bench.draw_to_marks(reference, [*marks, case.samples], progress("reference"))
        if arguments.reference:
            truth = read_picture(arguments.reference)[::-1]
        else:
            pictures = list(pictures)
            truth = pictures.pop()[2].astype(np.float64)
        compared = compare(drawn.picture, truth)
        wanted = compared["ssim_srgb"]
        curves = {"reference": _curve(pictures, truth, wanted)}
        pictures = bench.draw_to_marks(single, marks, progress("one place a pixel"))
        curves["one_place_a_pixel"] = _curve(pictures, truth, wanted)
        plain = {
            name: _against(bench, adaptive, snapshot, curves[name], wanted)
            for name, snapshot in (("reference", reference), ("one_place_a_pixel", single))
        }
        found = {
            "scene": case.name,
            "settings": statistics.settings_in_force(scene, CameraSources()),
            "load_average": load,
            "samples": SAMPLES,
            "subsamples": SUBSAMPLES,
            "truth": {"samples": case.samples, "file": _text(arguments.reference)},
            "compared": compared,
            "work": drawn.work,
            "triangles_share": drawn.work["triangles_submitted"]
            / max(drawn.work["triangles_full_detail"], 1),
            "seconds": {
                **bench.seconds,
                **{f"levels_{stage}": s for stage, s in levels.items() if stage != "meshes"},
                **drawn.stages,
                "frame": drawn.seconds,
            },
            "meshes_with_levels": levels["meshes"],
            "seconds_by_stage": bench.stages(adaptive),
            "accumulation": plain,
        }
    finally:
        bench.close()
    if arguments.pictures:
        for name, picture in (("adaptive", drawn.picture), ("truth", truth)):
            path = arguments.pictures / f"{case.stem}_{name}.exr"
            save_picture(path, picture[::-1])
    console.say(_line(found))
    return found


def _text(path):
    return str(path) if path else None


def _curve(pictures, truth, stop):
    """Compare pictures on the way until one reaches the structural similarity of interest."""
    samples, seconds, ssim = [], [], []
    for mark, spent, picture in pictures:
        samples.append(mark)
        seconds.append(spent)
        ssim.append(compare(picture, truth)["ssim_srgb"])
        if ssim[-1] >= stop:
            break
    return Curve(tuple(samples), tuple(seconds), tuple(ssim))


def _against(bench, adaptive, plain, curve, ssim):
    """Time the adaptive frame and accumulation in turns."""
    samples, reached = samples_to_reach(curve, ssim)
    one = curve.seconds[-1] / curve.samples[-1]
    ratios, frames, each = [], [], []
    for _ in range(_ROUNDS):
        frames.append(bench.draw(adaptive).seconds)
        # About as long as the adaptive frame, so that both meet the same moments.
        part = max(4, min(round(frames[-1] / one), math.ceil(samples)))
        drawn = bench.draw(plain, part)
        each.append(drawn.stages["draw"] / part)
        rest = drawn.seconds - drawn.stages["draw"]
        ratios.append((rest + each[-1] * samples) / frames[-1])
    return {
        "subpixels": drawn.work["subpixels"],
        "curve": [
            {"samples": n, "seconds": s, "ssim_srgb": q}
            for n, s, q in zip(curve.samples, curve.seconds, curve.ssim, strict=True)
        ],
        "samples_to_equal": samples,
        "reached": reached,
        "seconds_per_sample": _middle(each),
        "seconds_to_equal": _middle(each) * samples,
        "adaptive_seconds": _middle(frames),
        "triangles_to_equal": drawn.work["triangles_submitted"] / part * samples,
        "ratios": ratios,
        "speedup": _middle(ratios),
    }


def _middle(values):
    return sorted(values)[len(values) // 2]


def _line(run):
    compared, seconds = run["compared"], run["seconds"]
    work = run["work"]
    plain, single = (run["accumulation"][k] for k in ("reference", "one_place_a_pixel"))
    return (
        f"{run['scene']}: adaptive ({run['samples']}, {run['subsamples']}) SSIM"
        f" {compared['ssim_srgb']:.4f}, worst tile {compared['ssim_tile']:.4f}, energy"
        f" {compared['energy']:.4f}; triangles {run['triangles_share']:.1%};"
        f" {work['draw_calls']} draw calls, {work['sprites_drawn']} sprites drawn and"
        f" {work['sprites_copied']} copied; levels {seconds['levels_make']:.1f} s once; frame"
        f" {plain['adaptive_seconds']:.2f} s; accumulation is as good with"
        f" {_number(plain)} samples, {plain['seconds_to_equal']:.1f} s: {plain['speedup']:.2f}"
        f" times as long; with one place a pixel {_number(single)} samples,"
        f" {single['seconds_to_equal']:.1f} s: {single['speedup']:.2f} times"
    )


def _number(plain):
    return f"{plain['samples_to_equal']:.0f}" + ("" if plain["reached"] else " or more")
