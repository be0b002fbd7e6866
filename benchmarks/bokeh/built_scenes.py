"""Measures of `bench --bokeh` on built scenes: more and more lamps, and a focus pull."""

from statistics import median

import numpy as np

from ..referees.picture_metrics import compare
from .charts import EDGE_DEPTH, LAMP_DEPTH, half_hidden, many_highlights
from .frames import BokehScene

RESOLUTION = (480, 270)
# How often what is timed is drawn; odd, so that one of them is the median.
ROUNDS = 3
_NUMBERS = (1000, 10000, 100000)
_PULL_FRAMES = 8
_PULL_RESOLUTION = (240, 135)
_PULL_TRUTH = 4096


def scaling(study):
    """Time the bokeh of more and more lamps; `study` is that of `bench`."""
    found = []
    for number in _NUMBERS:
        scene = many_highlights(study.arguments.resolution or RESOLUTION, number)
        bench = BokehScene(scene)
        try:
            snapshot = bench.splatted(4, 0)
            drawn = [study.draw(bench, snapshot, f"{number} lamps") for _ in range(ROUNDS + 1)][1:]
        finally:
            bench.close()
        study.save(f"lamps_{number}", drawn[0].picture)
        steps = ("bokeh", "search", "merge", "visibility", "splat")
        found.append(
            {
                "lamps": number,
                "highlights": drawn[0].highlights,
                "method": drawn[0].visibility.get("method"),
                "seconds": {s: median([f.seconds.get(s, 0.0) for f in drawn]) for s in steps},
            }
        )
    times = [each["seconds"]["bokeh"] for each in found]
    return {"measure": "scaling", "scenes": found, "growth": times[2] / times[1]}


def focus_pull(study):
    """Compare frames of a focus pull past a half-hidden lamp with the reference method."""
    resolution = study.arguments.resolution or _PULL_RESOLUTION
    scene = half_hidden(resolution)
    bench = BokehScene(scene)
    samples = study.arguments.samples or _PULL_TRUTH
    frames = []
    try:
        for number, focus in enumerate(
            np.geomspace(EDGE_DEPTH / 1.6, 1.6 * LAMP_DEPTH, _PULL_FRAMES)
        ):
            scene.camera.data.dof.focus_distance = focus
            bench.look()
            label = f"focus pull, frame {number + 1}"
            frame = study.draw(bench, study.splatted(bench), label)
            truth = study.draw(bench, bench.plain(samples), label).picture
            study.save(f"pull_{number + 1}", frame.picture)
            study.save(f"pull_{number + 1}_truth", truth)
            mirrored = truth[::-1, ::-1]
            frames.append(
                {
                    "focus_m": float(focus),
                    **compare(frame.picture, truth.astype(np.float64)),
                    # The shape is the reference's way up, if this is the worse one.
                    "ssim_mirrored": compare(frame.picture, mirrored)["ssim_srgb"],
                }
            )
    finally:
        bench.close()
    return {
        "measure": "focus-pull",
        "samples": samples,
        "frames": frames,
        "least_ssim": min(frame["ssim_srgb"] for frame in frames),
    }
