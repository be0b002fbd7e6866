"""`aplanat bench --bokeh`: highlights against references, sampled highlights and one another.

Of each scene:

- ``pictures``: the point model against the scene's reference picture; Defocus + Bokeh = Combined.
- ``truth``: the same against the reference method with `--samples` lens samples (16384).
- ``models``: clustered against point sources: similarity, sources left, time of the visibility.
- ``culling``: shares of highlights that each test sorts out, and the picture without the tests.
- ``visibility``: masks by rays through layers against masks by projection.
- ``time``: the least setting that reaches a similarity of 0.985, against plain accumulation; where
  that takes too long its curve is extended (1 - SSIM falls as a power of the number of samples).
- ``peers``: the same against Cycles, Cycles with OpenImageDenoise, and EEVEE.
- ``pan``: flicker of the bokeh in a slow pan.

Of built scenes:

- ``scaling``: 1000, 10000 and 100000 small lamps.
- ``focus-pull``: the focus moves past a half-hidden lamp and what hides it.
- ``lens``: lamps through real lenses, against Cycles tracing them (`benchmarks.bokeh.lens`).
- ``discs``: the same lamps' discs against lens samples (`benchmarks.bokeh.discs`).
"""

import math
import os
from statistics import median

import numpy as np

from addon.cli.render import statistics
from addon.cli.words.json_file import write_json
from addon.device.context import ensure_context
from addon.files.whole_file import check_writable, removed_on_signals

from ..benches.curve import Curve, samples_to_reach
from ..benches.peers import peers
from ..benches.scenes import check_folder, find_cases, open_scene, save_picture
from ..referees.picture_metrics import compare, read_picture, srgb
from .built_scenes import RESOLUTION, ROUNDS, focus_pull, scaling
from .discs import discs
from .frames import BokehScene
from .lens import lenses
from .lines import line
from .pan import pan

# Enough that what is left of the difference is not noise of the blur.
_SAMPLES, _SUBSAMPLES = 128, 4
_TRUTH = 16384
_WANTED = 0.985
_LADDER = ((16, 4), (24, 4), (32, 4), (48, 4), (64, 4), (96, 4), (128, 4), (192, 4), (256, 4))
# Of plain accumulation; beyond the last one the curve is extended.
_MARKS = (64, 128, 256, 512, 1024, 2048)


def bench_bokeh(arguments, console):
    """Carry out `aplanat bench --bokeh`; parameters and result as `reference_method.bench`."""
    with removed_on_signals():
        if arguments.output:
            check_writable(arguments.output)
        check_folder(arguments.pictures)
        ensure_context()
        study = _Study(arguments, console)
        runs = []

        def note(run):
            runs.append(run)
            console.say(line(run))
            if arguments.output:
                # What is measured is kept if a later measure fails.
                write_json(arguments.output, _answer(runs))

        wanted = arguments.bokeh or [*OF_SCENES, *OF_CHARTS]
        of_scenes = [OF_SCENES[name] for name in wanted if name in OF_SCENES]
        for case in find_cases(arguments, console, _TRUTH) if of_scenes else ():
            for measure in of_scenes:
                note({"scene": case.name, **measure(study, case)})
        for name in wanted:
            if name in OF_CHARTS:
                note(OF_CHARTS[name](study))
    return _answer(runs)


def _answer(runs):
    return {"command": "bench", "measured": "bokeh", **statistics.machine(), "runs": runs}


