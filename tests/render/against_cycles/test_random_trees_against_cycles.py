"""Random trees of nodes look as in Cycles; `benchmarks.nodes.compare_trees` draws 300 of them."""

import numpy as np

from benchmarks.nodes import random_trees, sheet
from benchmarks.nodes.compare_trees import AGREES
from tests.pictures import render_aplanat, render_cycles, save_side_by_side

SEEDS = range(1001, 1013)
CARD_PX = 24


def test_random_trees_glow_as_in_cycles(aplanat_bpy, tmp_path):
    scene, kinds = random_trees.build(aplanat_bpy, SEEDS, CARD_PX)
    ours = render_aplanat(scene, 1)
    cycles = render_cycles(scene, 1, "BLACKMAN_HARRIS", sheet.TINY_FILTER)
    save_side_by_side(tmp_path / "ours_cycles_difference.png", ours, cycles)
    assert np.isfinite(ours).all()
    shares = random_trees.agreement(SEEDS, ours, cycles, CARD_PX)
    differing = [
        f"{seed}: {share:.1%}: {', '.join(used)}"
        for seed, share, used in zip(SEEDS, shares, kinds, strict=True)
        if share < AGREES
    ]
    assert not differing, f"{tmp_path}\n" + "\n".join(differing)


def test_a_seed_gives_the_same_tree_again(aplanat_bpy):
    trees = [random_trees.build(aplanat_bpy, (7, 8), CARD_PX)[1] for _ in range(2)]
    assert trees[0] == trees[1]
    assert trees[0][0] != trees[0][1]
