"""Digests of rendered pictures: whether a change of the code changes a single bit of any.

    python -m benchmarks.tools.picture_digests -o before.json
    ... the change ...
    python -m benchmarks.tools.picture_digests --against before.json

Renders the shared test scenes (small, with the default settings) and random scenes of the tests'
generator, every pass of each, and writes a digest a scene. Scenes that Blender itself evaluates in
another order each time, and scenes with a time limit, are told and left out.
"""

import argparse
import hashlib
import json
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))

SIZE = (96, 54)
NAMES = ("toys", "balls", "street", "fishes", "christmas_tree", "toy_dinosaurs", "dragons")


def arguments(words=None):
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="write the digests")
    parser.add_argument("--against", type=Path, metavar="FILE", help="compare with these")
    parser.add_argument("--seed", type=int, default=7, help="of the random scenes")
    parser.add_argument("--count", type=int, default=100, help="random scenes; default 100")
    parser.add_argument("--no-shared", action="store_true", help="random scenes only")
    return parser.parse_args(words)


def digest(pictures):
    """Return a digest of the pixels of all passes.

    Parameters
    ----------
    pictures : dict of (str, str) to ndarray of shape (height, width, channels)
    """
    found = hashlib.sha256()
    for (layer, name), pixels in sorted(pictures.items()):
        found.update(f"{layer}:{name}:{pixels.shape}".encode())
        found.update(pixels.tobytes())
    return found.hexdigest()


def shared_digests(bpy, render):
    """Yield name and digest of each shared scene that was built (see `aplanat bench`)."""
    for name in NAMES:
        for look in ("flat", "lit"):
            file = REPOSITORY / "build" / "scenes" / f"{name}_{look}.blend"
            if not file.is_file():
                continue
            bpy.ops.wm.open_mainfile(filepath=str(file))
            scene = bpy.context.scene
            scene.render.engine = "APLANAT"
            scene.render.resolution_x, scene.render.resolution_y = SIZE
            scene.render.resolution_percentage = 100
            yield file.stem, digest(render(scene))


def random_digests(bpy, render, seed, count):
    """Yield name and digest of random scenes; None where Blender or a clock decides."""
    from benchmarks.zoo.blenders_part import digests_of_scenes
    from benchmarks.zoo.judge import Fault
    from benchmarks.zoo.scenes.recipe import make_recipe
    from benchmarks.zoo.scenes.script import build

    for number in range(count):
        recipe = json.loads(json.dumps(make_recipe(bpy, seed, number)))
        scene = build(recipe)
        if scene.aplanat.render_time_limit > 0.0:
            yield f"{seed}:{number}", None
            continue
        with digests_of_scenes() as given:
            try:
                found = digest(render(scene))
            except Fault as fault:
                found = str(fault)
        # What Blender handed over is part of the name: with another scene, another picture is due.
        scenes = hashlib.sha256("".join(given).encode()).hexdigest()[:12]
        yield f"{seed}:{number}:{scenes}", found


def main(words=None):
    """Write or compare digests; returns 0 only if none differs."""
    options = arguments(words)
    import bpy

    import addon
    from benchmarks.zoo.judge import render

    addon.register()
    found = {} if options.no_shared else dict(shared_digests(bpy, render))
    found.update(random_digests(bpy, render, options.seed, options.count))
    if options.output:
        options.output.write_text(json.dumps(found, indent=1))
    if not options.against:
        return 0
    before = json.loads(options.against.read_text())
    both = [name for name in found if before.get(name) and found[name]]
    different = [name for name in both if found[name] != before[name]]
    print(
        f"{len(both)} scenes compared, {len(different)} differ; {len(found) - len(both)} left out"
    )
    for name in different:
        print(f"  {name}")
    return 1 if different or not both else 0


if __name__ == "__main__":
    sys.exit(main())
