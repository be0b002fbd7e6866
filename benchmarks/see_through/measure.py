"""Compare what is seen through transparent things with Cycles' depth of field.

    python -m benchmarks.see_through.measure --out FOLDER [--scenes half,glass] [--samples 256]

Prints similarity, energy and the mean difference of the displayed pictures for each scene, and
writes pictures of ours, Cycles' and four times their difference side by side. Cycles' pictures are
kept in the folder and used again.
"""

import argparse
import time
from pathlib import Path

import numpy as np

from benchmarks.referees.picture_metrics import compare, srgb
from benchmarks.scenes.pictures import render_picture, use_cycles
from benchmarks.see_through.scenes import SCENES, build


def main():
    """Run the comparison."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--scenes", default="", help="parts of names, separated by commas")
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--cycles", type=int, default=1024, help="samples of Cycles")
    parser.add_argument("--method", default="REFERENCE", help="REFERENCE, ADAPTIVE or LAYERED")
    parser.add_argument("--lamps", type=float, default=40.0, help="radiance; 0: none")
    parser.add_argument("--size", type=int, nargs=2, default=(160, 90))
    given = parser.parse_args()
    import bpy

    import addon

    addon.register()
    given.out.mkdir(parents=True, exist_ok=True)
    parts = given.scenes.split(",")
    for name in (name for name in SCENES if any(part in name for part in parts)):
        scene = build(bpy, name, tuple(given.size), given.lamps)
        start = time.process_time()
        ours = render_ours(scene, given.samples, given.method)[..., :3]
        seconds = time.process_time() - start
        kept = given.out / f"{name} {given.lamps:g} {given.cycles} {given.size[0]}.npy"
        if not kept.exists():
            np.save(kept, render_cycles(scene, given.cycles))
        truth = np.load(kept)[..., :3]
        _save(given.out / f"{name}.png", ours, truth)
        found = compare(ours, truth)
        difference = np.abs(srgb(ours) - srgb(truth)).mean()
        print(
            f"{name:20} ssim {found['ssim_srgb']:.4f} energy {found['energy']:.4f}"
            f" mean difference {difference:.4f} {seconds:.1f} s",
            flush=True,
        )


def render_ours(scene, samples, method):
    """Render with Aplanat: a fixed number of samples, a box filter as Cycles' here.

    Parameters
    ----------
    scene : bpy.types.Scene
    samples : int
    method : {'REFERENCE', 'ADAPTIVE', 'LAYERED'}

    Returns
    -------
    ndarray of shape (height, width, 4)
    """
    scene.render.engine = "APLANAT"
    own = scene.aplanat
    own.method, own.use_target_error, own.render_samples = method, False, samples
    own.pixel_filter, scene.render.filter_size = "BOX", 1.0
    return render_picture(scene)


def render_cycles(scene, samples):
    """Render with Cycles as a referee, with all that glass sends on.

    Parameters
    ----------
    scene : bpy.types.Scene
    samples : int

    Returns
    -------
    ndarray of shape (height, width, 4)
    """
    use_cycles(scene, samples)
    cycles = scene.cycles
    cycles.max_bounces = cycles.glossy_bounces = cycles.transmission_bounces = 12
    cycles.diffuse_bounces, cycles.transparent_max_bounces = 0, 16
    return render_picture(scene)


def _save(path, ours, truth):
    import imageio.v3 as iio

    a, b = srgb(ours), srgb(truth)
    strip = np.concatenate([a, b, np.clip(np.abs(a - b) * 4, 0, 1)], axis=1)
    iio.imwrite(path, np.rint(strip * 255).astype(np.uint8))


if __name__ == "__main__":
    main()
