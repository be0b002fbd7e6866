"""Measure what a noise threshold promises: the error of automatic sampling against the reference.

Each scene is drawn with each number, its highlights sampled as all else, and compared (1 - SSIM as
displayed) with the reference method with many lens samples of another seed. How far the two halves
of those are apart tells the reference's own noise, which adds to the picture's: it is told, and
taken off what was measured. Where it is so large that it decides, the result is not decided.
References and results are kept in a folder, so that a run that was ended goes on when it is
started again; results of other sources are measured anew.

With --cycles, flat scenes are compared with the pictures of Cycles that lie beside the checkout, of
thousands of samples and twice the size; both then have a box filter of one pixel.

    python -m benchmarks.tools.noise_threshold           # the shared scenes, a focus pull
    python -m benchmarks.tools.noise_threshold toys:lit pull:3 zoo:7:12 mine.blend

Exit code 1 if an error is above 1.3 times its number, or below half of it with more than the
fewest samples, or if either is not decided.
"""

import argparse
import math
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))

from addon.device.context import ensure_context  # noqa: E402  (after the path is set)
from addon.engine.frame.pipeline import FrameRenderer  # noqa: E402
from addon.engine.planning.plan import plan_frame  # noqa: E402
from addon.sampling.rounds import first_look  # noqa: E402
from benchmarks.benches.frames import BenchScene  # noqa: E402
from benchmarks.kept_results import KeptResults, fingerprint  # noqa: E402
from benchmarks.referees.picture_metrics import compare, read_picture  # noqa: E402
from benchmarks.referees.shared_scenes import shared_references, shared_scene  # noqa: E402

SCENES = ("balls", "toys", "fishes", "street", "christmas_tree", "toy_dinosaurs", "dragons")
PULL_FRAMES = 8
# Of the distance of focus, as of `scripts/aplanat bench --focus-pull`.
PULL_FROM, PULL_TO = 3.0 / 4.0, 4.0 / 3.0
MOST, LEAST = 1.3, 0.5
_FEWEST_REFERENCE, _TIMED = 256, 8
_SOURCES = ("addon/engine", "addon/levels", "addon/passes", "addon/sampling", "gpu_shaders")


def main():
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", help="NAME:LOOK, pull:N, zoo:SEED:N, or a .blend file")
    parser.add_argument("--errors", type=float, nargs="+", default=[0.02, 0.01, 0.005])
    parser.add_argument("--resolution", default="240x135")
    parser.add_argument("--samples", type=int, default=4096, help="of the reference")
    parser.add_argument("--seconds", type=float, default=900.0, help="of a reference, at most")
    parser.add_argument("--folder", type=Path, default=REPOSITORY / "build" / "noise_threshold")
    parser.add_argument("--cycles", action="store_true", help="flat scenes against Cycles")
    parser.add_argument("--label", default="", help="measure anew under this name")
    parser.add_argument("--pictures", action="store_true", help="keep the pictures, too")
    options = parser.parse_args()
    options.size = tuple(map(int, options.resolution.split("x")))
    options.folder.mkdir(parents=True, exist_ok=True)
    cases = options.cases or [
        *(f"{name}:{look}" for look in ("flat", "lit") for name in SCENES),
        *(f"pull:{number}" for number in range(1, PULL_FRAMES + 1)),
    ]
    results = kept(options, "results.jsonl")
    rows = [row for case in cases for row in measured(case, options, results)]
    print(table(rows))
    sys.exit(any(row["verdict"] != "ok" for row in rows))


def kept(options, name):
    """Return the results in a file of the folder, as `KeptResults`."""
    mark = options.label or fingerprint(*_SOURCES)
    return KeptResults(options.folder / name, mark, ("case", "size", "number", "reference"))