class _Study:
    def __init__(self, arguments, console):
        self.arguments = arguments
        self.console = console

    def open(self, case):
        """Return the scene of a case with its snapshot read, and its reference or None."""
        scene = open_scene(case, self.arguments.resolution or RESOLUTION)
        file = case.references.get("lens")
        return BokehScene(scene), read_picture(file) if file else None

    def splatted(self, bench, samples=_SAMPLES, **bokeh):
        snapshot = bench.splatted(samples, _SUBSAMPLES, **bokeh)
        bench.make_levels(snapshot)
        return snapshot

    def draw(self, bench, snapshot, label, **others):
        def progress(done):
            self.console.progress(f"{label}: sample {done}")

        return bench.draw_passes(snapshot, progress=progress, **others)

    def save(self, name, picture):
        if self.arguments.pictures:
            save_picture(self.arguments.pictures / f"bokeh_{name}.exr", picture)

    def pictures(self, case):
        """Compare the point model with the reference picture."""
        bench, reference = self.open(case)
        try:
            frame = self.draw(bench, self.splatted(bench), f"{case.name}, points")
        finally:
            bench.close()
        self.save(case.stem, frame.picture)
        return {
            "measure": "pictures",
            "samples": _SAMPLES,
            "subsamples": _SUBSAMPLES,
            "compared": None if reference is None else compare(frame.picture, reference),
            "sum_is_combined": _is_sum(frame),
            "highlights": frame.highlights,
            "seconds": frame.seconds,
        }

    def truth(self, case):
        """Compare the point model with the reference method."""
        bench, reference = self.open(case)
        try:
            frame = self.draw(bench, self.splatted(bench), f"{case.name}, points")
            plain = bench.plain(case.samples)
            truth = self.draw(bench, plain, f"{case.name}, reference method").picture
        finally:
            bench.close()
        self.save(f"{case.stem}_truth", truth)
        return {
            "measure": "truth",
            "samples": case.samples,
            "compared": compare(frame.picture, truth.astype(np.float64)),
            "truth_compared": None if reference is None else compare(truth, reference),
        }

    def models(self, case):
        """Compare clustered with point sources."""
        bench, reference = self.open(case)
        frames = {}
        try:
            for model in ("POINT", "CLUSTERED"):
                snapshot = self.splatted(bench, model=model)
                label = f"{case.name}, {model.lower()}"
                frames[model] = [self.draw(bench, snapshot, label) for _ in range(ROUNDS)]
        finally:
            bench.close()
        point, clustered = frames["POINT"][0], frames["CLUSTERED"][0]
        self.save(f"{case.stem}_clustered", clustered.picture)
        found = point.highlights["found"] - point.highlights["culled_size"]
        times = {
            model: {
                step: median([frame.seconds.get(step, 0.0) for frame in drawn])
                for step in ("search", "merge", "visibility", "splat", "bokeh")
            }
            for model, drawn in frames.items()
        }
        told = {} if reference is None else {
            f"{model.lower()}_compared": compare(drawn[0].picture, reference)
            for model, drawn in frames.items()
        }  # fmt: skip
        return {
            "measure": "models",
            **told,
            "compared": compare(clustered.picture, point.picture.astype(np.float64)),
            "sources": {model: drawn[0].highlights["clustered"] for model, drawn in frames.items()},
            "found": found,
            "sources_left": clustered.highlights["clustered"] / max(found, 1),
            "seconds": times,
            "visibility_speedup": times["POINT"]["visibility"] / times["CLUSTERED"]["visibility"],
        }

    def culling(self, case):
        """Compare the picture with and without the tests."""
        bench, _ = self.open(case)
        try:
            snapshot = self.splatted(bench, samples=16, visibility="RASTER")
            culled = self.draw(bench, snapshot, f"{case.name}, culled")
            whole = self.draw(bench, snapshot, f"{case.name}, not culled", culls=False)
        finally:
            bench.close()
        counts, tests = culled.highlights, culled.visibility
        sources = counts["clustered"] + counts["culled_size"]
        shares = {"size": counts["culled_size"] / sources}
        for name in ("outside", "hidden", "visible", "free"):
            shares[name] = tests.get(name, 0) / sources
        change = np.abs(culled.bokeh.astype(np.float64) - whole.bokeh)
        shown = np.abs(srgb(culled.picture) - srgb(whole.picture))
        return {
            "measure": "culling",
            "sources": sources,
            "shares": shares,
            "culled": sum(shares.values()),
            "largest_change": float(change.max()),
            "largest_change_shown": float(shown.max()),
            "seconds": {
                "culled": culled.seconds["visibility"],
                "not_culled": whole.seconds["visibility"],
            },
        }

    def visibility(self, case):
        """Compare masks by rays through the layers with masks by projection."""
        bench, reference = self.open(case)
        frames = {}
        try:
            for method in ("RASTER", "WARP", "SPLAT"):
                snapshot = self.splatted(bench, visibility=method)
                frames[method] = self.draw(bench, snapshot, f"{case.name}, {method.lower()}")
                self.save(f"{case.stem}_{method.lower()}", frames[method].picture)
        finally:
            bench.close()
        raster = frames["RASTER"].picture.astype(np.float64)
        return {
            "measure": "visibility",
            "compared": {
                method.lower(): {
                    **compare(frame.picture, raster),
                    "psnr_db": _psnr(frame.picture, raster),
                    "seconds": frame.seconds["visibility"] + frame.seconds["splat"],
                    "against_reference": (
                        None if reference is None else compare(frame.picture, reference)
                    ),
                }
                for method, frame in frames.items()
            },
        }

    def time(self, case):
        """Compare the time of a frame with that of plain accumulation as good."""
        bench, reference = self.open(case)
        try:
            tried = []
            for setting in _LADDER:
                snapshot = bench.splatted(*setting)
                bench.make_levels(snapshot)
                frame = self.draw(bench, snapshot, f"{case.name}, {setting}")
                tried.append([*setting, compare(frame.picture, reference)["ssim_srgb"]])
                if tried[-1][-1] >= _WANTED:
                    break
            samples, seconds, ssim = [], [], []
            plain = bench.plain(2 * _MARKS[-1])
            for mark, spent, picture in bench.draw_to_marks(plain, _MARKS):
                self.console.progress(f"{case.name}, plain accumulation: sample {mark}")
                samples.append(mark)
                seconds.append(spent)
                ssim.append(compare(picture[::-1], reference)["ssim_srgb"])
                if ssim[-1] >= _WANTED:
                    break
            needed, reached = samples_to_reach(
                Curve(tuple(samples), tuple(seconds), tuple(ssim)), _WANTED
            )
            if not reached:
                needed = _extended(samples, ssim)
            ratios, frames = [], []
            for _ in range(ROUNDS):
                frames.append(bench.draw(snapshot).seconds)
                part = max(8, round(frames[-1] / (seconds[-1] / samples[-1])))
                each = bench.draw(plain, part).stages["draw"] / part
                ratios.append(each * needed / frames[-1])
        finally:
            bench.close()
        return {
            "measure": "time",
            "load_average": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
            "tried": tried,
            "reached": tried[-1][-1] >= _WANTED,
            "frame_seconds": median(frames),
            "accumulation": {
                "samples": samples,
                "seconds": seconds,
                "ssim_srgb": ssim,
                "samples_to_equal": needed,
                "extended": not reached,
                "seconds_to_equal": median(ratios) * median(frames),
            },
            "ratios": ratios,
            "speedup": median(ratios),
        }

    def peers(self, case):
        """Compare with other engines as good."""
        scene = open_scene(case, self.arguments.resolution or RESOLUTION)
        found = peers(scene, case, self.arguments, self.console, _WANTED)
        return {"measure": "peers", "engines": found["peers"], "threads": found["threads"]}

    def pan(self, case):
        """Measure flicker of the bokeh in a slow pan."""
        scene = open_scene(case, self.arguments.resolution or (240, 135))
        return {"measure": "pan", **pan(scene, case.name, self)}


OF_SCENES = {
    "pictures": _Study.pictures,
    "truth": _Study.truth,
    "models": _Study.models,
    "culling": _Study.culling,
    "visibility": _Study.visibility,
    "time": _Study.time,
    "peers": _Study.peers,
    "pan": _Study.pan,
}
OF_CHARTS = {"scaling": scaling, "focus-pull": focus_pull, "lens": lenses, "discs": discs}


def _is_sum(frame):
    passes = frame.passes
    return bool((passes["Defocus"] + passes["Bokeh"]).tobytes() == passes["Combined"].tobytes())


def _psnr(picture, reference):
    mean = float(np.square(srgb(picture) - srgb(reference)).mean())
    return math.inf if mean == 0.0 else -10.0 * math.log10(mean)


def _extended(samples, ssim):
    """Return where 1 - SSIM reaches what is wanted, as a power of the number of samples."""
    n, error = np.log(samples[-3:]), np.log(1.0 - np.array(ssim[-3:]))
    slope, offset = np.polyfit(n, error, 1)
    if slope > -0.05:
        return math.inf
    return float(np.exp((math.log(1.0 - _WANTED) - offset) / slope))
