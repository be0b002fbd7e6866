"""Flicker of the bokeh in a slow pan.

The camera turns by a fraction of a pixel a frame. In each pixel, brightness then runs smoothly
through time but for what flickers, which is in the second differences from frame to frame. Their
variance in the bokeh pass is compared with that of the reference method's own highlights: the
picture with all light sampled minus the picture of the same samples without the light above the
threshold, so that the noise of the rest cancels.
"""

import math

import numpy as np

from .frames import BokehScene

_FRAMES = 48
_PIXELS_A_FRAME = 0.2
_SAMPLES, _SUBSAMPLES = 4, 0
_TRUTH = 1024


def pan(scene, name, study):
    """Measure a pan.

    Parameters
    ----------
    scene : bpy.types.Scene
    name : str
        For messages.
    study : object
        With `draw` and `arguments`, as that of `bench_bokeh`.

    Returns
    -------
    dict
        ``excess``: how much more the variance is than the reference's, as a share of it, by model.
    """
    camera = scene.camera
    turn = 2.0 * math.atan(0.5 * camera.data.sensor_width / camera.data.lens)
    turn *= _PIXELS_A_FRAME / scene.render.resolution_x
    start = camera.matrix_world.copy()
    samples = study.arguments.samples or _TRUTH
    bench = BokehScene(scene)
    series = {"point": [], "clustered": [], "reference": []}
    try:
        for number in range(_FRAMES):
            label = f"{name}, frame {number + 1}/{_FRAMES} of the pan"
            _turn(camera, start, turn * number)
            bench.look()
            for model in ("point", "clustered"):
                snapshot = bench.splatted(_SAMPLES, _SUBSAMPLES, model=model.upper())
                series[model].append(study.draw(bench, snapshot, label).bokeh)
            whole = study.draw(bench, bench.plain(samples), label).picture
            rest = bench.splatted(samples, method="REFERENCE")
            rest = study.draw(bench, rest, label).passes["Defocus"][..., :3]
            series["reference"].append(whole - rest)
    finally:
        bench.close()
    changes = {model: _change(np.stack(pictures)) for model, pictures in series.items()}
    return {
        "frames": _FRAMES,
        "pixels_a_frame": _PIXELS_A_FRAME,
        "samples": samples,
        "variance": changes,
        "excess": {
            model: changes[model] / changes["reference"] - 1.0 for model in ("point", "clustered")
        },
    }


def _turn(camera, start, angle):
    from mathutils import Matrix

    camera.matrix_world = start @ Matrix.Rotation(angle, 4, "Y")


def _change(series):
    """Return the mean square of second differences in time, of values bounded as on a display."""
    shown = series / (1.0 + np.maximum(series, 0.0))
    return float(np.square(shown[2:] - 2.0 * shown[1:-1] + shown[:-2]).mean(dtype=np.float64))
