"""`aplanat bench --chromatic`: chromatic aberration against its model and Cycles, and its cost.

- Axial: the RGB mode against three renders of Cycles, one a channel, whose camera is focused where
  equation (4.5) has that wavelength in focus.
- Lateral: centroids of a field of points against equation (4.8).
- A white wall stays white.
- The spectral mode with few samples against many; local maxima across fringes.
- An equalizer's narrow band: importance sampling against weights alone.
- The cost of a sample.
"""

import numpy as np

from addon.cli.render import statistics
from addon.cli.words.json_file import write_json
from addon.device.context import ensure_context
from addon.files.whole_file import check_writable, removed_on_signals
from addon.sampling.chromatic import RGB_WAVELENGTHS_NM
from addon.sampling.equalizer import band
from addon.sampling.field_maps import FIELD_PRESETS, FieldMap

from ..referees import chromatic_charts
from ..referees.picture_metrics import compare
from .chromatic_measures import (
    aberration,
    add_tint,
    centroid_errors,
    count_maxima,
    sampled_plan,
    weaker,
    with_aberration,
)
from .cycles_channels import channels_of_cycles
from .frames import BenchScene
from .scenes import check_folder, find_cases, open_scene, save_picture

_RESOLUTION = (320, 180)
# Of the converged pictures.
_TRUTH = 4096
_FEW = 128
# Of the comparison with Cycles: enough for small bright points in strong blur.
_RGB_SAMPLES = 1536
# All over the field alike.
EVEN = FieldMap("CURVE", curve_f=(0.0, 0.0))
# Of the bars: fringes many times as wide as the bars.
_WIDE = 0.4
# Of the shared scenes, whose lens opens to f/0.25: fringes are then as wide as those of a single
# lens at f/0.8, and no longer all there is to see.
SCENE_AXIAL = 0.3
_WALL_SAMPLES = (16, 17, 32, 100)
_SEEDS = 6
_NOISE_SAMPLES = 48
_COST_ROUNDS = 9
_COST_SAMPLES = 48


def bench_chromatic(arguments, console):
    """Carry out `aplanat bench --chromatic`; parameters and result as `reference_method.bench`."""
    with removed_on_signals():
        if arguments.output:
            check_writable(arguments.output)
        check_folder(arguments.pictures)
        study = _Study(arguments, console)
        runs = []
        for measure in (
            study.lateral,
            study.wall,
            study.bands,
            study.equalizer,
            study.points_against_cycles,
        ):
            runs.append(measure())
        for case in find_cases(arguments, console, _TRUTH):
            runs += [study.scene_against_cycles(case), study.spectral(case), study.cost(case)]
            if arguments.output:
                write_json(arguments.output, _answer(runs))
        for run in runs:
            console.say(_line(run))
        if arguments.output:
            write_json(arguments.output, _answer(runs))
    return _answer(runs)


def _answer(runs):
    return {"command": "bench", "measured": "chromatic", **statistics.machine(), "runs": runs}


def _of_scene(scene):
    return aberration("SPECTRAL", scene.camera.data.lens / 1000.0, SCENE_AXIAL)


