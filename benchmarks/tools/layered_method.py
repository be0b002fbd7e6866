"""The layered method against the reference method: how alike, and what it costs.

    python -m benchmarks.tools.layered_method --scene toys --resolution 480x270

Shared test scenes (built by `aplanat bench`), highlights as everything else. For each number of
samples: SSIM and energy against the reference method, processor time, SSIM against the most samples
with thin rays; with thin rays and with cones; and the share of layers that rays had to look into.
With --complexity instead: processor time of 128 samples once layers are drawn, of the scene and
with four times the triangles.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))


def arguments(words=None):
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", metavar="NAME", help="default: toys")
    parser.add_argument("--look", choices=("flat", "lit"), default="flat")
    parser.add_argument("--resolution", default="240x135", metavar="WxH")
    parser.add_argument("--samples", type=int, nargs="+", default=[32, 256])
    parser.add_argument("--reference", type=int, default=512, help="samples of the reference")
    parser.add_argument("--layers", type=int, default=8)
    parser.add_argument("--complexity", action="store_true")
    return parser.parse_args(words)


def looked_into(bench, snapshot, plan):
    """Return the share of layers that the rays of a frame's first samples had to look into.

    Parameters
    ----------
    bench : BenchScene
    snapshot : SceneSnapshot
    plan : FramePlan

    Returns
    -------
    float
    """
    from addon.device import geometry, readback
    from addon.device.targets import Targets, TargetSpec

    with bench.renderer(snapshot, plan) as renderer:
        renderer.advance(1)
        size = (plan.width, plan.height)
        specs = [TargetSpec("color", "RGBA32F"), TargetSpec("depth", "DEPTH_COMPONENT32F")]
        totals = np.zeros(2)
        with Targets(*size, specs) as targets:
            framebuffer = targets.framebuffer("color", depth="depth")
            for index in range(min(16, plan.samples)):
                with framebuffer.bind():
                    renderer.layered.cast(index, geometry.fullscreen_batch(), counts=True)
                found = readback.read_color(framebuffer, *size)
                totals += found[..., :2].sum(axis=(0, 1))
        return float(totals[1] / totals[0])


def drawn_seconds(bench, layers, samples=128, times=3):
    """Return the least time of lens samples once the layers are drawn, and the scene's triangles.

    Parameters
    ----------
    bench : BenchScene
    layers, samples, times : int

    Returns
    -------
    seconds : float
    triangles : int
    """
    from addon.engine.planning.plan import plan_frame

    snapshot = bench.sampled("LAYERED", samples + 1, layers=layers)
    content = snapshot.content
    triangles = sum(len(content.meshes[g.mesh].triangles) * g.count for g in content.groups)
    found = []
    for _ in range(times):
        with bench.renderer(snapshot, plan_frame(snapshot)) as renderer:
            renderer.advance(1)
            renderer.wait()
            begun = time.process_time()
            renderer.advance(samples)
            renderer.wait()
            found.append(time.process_time() - begun)
    return min(found), triangles


def subdivide(meshes):
    """Cut every triangle of meshes into four, where it is."""
    import bmesh

    for mesh in meshes:
        cut = bmesh.new()
        cut.from_mesh(mesh)
        bmesh.ops.triangulate(cut, faces=cut.faces)
        bmesh.ops.subdivide_edges(cut, edges=cut.edges, cuts=1, use_grid_fill=True)
        cut.to_mesh(mesh)
        cut.free()


def main(words=None):
    """Measure and print, a line a setting."""
    options = arguments(words)
    import bpy

    import addon
    from addon.device.context import ensure_context
    from addon.engine.planning.plan import plan_frame
    from benchmarks.benches.frames import BenchScene
    from benchmarks.referees.picture_metrics import compare

    addon.register()
    ensure_context()
    width, height = map(int, options.resolution.split("x"))
    for name in options.scene or ["toys"]:
        file = REPOSITORY / "build" / "scenes" / f"{name}_{options.look}.blend"
        bpy.ops.wm.open_mainfile(filepath=str(file))
        scene = bpy.context.scene
        scene.render.engine = "APLANAT"
        scene.render.resolution_x, scene.render.resolution_y = width, height
        scene.render.resolution_percentage = 100
        bench = BenchScene(scene)
        if options.complexity:
            for _ in range(2):
                seconds, triangles = drawn_seconds(bench, options.layers)
                print(f"{name}: {triangles:,} triangles: {seconds:.2f} s", flush=True)
                subdivide(bpy.data.meshes)
                bench = BenchScene(scene)
            continue
        begun = time.process_time()
        truth = bench.draw(bench.sampled("REFERENCE", options.reference)).picture
        print(f"{name}: reference {options.reference}: {time.process_time() - begun:.1f} s")
        most = max(options.samples)
        finest = bench.draw(bench.sampled("LAYERED", most, layers=options.layers, cones=False))
        for samples in options.samples:
            for cones in (False, True):
                snapshot = bench.sampled("LAYERED", samples, layers=options.layers, cones=cones)
                begun = time.process_time()
                picture = bench.draw(snapshot).picture
                found, itself = compare(picture, truth), compare(picture, finest.picture)
                print(
                    f"{name}: N {samples} {'cones' if cones else 'thin rays'}:"
                    f" SSIM {found['ssim_srgb']:.4f}, worst tile {found['ssim_tile']:.3f}, energy"
                    f" {found['energy']:.4f}, {time.process_time() - begun:.1f} s; against"
                    f" {most} thin rays SSIM {itself['ssim_srgb']:.4f}",
                    flush=True,
                )
        snapshot = bench.sampled("LAYERED", 16, layers=options.layers)
        share = looked_into(bench, snapshot, plan_frame(snapshot))
        print(f"{name}: layers looked into: {share:.3f}")


if __name__ == "__main__":
    main()