def measured(case, options, results):
    """Yield what a case's numbers come to."""
    bench = None
    stem = f"{case.replace(':', '_').replace('/', '_')}_{options.resolution}"
    cycles = options.cycles and case.endswith(":flat")
    known = cycles or best_known(stem, options)
    for number in options.errors:
        if not known:
            bench = bench or opened(case, options)
            known = reference(bench, options, stem)
        samples = "Cycles" if cycles else int(known.stem.split("ref")[1])
        key = (case, options.resolution, number, samples)
        if key not in results.found:
            bench = bench or opened(case, options)
            halves = by_cycles(case, options) if cycles else np.load(known)
            results.add(
                dict(zip(("case", "size", "number", "reference"), key, strict=True))
                | drawn(bench, number, halves, options, stem)
            )
        row = results.found[key]
        print(line(row), flush=True)
        yield row
    if bench:
        bench.close()


def best_known(stem, options):
    """Return the file of a reference with the most samples, or None."""
    files = {int(p.stem.split("ref")[1]): p for p in options.folder.glob(f"{stem}_ref*.npy")}
    samples = max((count for count in files if count <= options.samples), default=None)
    return files.get(samples)


def by_cycles(case, options):
    """Return a picture of Cycles, scaled down, twice."""
    picture = read_picture(shared_references(case.split(":")[0], "flat")["lens"])[::-1]
    width, height = options.size
    fine = picture.shape[0] // height
    if picture.shape[:2] != (fine * height, fine * width):
        raise SystemExit(f"{case}: {picture.shape[1]} x {picture.shape[0]} px are no multiple")
    picture = picture.reshape(height, fine, width, fine, 3).mean(axis=(1, 3))
    return np.stack([picture, picture])


def opened(case, options):
    """Return the `BenchScene` of a case."""
    import bpy

    import addon

    if not hasattr(bpy.types.Scene, "aplanat"):
        addon.register()
    kind, *rest = case.split(":")
    if kind == "zoo":
        from benchmarks.zoo.scenes.recipe import make_recipe
        from benchmarks.zoo.scenes.script import build

        build(make_recipe(bpy, *map(int, rest)))
    elif case.endswith(".blend"):
        bpy.ops.wm.open_mainfile(filepath=case)
    else:
        name, look = ("balls", "flat") if kind == "pull" else (kind, rest[0])
        bpy.ops.wm.open_mainfile(filepath=str(shared_scene(name, look, Console())))
    scene = bpy.context.scene
    scene.render.engine = "APLANAT"
    scene.render.resolution_x, scene.render.resolution_y = options.size
    scene.render.resolution_percentage, scene.render.use_border = 100, False
    if options.cycles and case.endswith(":flat"):
        scene.aplanat.pixel_filter, scene.render.filter_size = "BOX", 1.0
    if kind == "pull":
        distances = np.geomspace(PULL_FROM, PULL_TO, PULL_FRAMES)
        scene.camera.data.dof.focus_distance *= float(distances[int(rest[0]) - 1])
    ensure_context()
    return BenchScene(scene)


class Console:
    """Says what is built."""

    def say(self, text):
        """Print a line."""
        print(text, flush=True)