class _Study:
    def __init__(self, arguments, console):
        self._arguments = arguments
        self._console = console
        self._resolution = arguments.resolution or _RESOLUTION
        ensure_context()

    def _draw(self, bench, snapshot, label, plan=None):
        def progress(done):
            self._console.progress(f"{label}: sample {done}")

        return bench.draw(snapshot, progress=progress, plan=plan).picture

    def _save(self, name, picture):
        if self._arguments.pictures:
            save_picture(self._arguments.pictures / f"chromatic_{name}.exr", picture[::-1])

    def lateral(self):
        """Compare the centroids of points with the model."""
        errors = {}
        for shift in ((0.0, 0.0), (0.2, -0.1)):
            scene, places = chromatic_charts.field_of_points(self._resolution, shift)
            bench = BenchScene(scene)
            try:
                for name, (_, _, lateral_map) in FIELD_PRESETS.items():
                    for mode in ("RGB", "SPECTRAL"):
                        # So weak that no point reaches its neighbour.
                        chromatic = aberration(
                            mode, axial=0.0, lateral=0.04, lateral_map=weaker(lateral_map)
                        )
                        snapshot = with_aberration(bench.sampled("REFERENCE", 192), chromatic)
                        picture = self._draw(bench, snapshot, f"lateral, {name}")
                        found = centroid_errors(picture, snapshot, places)
                        errors[f"{name.lower()} {mode.lower()} shift {shift[0]:g}"] = found
            finally:
                bench.close()
        return {"measure": "lateral", "largest_error_px": max(errors.values()), "errors_px": errors}

    def wall(self):
        """Render a white wall with many settings."""
        bench = BenchScene(chromatic_charts.wall((64, 48)))
        worst = {"mean": 0.0, "chroma_8x8": 0.0}
        try:
            for mode, others in (
                ("RGB", {}),
                ("SPECTRAL", {}),
                ("SPECTRAL", {"equalizer": band(600.0, 40.0)}),
                ("SPECTRAL", {"wavelength_range": (420.0, 560.0)}),
            ):
                for maps in ("STANDARD", "SHOWCASE", "WHEEL"):
                    _, axial_map, lateral_map = FIELD_PRESETS[maps]
                    chromatic = aberration(
                        mode, axial_map=axial_map, lateral_map=lateral_map, **others
                    )
                    for count in _WALL_SAMPLES:
                        for method, subsamples in (("REFERENCE", 0), ("ADAPTIVE", 4)):
                            snapshot = bench.sampled(method, count, subsamples=subsamples)
                            plain = self._draw(bench, with_aberration(snapshot, None), "wall")
                            colored = with_aberration(snapshot, chromatic)
                            add_tint(worst, self._draw(bench, colored, "wall"), plain)
        finally:
            bench.close()
        return {"measure": "white wall", **worst}

    def bands(self):
        """Count local maxima across fringes of bright bars, few samples against many."""
        resolution = (2 * self._resolution[0], self._resolution[1])
        scene, columns = chromatic_charts.bars(resolution)
        bench = BenchScene(scene)
        counts = {}
        try:
            for name, chromatic in (
                ("spectral", aberration(axial=0.2, lateral=_WIDE)),
                ("rgb", aberration("RGB", axial=0.2, lateral=_WIDE)),
                ("band", aberration(axial=0.2, lateral=_WIDE, equalizer=band(550.0, 40.0))),
            ):
                for samples in (_FEW, _TRUTH):
                    snapshot = with_aberration(bench.sampled("REFERENCE", samples), chromatic)
                    picture = self._draw(bench, snapshot, f"bars, {name}")
                    self._save(f"bars_{name}_{samples}", picture)
                    middle = picture[picture.shape[0] // 2 - 8 : picture.shape[0] // 2 + 8]
                    profile = middle.mean(axis=0)
                    counts.setdefault(name, []).append(
                        [
                            [count_maxima(profile[a:b, channel]) for channel in range(3)]
                            for a, b in columns
                        ]
                    )
        finally:
            bench.close()
        return {
            "measure": "bands",
            "maxima": counts,
            "equal": {name: few == many for name, (few, many) in counts.items()},
        }

    def equalizer(self):
        """Compare the noise of importance sampling and of weights alone in a band of 40 nm."""
        bench = BenchScene(chromatic_charts.points(self._resolution))
        chromatic = aberration(equalizer=band(550.0, 40.0))
        squares = {True: [], False: []}
        try:
            many = with_aberration(bench.sampled("REFERENCE", _TRUTH), chromatic)
            truth = self._draw(bench, many, "equalizer")
            for seed in range(1, _SEEDS + 1):
                snapshot = bench.sampled("REFERENCE", _NOISE_SAMPLES, seed=seed)
                snapshot = with_aberration(snapshot, chromatic)
                for importance in squares:
                    plan = sampled_plan(snapshot, importance)
                    found = self._draw(bench, snapshot, "equalizer", plan)
                    squares[importance].append(float(np.square(found - truth).mean()))
        finally:
            bench.close()
        alone, drawn = (float(np.mean(squares[importance])) for importance in (False, True))
        return {
            "measure": "equalizer",
            "variance_weights_alone": alone,
            "variance_importance": drawn,
            "ratio": alone / drawn,
        }

    def points_against_cycles(self):
        """Compare the RGB mode with Cycles on a chart of points."""
        scene = chromatic_charts.points(self._resolution)
        return self._against_cycles(scene, "points", 2048, 1.0)

    def scene_against_cycles(self, case):
        """Compare the RGB mode with Cycles on a scene."""
        scene = open_scene(case, self._resolution)
        return self._against_cycles(scene, case.stem, 512, SCENE_AXIAL)

    def _against_cycles(self, scene, name, cycles_samples, axial):
        bench = BenchScene(scene)
        try:
            camera = scene.camera.data
            chromatic = aberration(
                "RGB", camera.lens / 1000.0, axial, lateral=0.0, axial_map=EVEN, lateral_map=EVEN
            )
            snapshot = bench.sampled("REFERENCE", _RGB_SAMPLES)
            focus = snapshot.camera.lens.focus_distance
            distances = chromatic.focus_distances(focus, np.array(RGB_WAVELENGTHS_NM))
            picture = self._draw(bench, with_aberration(snapshot, chromatic), f"{name}, RGB")
            plain = self._draw(bench, snapshot, f"{name}, achromatic")
        finally:
            bench.close()
        self._console.progress(f"{name}: Cycles")
        reference = channels_of_cycles(scene, name, distances.tolist(), cycles_samples)
        self._save(f"{name}_rgb", picture)
        self._save(f"{name}_cycles", reference[::-1])
        return {
            "measure": "RGB against Cycles",
            "scene": name,
            "focus_m": distances.tolist(),
            "compared": compare(picture[::-1], reference),
            # How different the picture without chromatic aberration is.
            "achromatic": compare(plain[::-1], reference),
        }

    def spectral(self, case):
        """Compare few samples of the spectral mode with many."""
        scene = open_scene(case, self._resolution)
        bench = BenchScene(scene)
        try:
            chromatic = _of_scene(scene)
            pictures = {}
            for method, samples, settings in (
                ("REFERENCE", _TRUTH, {}),
                ("REFERENCE", _FEW, {}),
                ("ADAPTIVE", _FEW, {"subsamples": 0}),
                ("ADAPTIVE", _FEW, {"subsamples": 4}),
            ):
                snapshot = bench.sampled(method, samples, **settings)
                snapshot = with_aberration(snapshot, chromatic)
                if method == "ADAPTIVE":
                    bench.make_levels(snapshot)
                name = f"{method.lower()}_{samples}_{settings.get('subsamples', 0)}"
                pictures[name] = self._draw(bench, snapshot, f"{case.name}, {name}")
                self._save(f"{case.stem}_{name}", pictures[name])
        finally:
            bench.close()
        truth = pictures.pop(f"reference_{_TRUTH}_0").astype(np.float64)
        return {
            "measure": "spectral",
            "scene": case.name,
            "compared": {name: compare(picture, truth) for name, picture in pictures.items()},
        }

    def cost(self, case):
        """Time the spectral mode and the achromatic picture in turns."""
        scene = open_scene(case, self._resolution)
        bench = BenchScene(scene)
        ratios = {}
        try:
            chromatic = _of_scene(scene)
            for method, settings in (("REFERENCE", {}), ("ADAPTIVE", {"subsamples": 4})):
                plain = bench.sampled(method, _COST_SAMPLES, **settings)
                pair = (with_aberration(plain, None), with_aberration(plain, chromatic))
                if method == "ADAPTIVE":
                    bench.make_levels(plain)
                found = []
                for number in range(_COST_ROUNDS + 1):
                    self._console.progress(f"{case.name}: cost {number}/{_COST_ROUNDS}")
                    # Each one is first as often as the other.
                    order = pair if number % 2 else pair[::-1]
                    seconds = {id(one): bench.draw(one).stages["draw"] for one in order}
                    found.append(seconds[id(pair[1])] / seconds[id(pair[0])])
                # The first round also compiles.
                ratios[method.lower()] = sorted(found[1:])
        finally:
            bench.close()
        middle = {name: found[len(found) // 2] for name, found in ratios.items()}
        return {"measure": "cost", "scene": case.name, "ratio": middle, "ratios": ratios}


def _line(run):
    name = run["measure"]
    if name == "lateral":
        return f"lateral: centroids at most {run['largest_error_px']:.3f} px off the model"
    if name == "white wall":
        return (
            f"white wall: channel means within {run['mean']:.2e}, chroma of 8 x 8 means"
            f" {run['chroma_8x8']:.2e}"
        )
    if name == "bands":
        same = ", ".join(f"{k} {'equal' if v else 'different'}" for k, v in run["equal"].items())
        return f"local maxima across fringes, {_FEW} samples against {_TRUTH}: {same}"
    if name == "equalizer":
        return f"equalizer: importance sampling has {run['ratio']:.1f} times less variance"
    if name == "cost":
        told = ", ".join(f"{k} {v:.3f}" for k, v in run["ratio"].items())
        return f"{run['scene']}: spectral over achromatic cost: {told}"
    if name == "spectral":
        told = ", ".join(f"{k} {v['ssim_srgb']:.4f}" for k, v in run["compared"].items())
        return f"{run['scene']}: SSIM against {_TRUTH} samples: {told}"
    compared, plain = run["compared"], run["achromatic"]
    return (
        f"{run['scene']}: RGB against Cycles SSIM {compared['ssim_srgb']:.4f}, worst tile"
        f" {compared['ssim_tile']:.4f}, energy {compared['energy']:.4f}; achromatic SSIM"
        f" {plain['ssim_srgb']:.4f}"
    )
