"""`aplanat bench --method adaptive --focus-pull`: whether the adaptive method flickers.

The focus moves through the scene in 24 frames, by the same factor from frame to frame. In each pair
of frames every pixel changes in the adaptive pictures and in those of the reference method; what
the adaptive one changes more is its flicker: levels of detail, shared drawings and subsamples
change with the focus, the reference's places on the lens do not. The reference takes as many places
on the lens as samples and subsamples together, the same ones, so that only the method differs.

Pictures are compared as displayed, encoded for sRGB and clipped, after a mean over 3 x 3 pixels.
"""

import bpy
import numpy as np

from addon.device.context import ensure_context
from addon.scene.camera.camera import focus_distance

from ..referees.picture_metrics import compare, srgb
from .frames import BenchScene
from .scenes import save_picture

_FRAMES = 24
# Of the scene's own focus distance.
_FROM, _TO = 3.0 / 4.0, 4.0 / 3.0


def focus_pull(scene, case, numbers, arguments, console):
    """Measure a focus pull.

    Parameters
    ----------
    scene : bpy.types.Scene
    case : Case
    numbers : tuple of 2 int
        Samples and subsamples of the adaptive method.
    arguments : argparse.Namespace
    console : Console

    Returns
    -------
    dict
        ``excess`` is the largest change of the adaptive pictures beyond the reference's at the same
        pixel and time, of a range of 1.
    """
    samples, subsamples = numbers
    frames = _FRAMES
    places = samples * (1 + subsamples)
    ensure_context()
    dof = scene.camera.data.dof
    depsgraph = bpy.context.evaluated_depsgraph_get()
    middle = focus_distance(depsgraph, scene.camera.evaluated_get(depsgraph))
    dof.focus_object = None
    bench = BenchScene(scene)
    try:
        pull = _Pull(bench, samples, subsamples, places)
        for number, factor in enumerate(np.geomspace(_FROM, _TO, frames)):
            console.progress(f"{case.name}: frame {number + 1}/{frames} of the focus pull")
            dof.focus_distance = middle * float(factor)
            pictures = pull.frame(number)
            if arguments.pictures:
                for method, picture in pictures.items():
                    name = f"{case.stem}_pull_{method}_{number + 1:02d}.exr"
                    save_picture(arguments.pictures / name, picture[::-1])
    finally:
        bench.close()
    return {
        "scene": case.name,
        "focus_pull": {
            "frames": frames,
            "resolution": [scene.render.resolution_x, scene.render.resolution_y],
            "focus_distance_m": [middle * _FROM, middle * _TO],
            "samples": samples,
            "subsamples": subsamples,
            "reference_samples": places,
            **pull.found(),
        },
    }


class _Pull:
    def __init__(self, bench, samples, subsamples, places):
        self._bench = bench
        self._samples = {
            "adaptive": (samples, {"subsamples": subsamples}),
            "reference": (places, {}),
        }
        self._before = None
        self._most = None
        self._excess, self._changes, self._ssim = [], [], []

    def frame(self, number):
        bench, shown, pictures = self._bench, {}, {}
        bench.look()
        for method, (samples, settings) in self._samples.items():
            snapshot = bench.sampled(method.upper(), samples, **settings)
            bench.make_levels(snapshot)
            pictures[method] = bench.draw(snapshot).picture
            shown[method] = mean_of_nine(srgb(pictures[method]))
        self._ssim.append(compare(pictures["adaptive"], pictures["reference"])["ssim_srgb"])
        if self._before is not None:
            changes = {m: np.abs(shown[m] - self._before[m]) for m in shown}
            beyond = changes["adaptive"] - changes["reference"]
            place = np.unravel_index(beyond.argmax(), beyond.shape)
            self._excess.append((float(beyond.max()), number, int(place[1]) + 1, int(place[0]) + 1))
            self._changes.append({m: float(change.max()) for m, change in changes.items()})
            most = self._most or changes
            self._most = {m: np.maximum(most[m], changes[m]) for m in changes}
        self._before = shown
        return pictures

    def found(self):
        worst = max(self._excess)
        over_time = self._most["adaptive"] - self._most["reference"]
        return {
            "excess": worst[0],
            "excess_at": {"frames": [worst[1], worst[1] + 1], "x": worst[2], "y": worst[3]},
            "excess_by_frame": [each[0] for each in self._excess],
            # Of each pixel's largest change in the whole sequence.
            "excess_of_largest": float(over_time.max()),
            "largest_change": {
                method: max(each[method] for each in self._changes) for method in self._changes[0]
            },
            "least_ssim": min(self._ssim),
        }


def mean_of_nine(picture):
    """Return the mean over 3 x 3 pixels, where all nine are in the picture."""
    rows = picture[:-2] + picture[1:-1] + picture[2:]
    return (rows[:, :-2] + rows[:, 1:-1] + rows[:, 2:]) / 9.0


def focus_pull_line(found):
    """Return what a focus pull found, as one line."""
    pull = found["focus_pull"]
    largest, at = pull["largest_change"], pull["excess_at"]
    return (
        f"{found['scene']}: focus pull of {pull['frames']} frames: the adaptive method"
        f" ({pull['samples']}, {pull['subsamples']}) changes {pull['excess']:.2%} of the range more"
        f" than the reference with {pull['reference_samples']} samples, between frames"
        f" {at['frames'][0]} and {at['frames'][1]} at {at['x']}, {at['y']} (largest changes"
        f" {largest['adaptive']:.2%} and {largest['reference']:.2%}); SSIM between the two"
        f" {pull['least_ssim']:.4f} or more"
    )
