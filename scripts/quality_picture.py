"""Draws where a noise threshold puts its lens samples: the picture of docs/quality.md.

Usage: scripts/quality_picture.py [--scene FILE] [--target-error X] [--resolution WxH] [-o FILE]

Run it with the checkout's Python (.venv/bin/python) after scripts/demo. It renders the scene with
the pass Sample Count and shows the picture beside the samples of each tile.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

REPO = Path(__file__).resolve().parents[1]


def with_sample_count(scene, folder):
    """Save a copy of a scene that has the pass; return its path."""
    import bpy

    sys.path.insert(0, str(REPO))
    from addon import registration

    registration.register()
    bpy.ops.wm.open_mainfile(filepath=str(scene))
    for layer in bpy.context.scene.view_layers:
        layer.aplanat.use_pass_sample_count = True
    copy = folder / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(copy), copy=True)
    return copy


def render(scene, folder, options):
    """Render the copy; return the picture, the samples of its pixels and the noise statistics."""
    import imageio.v3 as iio
    import OpenEXR

    files = {ending: folder / f"picture.{ending}" for ending in ("exr", "png", "json")}
    subprocess.run(
        [REPO / "scripts/aplanat", "render", scene, "-o", files["exr"], "-o", files["png"]]
        + ["--stats", files["json"], *options],
        check=True,
    )
    with OpenEXR.File(str(files["exr"]), separate_channels=True) as file:
        channels = {name: c.pixels for part in file.parts for name, c in part.channels.items()}
    counts = next(pixels for name, pixels in channels.items() if "Sample Count" in name)
    return iio.imread(files["png"])[..., :3], counts, json.loads(files["json"].read_text())["noise"]


def draw(picture, counts, noise, path):
    """Draw the picture beside the samples of its tiles."""
    import matplotlib

    matplotlib.use("Agg")
    import numpy as np
    from matplotlib import pyplot

    height, width = counts.shape
    figure, (left, right) = pyplot.subplots(
        1, 2, figsize=(13.0, 13.0 / 2 * height / width + 0.75), layout="constrained"
    )
    left.imshow(picture)
    left.set_title(f"error {noise['error']:.4f}, asked for {noise['target']:.3g}", fontsize=11)
    shown = right.imshow(np.log2(counts), cmap="magma", interpolation="nearest")
    right.set_title(f"lens samples, {noise['samples_mean']:.0f} on the average", fontsize=11)
    ticks = np.arange(np.floor(np.log2(counts.min())), np.log2(counts.max()) + 1e-6)
    bar = figure.colorbar(shown, ax=right, ticks=ticks, shrink=0.9)
    bar.ax.set_yticklabels([f"{2**tick:.0f}" for tick in ticks])
    for axes in (left, right):
        axes.set_axis_off()
    figure.savefig(path, dpi=100, pil_kwargs={"quality": 88})


def main():
    """Read the options and draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--scene", type=Path, default=REPO / "build/demo/demo.blend")
    parser.add_argument("--target-error", default="0.005")
    parser.add_argument("--resolution", default="480x270")
    parser.add_argument("-o", "--output", type=Path, default=REPO / "docs/images/quality.jpg")
    arguments = parser.parse_args()
    options = ["--target-error", arguments.target_error, "--resolution", arguments.resolution]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        found = render(with_sample_count(arguments.scene, folder), folder, options)
        draw(*found, arguments.output)


if __name__ == "__main__":
    main()
