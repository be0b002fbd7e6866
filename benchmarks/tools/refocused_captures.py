"""A capture by Cycles, seen through lenses afterwards, against Cycles' own depth of field.

    python -m benchmarks.tools.refocused_captures --scene toys --focus 1.2 2.0 4.0 --fstop 0.5 1.4

For each focus distance and f-number: SSIM, worst tile and energy against what two pictures by
Cycles' lens with half of the samples each have in common (their noise is not counted, see
`compare_with_two`); the processor time of refocusing, and that of the number of Cycles' samples,
doubled until it is as much alike, or takes ten times as long. Before: processor times of one
Cycles render without a lens, of the capture, and of starting Blender with Aplanat, which is part of
refocusing and not of Cycles' times.
Pictures are kept in a folder, and used again if they are there; times belong to new ones.
"""

import argparse
import os
import resource
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))


# Refocusing is to be faster by that: Cycles need not be given more time.
_TIMES_FASTER = 10.0
_START = (
    "import bpy, addon; addon.register();"
    " from addon.device.context import ensure_context; ensure_context()"
)


def arguments(words=None):
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--scene", default="toys", metavar="NAME|FILE.blend")
    add("--look", choices=("flat", "lit"), default="lit")
    add("--resolution", default="240x135", metavar="WxH")
    add("--layers", type=int, default=8)
    add("--capture-samples", type=int, default=64)
    add("--denoise", action="store_true", help="denoise the capture")
    add("--truth-samples", type=int, default=2048, help="of both pictures by Cycles together")
    add("--samples", type=int, default=128, help="lens samples of refocusing")
    add("--focus", type=float, nargs="+", metavar="M", help="default: the scene's")
    add("--fstop", type=float, nargs="+", metavar="X", help="default: the scene's")
    add("--no-bokeh", action="store_true")
    add("--folder", type=Path, default=Path("/tmp/refocused"))
    add("--no-ladder", action="store_true", help="do not look for Cycles' time at equal SSIM")
    return parser.parse_args(words)


def processor_seconds(command):
    """Run a command and return the processor time that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = os.environ | {"PYTHONPATH": str(REPOSITORY)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}: {done.stderr or done.stdout}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(words=None):
    """Measure and print, a line a lens."""
    options = arguments(words)
    from benchmarks.referees.cycles_shot import cycles_shot
    from benchmarks.referees.picture_metrics import compare_with_two, read_picture

    options.folder.mkdir(parents=True, exist_ok=True)
    folder = options.folder
    file = Path(options.scene)
    if file.suffix != ".blend":
        file = REPOSITORY / "build" / "scenes" / f"{options.scene}_{options.look}.blend"
    name = file.stem
    size = [int(side) for side in options.resolution.split("x")]
    common = {"file": str(file), "size": size, "denoise": options.denoise, "seed": 0}
    shot = folder / f"{name}.blend"
    own = cycles_shot(**common, samples=options.capture_samples, save=str(shot))
    once = cycles_shot(
        **common,
        samples=options.capture_samples,
        pinhole=True,
        output=str(folder / f"{name}_pinhole.exr"),
    )["seconds"]
    kind = f"{options.capture_samples}{'_denoised' if options.denoise else ''}"
    layers = folder / f"{name}_layers_{options.layers}_{kind}.exr"
    aplanat = [sys.executable, "-P", "-m", "addon.cli"]
    if not layers.exists():
        words = ["capture", shot, "-o", layers, "--layers", options.layers]
        seconds = processor_seconds([*aplanat, *map(str, words)])
        print(f"{name}: one Cycles render {once:.1f} s, capture {seconds:.1f} s", flush=True)
    start = processor_seconds([sys.executable, "-P", "-c", _START])
    print(f"{name}: starting Blender {start:.1f} s", flush=True)
    for focus in options.focus or [own["focus"]]:
        for fstop in options.fstop or [own["fstop"]]:
            lens = {"focus": focus, "fstop": fstop}
            told = common | {"denoise": False} | lens
            truths = _truths(folder / f"{name}_truth_{focus:g}_{fstop:g}", told, options)
            output = folder / f"{name}_refocused_{focus:g}_{fstop:g}.exr"
            words = ["refocus", layers, "-o", output, "--focus", focus, "--fstop", fstop]
            words += ["--samples", options.samples, *["--no-bokeh"] * options.no_bokeh]
            seconds = processor_seconds([*aplanat, *map(str, words)])
            found = compare_with_two(read_picture(output), *truths)
            line = (
                f"{name}: focus {focus:g} m, f/{fstop:g}: SSIM {found['ssim_srgb']:.4f}, worst tile"
                f" {found['ssim_tile']:.3f}, energy {found['energy']:.4f}; {seconds:.1f} s with"
                f" starting Blender, {seconds - start:.1f} s without"
            )
            if not options.no_ladder:
                line += _ladder(told, found["ssim_srgb"], truths, folder, seconds)
            print(line, flush=True)


def _truths(stem, told, options):
    """Return two pictures by Cycles with other seeds, rendered if they are not there yet."""
    from benchmarks.referees.cycles_shot import cycles_shot
    from benchmarks.referees.picture_metrics import read_picture

    samples, found = options.truth_samples // 2, []
    for seed in (0, 1):
        file = stem.with_name(f"{stem.name}_{samples}_{seed}.exr")
        if not file.exists():
            part = file.with_suffix(".part")
            cycles_shot(**told | {"seed": seed}, samples=samples, output=str(part))
            part.replace(file)
        found.append(read_picture(file))
    return found


def _ladder(told, wanted, truths, folder, own_seconds):
    from benchmarks.referees.cycles_shot import cycles_shot
    from benchmarks.referees.picture_metrics import compare_with_two, read_picture

    output = folder / "cycles_ladder.exr"
    for power in range(3, 16):
        shot = cycles_shot(**told | {"seed": 2}, samples=2**power, output=str(output))
        alike = compare_with_two(read_picture(output), *truths)["ssim_srgb"]
        if alike >= wanted or shot["seconds"] > _TIMES_FASTER * own_seconds:
            break
    return f"; Cycles with {2**power} samples {alike:.4f} in {shot['seconds']:.1f} s"


if __name__ == "__main__":
    main()
