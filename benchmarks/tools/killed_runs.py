"""Kill a command that makes a sequence at a random moment, start it again, and look at its files.

Each trial: every file that the killed process left is whole, the second run leaves what was
finished (`refocus` makes all anew), and in the end each byte is that of an unkilled run. Exit code
1 if not.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import OpenEXR

REPOSITORY = Path(__file__).resolve().parents[2]
# A frame is some renders of a few pixels.
_CAPTURE = ("--layers", "2", "--overscan", "0")
_SIZE = (32, 18)
_REFOCUS = ("--samples", "64", "--fstop", "1")


@dataclass(frozen=True)
class Trial:
    """What a run that was killed and started again left.

    Parameters
    ----------
    seconds : float
        From `after` to the kill; None if it had ended before.
    finished : int
        Frames that were there then.
    broken : list of str
        Files that were not whole, or no pictures at all.
    redone : list of str
        Finished files that the second run wrote again.
    different : list of str
        Files that are not those of the unkilled run, bit by bit, or are missing.
    """

    seconds: float | None
    finished: int
    broken: list
    redone: list
    different: list


def main():
    """Try as often as was asked, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--command", choices=("capture", "render", "refocus"), default="capture")
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--trials", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        blend = build_shot(Path(folder) / "shot.blend", arguments.frames)
        done = list(trials(blend, Path(folder), arguments))
    kept = arguments.command != "refocus"
    faults = [t for t in done if t.broken or t.different or (kept and t.redone)]
    print(f"{arguments.command}: {len(done)} trials, {len(faults)} with a fault")
    sys.exit(1 if faults else 0)


def build_shot(path, frames):
    """Save a small scene whose frames differ, and return its path; Aplanat gets registered.

    Parameters
    ----------
    path : Path
    frames : int

    Returns
    -------
    Path
    """
    import bpy

    sys.path.insert(0, str(REPOSITORY))
    import addon
    from benchmarks.scenes.capture_scene import build

    addon.register()
    try:
        save_shot(bpy, build(bpy), path, frames)
    finally:
        addon.unregister()
    return path


def save_shot(bpy, scene, path, frames):
    """Have something move in a scene, and save it so that no file is written twice."""
    near = scene.objects["Near"]
    for frame, x in ((1, -0.6), (frames, 0.6)):
        near.location.x = x
        near.keyframe_insert("location", frame=frame)
    scene.frame_start, scene.frame_end = 1, frames
    scene.render.resolution_x, scene.render.resolution_y = _SIZE
    scene.render.use_overwrite = False
    scene.cycles.samples = 1
    scene.aplanat.method = "REFERENCE"
    scene.aplanat.render_samples = 16
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)


def trials(blend, folder, arguments):
    """Yield a `Trial` for each kill, and print it.

    Parameters
    ----------
    blend : Path
    folder : Path
        An empty one, to work in.
    arguments : argparse.Namespace
        Command, frames, trials and seed.
    """
    moments = random.Random(arguments.seed)
    source = blend
    if arguments.command == "refocus":
        source = folder / "layers_####.exr"
        run(["capture", str(blend), *_CAPTURE, *_frames(arguments), "-o", str(source)])
    whole = folder / "whole"
    whole.mkdir()
    begun = time.time()
    run(words(source, whole, arguments))
    stamps = sorted(path.stat().st_mtime for path in whole.iterdir())
    pace = (stamps[-1] - stamps[0]) / max(1, len(stamps) - 1)
    truth = {path.name: path.read_bytes() for path in whole.iterdir()}
    assert len(truth) == arguments.frames, sorted(truth)
    print(
        f"an unkilled run: the first frame after {stamps[0] - begun:.1f} s, then {pace:.2f} s each"
    )
    for number in range(arguments.trials):
        out = folder / f"trial-{number}"
        out.mkdir()
        # Starting takes as long as many frames: only one of so many kills is before the first.
        after = moments.randrange(arguments.frames)
        seconds = moments.uniform(0.0, pace if after else stamps[0] - begun)
        trial = killed_once(words(source, out, arguments), out, truth, seconds, after)
        faults = {n: getattr(trial, n) for n in ("broken", "redone", "different")}
        told = ", ".join(f"{name}: {' '.join(found)}" for name, found in faults.items() if found)
        when = "had ended" if trial.seconds is None else f"killed {trial.seconds:5.2f} s after"
        when += f" {f'file {after}' if after else 'the start'}"
        print(f"{number + 1:3d}: {when}; {trial.finished} frames finished; {told or 'right'}")
        yield trial


def killed_once(command, folder, truth, seconds, after=0):
    """Start a command, kill it, start it again, and compare.

    Parameters
    ----------
    command : list of str
        Words of the command line, which write into the folder.
    folder : Path
    truth : dict of str to bytes
        Files of the unkilled run.
    seconds : float
        To the kill.
    after : int
        Files that have to be there before the time begins to run.

    Returns
    -------
    Trial
    """
    seconds = start_and_kill(command, folder, seconds, after)
    there = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    broken = [name for name in there if name not in truth or not is_whole(folder / name)]
    run(command)
    redone = [name for name, stamp in there.items() if (folder / name).stat().st_mtime_ns != stamp]
    left = {path.name: path.read_bytes() for path in folder.iterdir()}
    different = [n for n in sorted(truth.keys() | left.keys()) if truth.get(n) != left.get(n)]
    return Trial(seconds, len(there), broken, redone, different)


def start_and_kill(command, folder, seconds, after=0):
    """Start a command and kill it; parameters as of `killed_once`.

    Returns
    -------
    float
        Seconds to the kill; None if it had ended before.
    """
    process = subprocess.Popen(
        _program(command), env=_environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    while len(list(folder.iterdir())) < after and process.poll() is None:
        time.sleep(0.01)
    try:
        process.wait(seconds)
        seconds = None
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGKILL)
        process.wait()
    return seconds


def words(source, folder, arguments):
    """Return the words of the command of a run that writes into a folder."""
    more = {"capture": _CAPTURE, "render": (), "refocus": _REFOCUS}[arguments.command]
    output = str(folder / "f_####.exr")
    return [arguments.command, str(source), *more, *_frames(arguments), "-o", output]


def is_whole(path):
    """Whether every part of an EXR file can be read to its end."""
    with OpenEXR.File(str(path), header_only=True) as file:
        parts = len(file.parts)
    with OpenEXR.File(str(path)) as file:
        return len(file.parts) == parts and all(part.channels for part in file.parts)


def run(command):
    """Run a command of the checkout to its end.

    Raises
    ------
    subprocess.CalledProcessError
    """
    done = subprocess.run(_program(command), env=_environment(), capture_output=True, text=True)
    if done.returncode:
        print(done.stderr, file=sys.stderr)
    done.check_returncode()


def _frames(arguments):
    return ("--frames", f"1..{arguments.frames}")


def _program(command):
    return [sys.executable, "-P", "-m", "addon.cli", *command]


def _environment():
    return os.environ | {"PYTHONPATH": str(REPOSITORY), "PYTHONDONTWRITEBYTECODE": "1"}


if __name__ == "__main__":
    main()
