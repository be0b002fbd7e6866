"""What a view change costs with very many instances, beside one pinhole pass of the same scene.

    python -m benchmarks.scale.view_changes
    python -m benchmarks.scale.view_changes --instances 10000 --profile

The scene is a field of small objects, instanced by geometry nodes, with a lens. A view change is
what the viewport does when its camera has moved: plan, choice of the levels of detail, preparation
of the frame, first lens sample. Processor time, not time on the wall: other programs may be busy.
"""

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))

_SIZE = (480, 270)
# Views of the round; the middle one's times count.
_VIEWS = 5


def field_of_instances(bpy, count, objects=False):
    """Make the current file a field of small objects before a camera that focuses into it.

    Parameters
    ----------
    bpy : module
    count : int
        Of instances.
    objects : bool
        Each has an object of its own; else geometry nodes put them there.
    """
    import numpy as np

    from benchmarks.scenes.materials import emission

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = _SIZE
    scene.render.resolution_percentage = 100
    rng = np.random.default_rng(1)
    for number, part in enumerate(np.array_split(np.arange(count), 2)):
        places = rng.uniform((-12, 2, -8), (12, 40, 8), (len(part), 3))
        paint = emission(bpy, f"paint {number}", (0.8, 0.3 + 0.4 * number, 0.2))
        bpy.ops.mesh.primitive_cube_add(size=0.08, location=(0.0, -9.0, 0.0))
        source = bpy.context.object
        data = source.data
        data.materials.append(paint)
        if objects:
            for i, place in enumerate(places.tolist()):
                obj = bpy.data.objects.new(f"{number} {i}", data)
                obj.location = place
                scene.collection.objects.link(obj)
        else:
            _put_on_points(bpy, source, places)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.rotation_euler = (np.pi / 2, 0.0, 0.0)
    camera.data.dof.use_dof = True
    camera.data.dof.focus_distance, camera.data.dof.aperture_fstop = 9.0, 0.4
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def _put_on_points(bpy, source, places):
    """Put instances of an object on points, with geometry nodes."""
    points = bpy.data.meshes.new("points")
    points.from_pydata(places.tolist(), [], [])
    tree = bpy.data.node_groups.new("on points", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    names = ("GeometryNodeInstanceOnPoints", "GeometryNodeObjectInfo")
    start, copies, info, end = map(tree.nodes.new, ("NodeGroupInput", *names, "NodeGroupOutput"))
    info.inputs["Object"].default_value = source
    info.inputs["As Instance"].default_value = True
    for out, into in (
        (start.outputs[0], copies.inputs["Points"]),
        (info.outputs["Geometry"], copies.inputs["Instance"]),
        (copies.outputs["Instances"], end.inputs[0]),
    ):
        tree.links.new(out, into)
    obj = bpy.data.objects.new("on points", points)
    obj.modifiers.new("nodes", "NODES").node_group = tree
    bpy.context.scene.collection.objects.link(obj)


def pinhole_seconds(bench, snapshot):
    """Return the processor seconds of one pass through a pinhole, prepared beforehand."""
    from addon.engine.planning.plan import plan_frame

    sampling = replace(
        snapshot.sampling, method="REFERENCE", lens_samples=2, target_error=None, progressive=False
    )
    camera = replace(snapshot.camera, lens=None, bokeh=None)
    still = replace(snapshot, camera=camera, sampling=sampling)
    plan = replace(plan_frame(still), subpixels=1)
    with bench.renderer(still, plan) as renderer:
        renderer.advance(1)
        renderer.wait()
        start = time.process_time()
        renderer.advance(1)
        renderer.wait()
        return time.process_time() - start


class ViewChanges:
    """Changes the view of a scene again and again, as a viewport does.

    Parameters
    ----------
    bench : benchmarks.benches.frames.BenchScene
    snapshot : SceneSnapshot
    """

    def __init__(self, bench, snapshot):
        self._bench, self._snapshot = bench, snapshot
        self._renderer = None

    def change(self, number):
        """Turn the camera a little, and draw the first sample; return seconds by stage."""
        import numpy as np

        from addon.engine.frame.pipeline import FrameRenderer
        from addon.engine.planning.plan import plan_frame
        from addon.levels.choosing import meshes_with_levels

        turned = np.eye(4)
        cos, sin = np.cos(0.02 * number), np.sin(0.02 * number)
        turned[np.ix_((0, 2), (0, 2))] = [[cos, sin], [-sin, cos]]
        camera = replace(self._snapshot.camera, view=turned @ self._snapshot.camera.view)
        snapshot = replace(self._snapshot, camera=camera)
        seconds, start = {}, time.process_time()

        def note(stage):
            nonlocal start
            now = time.process_time()
            seconds[stage], start = now - start, now

        plan = plan_frame(snapshot)
        note("plan")
        meshes_with_levels(snapshot.content, plan)
        note("levels")
        if self._renderer is None:
            self._renderer = FrameRenderer(plan, snapshot, self._bench._buffers, "LATER")
        else:
            self._renderer.restart(plan, snapshot, "LATER")
        note("prepare")
        self._renderer.advance(1)
        note("draw calls")
        self._renderer.wait()
        note("device")
        return seconds

    def close(self):
        """Release the picture."""
        self._renderer.release()


def measure(bpy, count, method, bokeh, objects=False, profile=False):
    """Print what view changes of a scene with `count` instances cost."""
    from addon.scene.settings import read_preview_sampling
    from benchmarks.benches.frames import BenchScene

    scene = field_of_instances(bpy, count, objects)
    scene.aplanat.method = method
    start = time.process_time()
    bench = BenchScene(scene)
    print(f"{count} instances, {method}: read and sent in {time.process_time() - start:.2f} s")
    try:
        snapshot = replace(bench.snapshot, sampling=read_preview_sampling(scene))
        if not bokeh:
            snapshot = replace(snapshot, camera=replace(snapshot.camera, bokeh=None))
        limit = pinhole_seconds(bench, snapshot)
        changes = ViewChanges(bench, snapshot)
        first = sum(changes.change(0).values())
        runs = [changes.change(1 + i) for i in range(_VIEWS)]
        runs.sort(key=lambda run: sum(run.values()))
        middle = runs[_VIEWS // 2]
        total = sum(middle.values())
        stages = ", ".join(f"{name} {seconds:.3f}" for name, seconds in middle.items())
        print(
            f"  pinhole pass {limit:.3f} s; first view {first:.3f} s; a change {total:.3f} s"
            f" ({stages}): {total / limit:.2f} times the pass",
            flush=True,
        )
        if profile:
            import cProfile
            import pstats

            profiler = cProfile.Profile()
            profiler.runcall(changes.change, _VIEWS + 2)
            pstats.Stats(profiler).sort_stats("tottime").print_stats(25)
            pstats.Stats(profiler).sort_stats("cumtime").print_stats(45)
        changes.close()
    finally:
        bench.close()


def main(words=None):
    """Print a line for each method."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--instances", type=int, default=100_000)
    parser.add_argument("--methods", nargs="+", default=["ADAPTIVE", "REFERENCE"])
    parser.add_argument("--bokeh", action="store_true", help="with highlights as discs")
    parser.add_argument("--objects", action="store_true", help="an object for each instance")
    parser.add_argument("--profile", action="store_true", help="tell where the time goes")
    options = parser.parse_args(words)
    import bpy

    import addon
    from addon.device.context import ensure_context

    addon.register()
    ensure_context()
    for method in options.methods:
        measure(bpy, options.instances, method, options.bokeh, options.objects, options.profile)


if __name__ == "__main__":
    main()
