"""Render the frames of a scene in many orders and processes, and compare every bit of every pass.

One process forwards, one backwards, one with Persistent Data, chunks, and a process for each frame;
each with an empty cache of its own, and again with one that another order has filled. Then chunks
and single frames by `aplanat render`, whose files are compared. Exit code 1 if a bit differs.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY))
from benchmarks.scenes import frame_orders  # noqa: E402  (after the path is set)


def main():
    """Render, compare, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--blend", help="a scene of your own; default: one of all that is kept")
    parser.add_argument("--frames", type=int, default=24)
    parser.add_argument("--chunk", type=int, default=5)
    parser.add_argument("--lens", default="double-gauss-50mm-f2", help="'' for a thin lens")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        sys.exit(0 if compare(Path(folder), arguments) else 1)


def compare(folder, arguments):
    """Return whether all orders agree."""
    blend = arguments.blend or _built(folder / "scene.blend", arguments.lens)
    frames = list(range(1, arguments.frames + 1))
    chunks = [frames[i : i + arguments.chunk] for i in range(0, len(frames), arguments.chunk)]
    truth, same = None, True
    # Run, its processes, persistent data, folder of the cache; the same folder again is warm.
    for name, parts, persistent, cache in (
        ("forwards", [frames], False, "a"),
        ("backwards", [frames[::-1]], False, "b"),
        ("backwards, warm", [frames[::-1]], False, "a"),
        ("persistent data", [frames], True, "c"),
        ("persistent data, backwards, warm", [frames[::-1]], True, "b"),
        (f"chunks of {arguments.chunk}", chunks, False, None),
        (f"chunks of {arguments.chunk}, warm", chunks[::-1], False, "a"),
        ("a process for each frame", [[frame] for frame in frames], False, None),
        ("a process for each frame, warm", [[frame] for frame in frames], True, "c"),
    ):
        hashes, work = {}, []
        for number, part in enumerate(parts):
            place = folder / (cache or f"{name} {number}")
            found = _worker(blend, part, persistent, place)
            hashes |= found["hashes"]
            work.append(found["work"]["decimations"])
        truth = truth or hashes
        differing = [frame for frame, digest in hashes.items() if truth.get(frame) != digest]
        same &= not differing and hashes.keys() == truth.keys()
        print(
            f"{name:34} {len(parts):3} processes, {sum(work):3} meshes simplified:"
            f" {'differs in ' + ', '.join(differing) if differing else 'the same bits'}",
            flush=True,
        )
    return _compare_files(folder, blend, frames, chunks) and same


def _built(path, lens):
    code = (
        f"import sys; sys.path.insert(0, {str(REPOSITORY)!r}); import bpy, addon; addon.register();"
        f" from benchmarks.scenes import frame_orders; frame_orders.build(bpy, {lens!r});"
        f" bpy.ops.wm.save_as_mainfile(filepath={str(path)!r})"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
    return path


def _worker(blend, frames, persistent, cache):
    words = [sys.executable, frame_orders.__file__, str(blend)]
    words += ["--frames", ",".join(map(str, frames)), *["--persistent"] * persistent]
    return json.loads(_run(words, cache).splitlines()[-1])


def _compare_files(folder, blend, frames, chunks):
    """Return whether `aplanat render` of chunks and of single frames give the same pixels."""
    found = {}
    for name, parts in (("chunk", chunks), ("single", [[frame] for frame in frames])):
        for number, part in enumerate(parts):
            words = [sys.executable, "-m", "addon.cli", "render", str(blend)]
            words += ["--frames", f"{part[0]}..{part[-1]}", "-o", str(folder / f"{name}_####.exr")]
            _run(words, folder / f"cli {name} {number}")
        found[name] = [_pixels(folder / f"{name}_{frame:04}.exr") for frame in frames]
    pairs = zip(frames, found["chunk"], found["single"], strict=True)
    differing = [frame for frame, a, b in pairs if a != b]
    print(f"aplanat render, files: {differing or 'the same bits'}")
    return not differing


def _pixels(path):
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {
            (part.name(), name): channel.pixels.tobytes()
            for part in file.parts
            for name, channel in part.channels.items()
        }


def _run(words, cache):
    done = subprocess.run(
        words,
        env=os.environ | {"APLANAT_CACHE": str(cache)},
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        sys.exit(f"{' '.join(words)}\n{done.stderr}")
    return done.stdout


if __name__ == "__main__":
    main()
