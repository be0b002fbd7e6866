"""`aplanat bench --method adaptive --peers`: EEVEE and Cycles on the same processors.

All three render the scene through Blender's render operator, and all of that call is timed. The
adaptive method is measured at the least of a ladder of settings that is as similar to the reference
picture as is asked for. Cycles takes a number of samples that reaches the same: doubled until it
does, then the interpolated one if that does, too. Our method is timed again beside each render of
Cycles, because the machine may have other work. EEVEE has one best setting, which takes a minute
and more: beside it stands the first setting of our ladder that is as similar to the reference.
"""

import os
import tempfile
import time
from pathlib import Path

import bpy

from addon.cli.render import statistics
from addon.cli.render.render_command import heard_render
from addon.device.context import ensure_context
from addon.engine.render_engine import ENGINE_ID
from addon.errors import InputError

from ..referees.picture_metrics import compare, read_picture
from ..scenes.pictures import use_cycles, write_floats
from .curve import Curve, samples_to_reach
from .scenes import save_picture

# What all but EEVEE must reach, if nothing else is asked for.
_SSIM = 0.98
# From cheap to dear: lens samples and subsamples.
_LADDER = (
    *((8, 8), (16, 4), (16, 8), (24, 4), (24, 8), (32, 4), (32, 8), (48, 4), (48, 8)),
    *((64, 4), (64, 8), (96, 4), (96, 8), (128, 4), (192, 4), (256, 4)),
)
_EEVEE_SAMPLES = 64
_CYCLES_FIRST, _CYCLES_MOST = 16, 4096
_DENOISED_SAMPLES = (8, 16, 32)
_THREADS = 2
# Each engine's time is the middle one of so many renders; EEVEE's takes a minute and more.
_TIMES = 3


def peers(scene, case, arguments, console, wanted=_SSIM):
    """Measure a scene.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its surfaces must give their own light: nothing bounces.
    case : Case
    arguments : argparse.Namespace
    console : Console
    wanted : float
        Structural similarity that all but EEVEE must reach.

    Returns
    -------
    dict

    Raises
    ------
    InputError
        If there is no reference to compare with.
    """
    file = case.references.get("lens")
    if file is None:
        raise InputError(
            f"--peers: scene '{case.name}' has no reference picture; give one with --reference"
        )
    ensure_context()
    reference = read_picture(file)
    scene.render.threads_mode, scene.render.threads = "FIXED", _THREADS
    with tempfile.TemporaryDirectory() as folder:
        study = _Study(scene, case, reference, Path(folder), arguments.pictures, console)
        study.wanted = wanted
        found = {"adaptive": study.adaptive()}
        found["cycles"] = study.cycles()
        found["cycles_denoised"] = [study.denoised(count) for count in _DENOISED_SAMPLES]
        found["eevee"] = study.eevee()
    return {"scene": case.name, "reference": str(file), "threads": _THREADS, "peers": found}