def reference(bench, options, stem):
    """Draw a case's reference and return its file: the mean of either half of the samples."""
    snapshot = replace(bench.sampled("REFERENCE", options.samples, seed=1), passes=("Combined",))
    bench.draw(snapshot, _TIMED)
    start = time.perf_counter()
    bench.draw(snapshot, _TIMED)
    affordable = options.seconds * _TIMED / (time.perf_counter() - start)
    count = options.samples
    while count > max(affordable, _FEWEST_REFERENCE):
        count //= 2
    snapshot = replace(snapshot, sampling=replace(snapshot.sampling, lens_samples=count))
    start = time.perf_counter()
    first, whole = (
        picture.copy() for _, _, picture in bench.draw_to_marks(snapshot, (count // 2, count))
    )
    print(f"{stem}: reference of {count} samples, {time.perf_counter() - start:.0f} s", flush=True)
    path = options.folder / f"{stem}_ref{count}.npy"
    # Weights of the pixel filter are left out: both halves have nearly the same.
    np.save(path, np.float32([first, 2.0 * whole - first]))
    return path


def drawn(bench, number, halves, options, stem):
    """Draw a case with a number and return what it comes to."""
    plain = bench.sampled("ADAPTIVE", 1)
    sampling = replace(plain.sampling, target_error=number)
    snapshot = replace(plain, sampling=sampling, passes=("Combined",))
    bench.make_levels(snapshot)
    start = time.process_time()
    renderer = FrameRenderer(plan_frame(snapshot), snapshot, bench._buffers)
    while not renderer.sampled:
        renderer.advance(8)
    picture = renderer.read_image()[..., :3]
    seconds = time.process_time() - start
    report, control = renderer.sampling, renderer._tiles._control
    power = control.power
    if options.pictures:
        np.savez(
            options.folder / f"{stem}_{number}.npz",
            picture=picture,
            estimate=control.errors,
            samples=renderer._tiles._samples,
        )
    renderer.release()
    truth = halves.mean(axis=0, dtype=np.float64)
    noise = noise_of_mean(1.0 - compare(halves[0], halves[1])["ssim_srgb"], power)
    error = 1.0 - compare(picture, truth)["ssim_srgb"]
    fewest = report.samples[2] <= first_look(renderer_unit(snapshot))
    share = (error - noise) / number
    return {
        "error": error,
        "share": share,
        "estimate": report.error,
        "samples": report.samples,
        "power": power,
        "noise": noise,
        "energy": float(picture.sum(dtype=np.float64) / truth.sum()),
        "seconds": seconds,
        "verdict": judged(share, error / number, fewest),
    }


def noise_of_mean(apart, power):
    """Return the noise of a mean of two halves.

    With a variance of ``n^-p`` a half has ``2^p`` times that of the whole, ``e``; the halves then
    have the correlation ``2^(1 - p) - 1`` and are ``4 (2^p - 1) e`` apart.

    Parameters
    ----------
    apart : float
        Noise that one half has as seen from the other.
    power : float
        The `p`.

    Returns
    -------
    float
    """
    return apart / (4.0 * (2.0**power - 1.0))


def judged(share, raw, fewest):
    """Return what is to be said of an error as a share of its number.

    Parameters
    ----------
    share, raw : float
        Without and with the noise of the reference.
    fewest : bool
        Whether only the fewest samples were drawn.

    Returns
    -------
    str
        ``ok``, ``above``, ``below``, or ``not decided``, if the noise of the reference is more
        than half of what is allowed, or makes up for what is too little.
    """
    if share > MOST:
        return "above"
    if share < LEAST and not fewest:
        return "not decided" if raw >= LEAST else "below"
    return "not decided" if raw - share > 0.5 * MOST else "ok"


def renderer_unit(snapshot):
    """Return how many samples share a place on the lens."""
    return plan_frame(snapshot).automatic.unit


def line(row):
    """Return a row as text."""
    least, mean, most = row["samples"]
    return (
        f"{row['case']:22} {row['number']:<6g} measured {row['share']:.2f} of it,"
        f" estimated {row['estimate'] / row['number']:.2f}, samples {least}, {mean:.0f}, {most},"
        f" p {row['power']:.2f}, reference {row['reference']} (noise {row['noise']:.5f}),"
        f" energy {row['energy']:.4f}, {row['seconds']:.0f} s {row['verdict']}"
    )


def table(rows):
    """Return the rows as a table of docs/quality.md."""
    by_case = {}
    for row in rows:
        by_case.setdefault(row["case"], []).append(row)
    numbers = sorted({row["number"] for row in rows}, reverse=True)
    lines = ["| scene | " + " | ".join(f"{n:g}" for n in numbers) + " | mean samples | reference |"]
    lines.append("| --- " * (len(numbers) + 3) + "|")
    for case, found in by_case.items():
        shares = {row["number"]: row for row in found}
        cells = []
        for number in numbers:
            row = shares.get(number)
            text = "" if row is None else f"{row['share']:.2f}"
            if row and row["verdict"] != "ok":
                text = f"({text})" if row["verdict"] == "not decided" else f"**{text}**"
            cells.append(text)
        means = ", ".join(f"{shares[n]['samples'][1]:.0f}" for n in numbers if n in shares)
        noise = math.ceil(found[0]["noise"] * 1e5) / 1e5
        lines.append(
            f"| {case} | {' | '.join(cells)} | {means} | {found[0]['reference']}, {noise:.5f} |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    main()
