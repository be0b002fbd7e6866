"""Run a farm's job by openjd-cli: 24 frames in chunks of 5, one of which fails on purpose.

openjd-cli ends a session at the first task that fails; what a farm goes on with is run after that.
Exit code 1 if a frame is missing or one too many, or if the failing chunk's log lacks our line.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
TEMPLATE = REPOSITORY / "farm" / "openjd" / "aplanat_shot.yaml"


def main():
    """Run the job, and print what each task did."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--chunk", type=int, default=5)
    parser.add_argument("--failing", type=int, default=13)
    parser.add_argument("--make", choices=("render", "capture"), default="render")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        sys.exit(0 if judge(Path(folder), arguments) else 1)


def judge(folder, arguments):
    """Return whether the job made the right frames and told why the others are missing."""
    blend = build_shot(folder / "shot.blend", arguments.failing)
    out = folder / "out"
    frames = list(range(1, arguments.frames + 1))
    chunks = [frames[i : i + arguments.chunk] for i in range(0, len(frames), arguments.chunk)]
    failing = next(chunk for chunk in chunks if arguments.failing in chunk)
    begun = time.monotonic()
    code, log = run(blend, out, arguments)
    right = code == 1
    told = [line for line in log if line.startswith("aplanat: ")]
    print(f"the job: exit code {code}; the last line of ours:\n    {told[-1]}")
    right &= told[-1].startswith(f"aplanat: frame {arguments.failing}: ")
    rest = [{"Frame": f"{c[0]}-{c[-1]}"} for c in chunks[chunks.index(failing) + 1 :]]
    if rest:
        code, _ = run(blend, out, arguments, "--tasks", json.dumps(rest))
        print(f"the other chunks: exit code {code}")
        right &= code == 0
    made = sorted(int(re.search(r"\d+", path.name)[0]) for path in out.iterdir())
    wanted = [f for f in frames if f not in failing or f < arguments.failing]
    print(f"frames there: {made}; {time.monotonic() - begun:.0f} s")
    return right and made == wanted


def build_shot(path, failing):
    """Save a small scene whose camera is panoramic in one frame, and return its path."""
    import bpy

    sys.path.insert(0, str(REPOSITORY))
    import addon
    from benchmarks.scenes.small_scene import build_scene

    addon.register()
    try:
        scene = build_scene(bpy)
        scene.cycles.samples = 1
        camera, panorama = scene.objects["Camera"], scene.objects["Second"]
        panorama.data.type = "PANO"
        for frame, seen in ((1, camera), (failing, panorama), (failing + 1, camera)):
            scene.timeline_markers.new("cut", frame=frame).camera = seen
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    finally:
        addon.unregister()
    return path


def run(blend, out, arguments, *words):
    """Run the template; return the exit code and the lines of the log, without their times."""
    engine = "--engine APLANAT --layers 2" if arguments.make == "capture" else "--samples 2"
    parameters = {
        "Action": arguments.make,
        "SceneFile": blend,
        "Frames": f"1-{arguments.frames}",
        "FramesPerTask": arguments.chunk,
        "OutputFolder": out,
        "Options": f"--resolution 32x24 {engine}",
        "Blender": REPOSITORY / "scripts" / "aplanat",
    }
    given = [word for key, value in parameters.items() for word in ("-p", f"{key}={value}")]
    done = subprocess.run(
        [sys.executable, "-m", "openjd", "run", str(TEMPLATE), *words, *given],
        capture_output=True,
        text=True,
    )
    return done.returncode, [re.sub(r"^\S+\t", "", line) for line in done.stdout.splitlines()]


if __name__ == "__main__":
    main()
