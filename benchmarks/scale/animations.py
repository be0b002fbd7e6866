"""What each frame of an animation costs beside drawing, and what is sent to the device again.

    python -m benchmarks.scale.animations --scene SCENE.blend --frames 6
    python -m benchmarks.scale.animations --scene SCENE.blend --persistent --profile

The camera moves along and nothing else does; each frame is rendered as *Render Animation* and
`aplanat render` do. Processor time by stage, not time on the wall: other programs may be busy.
"""

import argparse
import sys
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))


def measure(bpy, scene, frames, profiler=None):
    """Render frames with a moving camera and print a line for each.

    Parameters
    ----------
    bpy : module
    scene : bpy.types.Scene
    frames : int
    profiler : cProfile.Profile, optional
        Of the frames from the second on.
    """
    from addon.engine.shared_resources import listen, resources

    place = scene.camera.location.copy()
    for number in range(frames):
        scene.camera.location = place
        scene.camera.location[0] += 0.02 * number
        scene.camera.keyframe_insert("location", frame=1 + number)
    with resources().open_session() as session:
        for number in range(frames):
            scene.frame_set(1 + number)
            if profiler and number:
                profiler.enable()
            start = time.process_time()
            with listen(session=session) as heard:
                bpy.ops.render.render()
            total = time.process_time() - start
            if profiler and number:
                profiler.disable()
            if heard.error:
                raise heard.error
            seconds, sent = heard.statistics.seconds, heard.statistics.uploads
            stages = ", ".join(f"{name} {spent:.3f}" for name, spent in seconds.items())
            kinds = ", ".join(f"{count} {kind}" for kind, count in sent.items() if count)
            print(f"frame {1 + number}: {total:.2f} s ({stages}); sent {kinds or 'nothing'}")


def main(words=None):
    """Print a line for each frame."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", required=True, help="a .blend file")
    parser.add_argument("--frames", type=int, default=4)
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--resolution", type=int, nargs=2, default=(120, 68))
    parser.add_argument("--persistent", action="store_true", help="with Persistent Data")
    parser.add_argument("--profile", action="store_true", help="tell where the time goes")
    options = parser.parse_args(words)
    import bpy

    import addon

    addon.register()
    bpy.ops.wm.open_mainfile(filepath=options.scene)
    scene = bpy.context.scene
    scene.render.engine = "APLANAT"
    scene.render.resolution_x, scene.render.resolution_y = options.resolution
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = options.persistent
    scene.aplanat.use_target_error = False
    scene.aplanat.render_samples = options.samples
    if not options.profile:
        measure(bpy, scene, options.frames)
        return
    import cProfile
    import pstats

    profiler = cProfile.Profile()
    measure(bpy, scene, options.frames, profiler)
    pstats.Stats(profiler).sort_stats("cumtime").print_stats(60)


if __name__ == "__main__":
    main()
