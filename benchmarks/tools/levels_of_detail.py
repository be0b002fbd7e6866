"""What levels of detail do to the light and the picture, against the reference method.

Each scene is drawn by the adaptive method with a fixed number of samples: with levels off, with
levels as chosen, and with every object forced to level 1, 2 and 3; and by the reference method.
Energy is a sum over the picture, of the channel that differs most.

With and without levels the same places on the lens are used, but a level moves each highlight and
edge a little, so that the samples hit others. The difference of the two pictures is so the levels'
own share, which any number of samples has, and noise, which falls with them and is no larger than
that between two pictures without levels. Seeds tell them apart. Of the differences ``d0`` and
``d1`` that levels make with two seeds, noise is independent and the own share is not: the mean of
``d0 d1`` is its square. Squares of the picture tell how sure that is; seeds are added, up to
--seeds, until the own share is surely above the bar or below.

    python -m benchmarks.tools.levels_of_detail                         # the shared scenes
    python -m benchmarks.tools.levels_of_detail fishes:flat --samples 256

Columns: energy as chosen and forced; PSNR of levels on against off; PSNR of another seed without
levels; the levels' own share and the least that it may be, twice its standard error worse; seeds.
Exit code 1 if a bar is missed or not decided: energy within 0.3 % as chosen and 1 % forced; PSNR
of the levels' own share 42 dB.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))

from addon.engine.drawing import group_levels  # noqa: E402  (after the path is set)
from addon.levels import choosing  # noqa: E402
from benchmarks.referees.picture_metrics import srgb  # noqa: E402
from benchmarks.tools.noise_threshold import SCENES, kept, opened  # noqa: E402

CHOSEN, FORCED, PSNR = 0.003, 0.01, 42.0
# Side of the squares of a picture that tell how sure a mean over it is, px: wider than what a
# sample's noise is alike in.
_SQUARE = 15


def main():
    """Measure and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cases", nargs="*", help="as of noise_threshold.py")
    parser.add_argument("--resolution", default="240x135")
    parser.add_argument("--samples", type=int, default=128)
    parser.add_argument("--seeds", type=int, default=6, help="at most")
    parser.add_argument("--folder", type=Path, default=REPOSITORY / "build" / "levels_of_detail")
    parser.add_argument("--label", default="", help="measure anew under this name")
    options = parser.parse_args()
    options.size = tuple(map(int, options.resolution.split("x")))
    options.cycles = False
    options.folder.mkdir(parents=True, exist_ok=True)
    results = kept(options, "levels.jsonl")
    cases = options.cases or [f"{name}:{look}" for look in ("flat", "lit") for name in SCENES]
    print(
        "| scene | chosen | level 1 | 2 | 3 | PSNR | other seed | own share | seeds | triangles |"
    )
    print("| --- " * 10 + "|")
    missed = False
    for case in cases:
        key = (case, options.resolution, options.samples, "reference")
        if key not in results.found:
            names = ("case", "size", "number", "reference")
            results.add(dict(zip(names, key, strict=True)) | measured(case, options))
        text, missing = line(results.found[key])
        missed |= missing
        print(text, flush=True)
    sys.exit(missed)


def measured(case, options):
    """Return what levels do to a case."""
    bench = opened(case, options)
    off, on, share = [], [], None
    while share is None or (not decided(*share) and len(on) < options.seeds):
        for seed in (0, 1) if share is None else (len(on),):
            off.append(picture(bench, options, seed, uses_levels=False)[0])
            found, work = picture(bench, options, seed)
            on.append(found)
        share = own_share([srgb(a) - srgb(b) for a, b in zip(on, off, strict=True)])
    snapshot = bench.sampled("REFERENCE", options.samples)
    right = bench.draw(replace(snapshot, passes=("Combined",))).picture
    found = {
        "off": ratio(np.mean(off, axis=0), right),
        "chosen": ratio(np.mean(on, axis=0), right),
        "forced": [ratio(forced(bench, options, level), right) for level in (1, 2, 3)],
        "psnr": decibels(np.square(srgb(on[0]) - srgb(off[0])).mean()),
        "other_seed": decibels(np.square(srgb(off[1]) - srgb(off[0])).mean()),
        "own": share,
        "seeds": len(on),
        "triangles": work["triangles_submitted"] / max(work["triangles_full_detail"], 1),
    }
    bench.close()
    return found


