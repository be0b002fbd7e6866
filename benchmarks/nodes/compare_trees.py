"""Compare random trees of shader nodes with Cycles, and name those that differ.

    python -m benchmarks.nodes.compare_trees --count 300 --seed 1

Each tree glows on a card of 64 x 64 pixels that both engines draw. It agrees where 98 % of its
pixels are within 4/255 as displayed: at steps of a pattern that lie in a pixel's middle, rounding
decides.
"""

import argparse
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))

# Share of the pixels of a tree that agrees, and trees of one picture.
AGREES = 0.98
_A_PICTURE = 25


def judge(bpy, seeds):
    """Return trees that differ: (seed, share of pixels that agree, kinds of nodes).

    Parameters
    ----------
    bpy : module
        With Aplanat registered.
    seeds : sequence of int

    Returns
    -------
    list of (int, float, list of str)
    """
    from benchmarks.nodes import random_trees
    from benchmarks.nodes.sheet import TINY_FILTER
    from benchmarks.referees.plain_pictures import aplanat_picture, cycles_picture

    differing = []
    for first in range(0, len(seeds), _A_PICTURE):
        part = seeds[first : first + _A_PICTURE]
        scene, kinds = random_trees.build(bpy, part)
        ours, cycles = aplanat_picture(scene), cycles_picture(scene, TINY_FILTER)
        shares = random_trees.agreement(part, ours, cycles)
        differing += [found for found in zip(part, shares, kinds, strict=True) if found[1] < AGREES]
        print(f"{first + len(part)} of {len(seeds)}: {len(differing)} differ", flush=True)
    return differing


def main(words=None):
    """Print the trees that differ; fail where more than 5 % do."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=300, help="of trees (default: 300)")
    parser.add_argument("--seed", type=int, default=1, help="of the first tree (default: 1)")
    options = parser.parse_args(words)
    import bpy

    import addon

    addon.register()
    seeds = range(options.seed, options.seed + options.count)
    differing = judge(bpy, seeds)
    for seed, share, kinds in differing:
        print(f"tree {seed}: {share:.1%} of its pixels agree: {', '.join(kinds)}")
    agreeing = 1.0 - len(differing) / len(seeds)
    print(f"{agreeing:.1%} of {len(seeds)} trees agree")
    return 0 if agreeing >= 0.95 else 1


if __name__ == "__main__":
    sys.exit(main())
