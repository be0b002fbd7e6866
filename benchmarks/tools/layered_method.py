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
# Values of attributes that are cut: field and width.
_FIELDS = {
    "FLOAT": ("value", 1),
    "FLOAT2": ("vector", 2),
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4),
    "BYTE_COLOR": ("color", 4),
}
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


def drawn_seconds(bench, layers, samples=128, times=2):
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
    """Cut every triangle of meshes into four, where it is; other faces become triangles first.

    Positions and the attributes of points and corners go on linearly.

    Parameters
    ----------
    meshes : iterable of bpy.types.Mesh
    """
    for mesh in meshes:
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        corners, points, slots = (
            np.empty(size, np.int32) for size in (3 * count, 3 * count, count)
        )
        mesh.loop_triangles.foreach_get("loops", corners)
        mesh.loop_triangles.foreach_get("vertices", points)
        mesh.loop_triangles.foreach_get("material_index", slots)
        corners, points = corners.reshape(-1, 3), points.reshape(-1, 3)
        kept = {}
        for attribute in mesh.attributes:
            field, width = _FIELDS.get(attribute.data_type, (None, 0))
            if field and attribute.domain in ("POINT", "CORNER"):
                values = np.empty(width * len(attribute.data), np.float32)
                attribute.data.foreach_get(field, values)
                kept[attribute.name] = (
                    attribute.data_type,
                    attribute.domain,
                    values.reshape(-1, width),
                )
        # Sides, the same from both triangles.
        ends = np.sort(np.stack([points, np.roll(points, -1, axis=1)], axis=-1), axis=-1)
        sides, middles = np.unique(ends.reshape(-1, 2), axis=0, return_inverse=True)
        middles = middles.reshape(-1, 3) + len(mesh.vertices)
        a, b, c = points.T
        ab, bc, ca = middles.T
        fours = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = np.stack([np.stack(each, axis=1) for each in fours], axis=1).reshape(-1)
        mesh.clear_geometry()
        total = 4 * count
        mesh.vertices.add(int(middles.max()) + 1 if count else 0)
        mesh.loops.add(3 * total)
        mesh.polygons.add(total)
        mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * total, 3, dtype=np.int32))
        mesh.loops.foreach_set("vertex_index", triangles.astype(np.int32))
        mesh.polygons.foreach_set("material_index", np.repeat(slots, 4))
        for name, (kind, domain, values) in kept.items():
            field = _FIELDS[kind][0]
            if domain == "POINT":
                found = np.concatenate([values, values[sides].mean(axis=1)])
            else:
                at = values[corners]
                half = 0.5 * (at + np.roll(at, -1, axis=1))
                (a, b, c), (ab, bc, ca) = at.swapaxes(0, 1), half.swapaxes(0, 1)
                fours = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
                found = np.stack([np.stack(each, axis=1) for each in fours], axis=1)
            attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, domain)
            attribute.data.foreach_set(field, np.ascontiguousarray(found, np.float32).ravel())
        mesh.update(calc_edges=True)


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
            found = []
            for turn in range(2):
                if turn:
                    bench.close()
                    subdivide(bpy.data.meshes)
                    bench = BenchScene(scene)
                seconds, triangles = drawn_seconds(bench, options.layers)
                found.append(seconds)
                print(f"{name}: {triangles:,} triangles: {seconds:.2f} s", flush=True)
            print(f"{name}: {found[1] / found[0]:.2f} times as long")
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