def own_share(differences):
    """Return the mean square of what all differences have in common, and its standard error.

    Parameters
    ----------
    differences : list of ndarray of shape (height, width, 3)
        That levels make, one a seed.

    Returns
    -------
    float, float
    """
    count, whole = len(differences), np.sum(differences, axis=0, dtype=np.float64)
    # The mean of the products of all pairs.
    squares = np.sum([np.square(each, dtype=np.float64) for each in differences], axis=0)
    products = ((np.square(whole) - squares) / (count * (count - 1))).mean(axis=2)
    height, width = (side // _SQUARE * _SQUARE for side in products.shape)
    means = products[:height, :width].reshape(height // _SQUARE, _SQUARE, -1, _SQUARE)
    means = means.mean(axis=(1, 3))
    return float(products.mean()), float(means.std() / np.sqrt(means.size))


def decided(square, error):
    """Whether a mean square is surely above the bar or surely below it."""
    bar = 10.0 ** (-PSNR / 10.0)
    return abs(square - bar) > 2.0 * error


def picture(bench, options, seed, **settings):
    """Draw a case by the adaptive method; return the picture and the counts of its work."""
    snapshot = bench.sampled("ADAPTIVE", options.samples, seed=seed, **settings)
    snapshot = replace(snapshot, passes=("Combined",))
    bench.make_levels(snapshot)
    found = bench.draw(snapshot)
    return found.picture, found.work


def forced(bench, options, level):
    """Draw a case with all objects at a level."""
    modules = (choosing, group_levels)
    own = [(m.choose_levels, m.allowed_levels) for m in modules]
    for module in modules:
        module.choose_levels = lambda seen, *_: np.full(len(seen.radius), float(level))
        module.allowed_levels = lambda chosen, wanted: np.minimum(chosen, len(wanted))
    try:
        return picture(bench, options, 0)[0]
    finally:
        for module, (choose, allow) in zip(modules, own, strict=True):
            module.choose_levels, module.allowed_levels = choose, allow


def ratio(test, right):
    """Return the energy over that of the right picture, in the channel where it differs most."""
    ratios = test.sum(axis=(0, 1), dtype=np.float64) / right.sum(axis=(0, 1), dtype=np.float64)
    return float(ratios[np.abs(ratios - 1.0).argmax()])


def decibels(square):
    """Return a mean square of differences in dB; none, or less than none by chance, is 99."""
    return float(min(-10.0 * np.log10(max(square, 1e-30)), 99.0))


def line(row):
    """Return a row of the table, and whether it misses a bar."""
    square, error = row["own"]
    own = f"{decibels(square):.1f} (at least {decibels(square + 2.0 * error):.1f})"
    checks = [
        (f"{row['chosen']:.4f}", abs(row["chosen"] - 1.0) > CHOSEN),
        *((f"{each:.4f}", abs(each - 1.0) > FORCED) for each in row["forced"]),
        (f"{row['psnr']:.1f}", False),
        (f"{row['other_seed']:.1f}", False),
        (own, decibels(square + 2.0 * error) < PSNR),
        (f"{row['seeds']}", False),
        (f"{100.0 * row['triangles']:.0f} %", False),
    ]
    cells = [f"**{text}**" if missed else text for text, missed in checks]
    return f"| {row['case']} | {' | '.join(cells)} |", any(missed for _, missed in checks)


if __name__ == "__main__":
    main()
