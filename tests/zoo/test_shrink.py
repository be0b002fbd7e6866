"""The shrinker, on recipes whose failure is known."""

import json

from benchmarks.zoo.scenes.recipe import make_recipe
from benchmarks.zoo.shrink import reductions, shrink


def holds(word):
    return lambda recipe: word in json.dumps(recipe)


def test_all_but_the_cause_goes():
    recipe = {
        "scene": {"render.resolution_x": 48, "render.resolution_y": 33, "a": 1, "b": 2, "c": 3},
        "materials": {"m0": {"tree": {"Surface": {"node": "Plain"}}}},
        "objects": [
            {"kind": "MESH", "count": 30, "set": {"location": [1, 2, 3]}},
            {"kind": "TEXT", "materials": ["m0", None]},
            {"kind": "MESH"},
        ],
        "lights": [{"type": "SUN", "set": {"energy": 3.0}}],
        "camera": {"object": {}, "set": {"lens": 8.0}},
        "settings": {"render.engine": "APLANAT"},
    }
    small, _ = shrink(recipe, holds("TEXT"))
    assert small == {
        "objects": [{"kind": "TEXT"}],
    } or small == {
        "scene": {"render.resolution_x": 6, "render.resolution_y": 4},
        "objects": [{"kind": "TEXT"}],
        "settings": {"render.engine": "APLANAT"},
    }


def test_a_node_is_found_at_the_bottom_of_its_tree():
    tree = {
        "node": "ShaderNodeMixShader",
        "inputs": {
            "Fac": {"node": "ShaderNodeMath", "inputs": {"Value": {"node": "Culprit"}}},
            "Shader": {"node": "ShaderNodeEmission"},
        },
    }
    small, _ = shrink({"materials": {"m0": {"tree": {"Surface": tree}}}}, holds("Culprit"))
    assert small == {"materials": {"m0": {"tree": {"Surface": {"node": "Culprit"}}}}}


def test_what_is_shrunk_still_fails_and_is_never_larger(aplanat_bpy):
    recipe = make_recipe(aplanat_bpy, 2, 8)
    size = len(json.dumps(recipe))
    assert all(len(json.dumps(smaller)) <= size for smaller in reductions(recipe))
    small, tries = shrink(recipe, holds("ShaderNode"), most_tries=5000)
    assert holds("ShaderNode")(small)
    assert len(json.dumps(small)) < 400
    assert tries < 5000


def test_tries_are_bounded():
    recipe = {"objects": [{"kind": "MESH", "count": i} for i in range(50)]}
    large = lambda recipe: len(recipe.get("objects", [])) > 5  # noqa: E731
    assert shrink(recipe, large, most_tries=3)[1] == 3