class _Study:
    def __init__(self, scene, case, reference, folder, pictures, console):
        self._scene, self._case, self._reference = scene, case, reference
        self._folder, self._pictures, self._console = folder, pictures, console
        self._setting = None
        self.wanted = _SSIM

    def adaptive(self):
        first, tried = None, []
        for setting in _LADDER:
            self._setting = setting
            found = self._ours()
            # The first makes levels of detail and compiles.
            first = first or found
            tried.append({"setting": list(setting), "ssim_srgb": found["compared"]["ssim_srgb"]})
            if tried[-1]["ssim_srgb"] >= self.wanted:
                break
        times = [self._ours() for _ in range(_TIMES)]
        return {
            "samples": self._setting[0],
            "subsamples": self._setting[1],
            "reached": tried[-1]["ssim_srgb"] >= self.wanted,
            "tried": tried,
            "first_render": first["work"],
            **_middle(times),
        }

    def _ours(self):
        scene = self._scene
        scene.render.engine = ENGINE_ID
        settings = scene.aplanat
        settings.method = "ADAPTIVE"
        settings.use_target_error = False
        settings.render_samples, settings.subsamples = self._setting
        self._console.progress(f"{self._case.name}: adaptive {self._setting}")
        start = time.perf_counter()
        heard = heard_render(keep_pictures=True)
        seconds = time.perf_counter() - start
        picture = heard.layers[0].passes["Combined"].pixels[::-1, :, :3]
        return self._measured("adaptive", picture, seconds, work=statistics.work(heard.statistics))

    def cycles(self):
        use_cycles(self._scene, 1)
        self._scene.render.use_persistent_data = False
        numbers, ssim = [], []
        number = _CYCLES_FIRST
        while number <= _CYCLES_MOST:
            found = self._render("cycles", number)
            numbers.append(number)
            ssim.append(found["compared"]["ssim_srgb"])
            if ssim[-1] >= self.wanted:
                break
            number *= 2
        curve = Curve(tuple(numbers), (0.0,) * len(numbers), tuple(ssim))
        samples, reached = samples_to_reach(curve, self.wanted)
        # Cycles' pattern is best at powers of two: what lies between may be worse than both ends.
        between = self._render("cycles", round(samples))["compared"]["ssim_srgb"]
        samples = round(samples) if between >= self.wanted else numbers[-1]
        return {
            "tried": [{"samples": n, "ssim_srgb": q} for n, q in zip(numbers, ssim, strict=True)],
            "reached": reached,
            **self._beside("cycles", samples, _TIMES),
        }

    def denoised(self, samples):
        use_cycles(self._scene, 1)
        self._scene.render.use_persistent_data = False
        cycles = self._scene.cycles
        try:
            cycles.denoiser = "OPENIMAGEDENOISE"
        except TypeError:
            return {"samples": samples, "missing": "this Blender has no OpenImageDenoise"}
        cycles.use_denoising = True
        return self._beside("cycles_denoised", samples, 1)

    def eevee(self):
        self._use_eevee()
        # Compiles.
        self._render("eevee", 1)
        found = self._render("eevee", _EEVEE_SAMPLES)
        # EEVEE has one best setting: ours is the next of the ladder that is as good or better.
        wanted = found["compared"]["ssim_srgb"]
        for setting in _LADDER[_LADDER.index(self._setting) :]:
            self._setting = setting
            ours = self._ours()
            if ours["compared"]["ssim_srgb"] >= wanted:
                break
        times = [self._ours() for _ in range(_TIMES)]
        ours = _middle(times)
        return {
            "samples": _EEVEE_SAMPLES,
            **found,
            "adaptive": {
                "samples": setting[0],
                "subsamples": setting[1],
                "reached": ours["compared"]["ssim_srgb"] >= wanted,
                **ours,
            },
            "speedup": found["seconds"] / ours["seconds"],
        }

    def _use_eevee(self):
        scene = self._scene
        scene.render.engine = "BLENDER_EEVEE"
        eevee = scene.eevee
        eevee.use_bokeh_jittered = True
        eevee.bokeh_max_size = 200.0
        eevee.bokeh_threshold = 0.0

    def _beside(self, engine, samples, times):
        """Time a peer, each render beside one of the adaptive method."""
        found, ratios = [], []
        for _ in range(times):
            ours = self._ours()["seconds"]
            self._scene.render.engine = "BLENDER_EEVEE" if engine == "eevee" else "CYCLES"
            found.append(self._render(engine, samples))
            ours = (ours + self._ours()["seconds"]) / 2.0
            ratios.append(found[-1]["seconds"] / ours)
        ratio = sorted(ratios)[len(ratios) // 2]
        return {"samples": samples, **_middle(found), "ratios": ratios, "speedup": ratio}

    def _render(self, engine, samples):
        scene = self._scene
        if engine == "eevee":
            scene.eevee.taa_render_samples = samples
        else:
            scene.cycles.samples = samples
        self._console.progress(f"{self._case.name}: {engine}, {samples} samples")
        path = self._folder / "picture.exr"
        write_floats(scene.render, path, "RGB")
        start = time.perf_counter()
        bpy.ops.render.render(write_still=True)
        seconds = time.perf_counter() - start
        return self._measured(engine, read_picture(path), seconds)

    def _measured(self, engine, picture, seconds, **more):
        if self._pictures:
            save_picture(self._pictures / f"{self._case.stem}_{engine}.exr", picture)
        return {
            "seconds": seconds,
            "compared": compare(picture, self._reference),
            "load_average": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
            **more,
        }


def _middle(found):
    return sorted(found, key=lambda each: each["seconds"])[len(found) // 2]


def peers_lines(found):
    """Return what was found, one line an engine."""
    each = found["peers"]
    ours = each["adaptive"]
    yield (
        f"{found['scene']}: adaptive ({ours['samples']}, {ours['subsamples']})"
        f" {ours['seconds']:.2f} s, SSIM {ours['compared']['ssim_srgb']:.4f}"
    )
    denoised = [("Cycles, denoised", result) for result in each["cycles_denoised"]]
    for name, result in [("Cycles", each["cycles"]), *denoised, ("EEVEE", each["eevee"])]:
        if "missing" in result:
            yield f"{found['scene']}: {name}: {result['missing']}"
            continue
        yield (
            f"{found['scene']}: {name}, {result['samples']} samples: {result['seconds']:.2f} s,"
            f" SSIM {result['compared']['ssim_srgb']:.4f}: {result['speedup']:.2f} times as long as"
            f" the adaptive method{_as_good_as(result)}"
        )


def _as_good_as(result):
    if "adaptive" not in result:
        return ""
    ours = result["adaptive"]
    return (
        f" ({ours['samples']}, {ours['subsamples']}) with SSIM {ours['compared']['ssim_srgb']:.4f}"
    )
