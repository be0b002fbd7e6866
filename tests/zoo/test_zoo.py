"""Forty random scenes, each asked everything that `judge` asks; `scripts/zoo` renders more."""

import pytest

from benchmarks.zoo.judge import judge
from benchmarks.zoo.scenes.recipe import make_recipe
from benchmarks.zoo.scenes.script import script

SEED = 1
COUNT = 40
# Samples of a picture, and with a noise threshold, and depth layers; `scripts/zoo` draws up to
# three, four and eight times as many.
MOST = {"aplanat.render_samples": 32, "aplanat.render_max_samples": 64, "aplanat.layers": 8}


@pytest.mark.parametrize("number", range(COUNT))
@pytest.mark.timeout(120)
def test_a_random_scene_renders_and_agrees_with_the_reference(aplanat_bpy, number):
    recipe = make_recipe(aplanat_bpy, SEED, number)
    settings = recipe["settings"]
    for key in MOST.keys() & settings.keys():
        settings[key] = min(settings[key], MOST[key])
    # What noise decides after some pictures is left to `scripts/zoo`.
    verdict = judge(recipe, most=3, patience=2.0)
    if verdict.kind != "ok":
        text = script(recipe, f"Scene {SEED}:{number}: {verdict.kind}: {verdict.text}")
        pytest.fail(f"{verdict.kind}: {verdict.text}\n{verdict.detail}\n{text}", pytrace=False)
