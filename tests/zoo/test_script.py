"""Scripts of scenes: what they build, and that they need nothing but Blender and Aplanat."""

import subprocess
import sys

import numpy as np

from benchmarks.zoo.judge import render
from benchmarks.zoo.scenes.recipe import make_recipe
from benchmarks.zoo.scenes.script import build, script
from tests.conftest import REPOSITORY


def summary(bpy):
    """What is in the scene, without the pictures of it."""
    scene = bpy.context.scene
    places = {o.name: (o.type, [list(row) for row in o.matrix_basis]) for o in scene.objects}
    trees = {
        material.name: sorted(node.bl_idname for node in material.node_tree.nodes)
        for material in bpy.data.materials
        # Others are not saved.
        if material.users
    }
    sizes = [image.size[:] for image in bpy.data.images if image.users and image.size[0]]
    return places, trees, sorted(sizes), scene.render.resolution_x, scene.camera.data.lens


def test_a_script_builds_the_same_scene_in_another_process(aplanat_bpy, tmp_path):
    bpy = aplanat_bpy
    recipe = make_recipe(bpy, 1, 1)
    build(recipe)
    expected = summary(bpy)
    path, saved = tmp_path / "scene.py", tmp_path / "scene.blend"
    path.write_text(script(recipe))
    subprocess.run(
        [sys.executable, path, saved],
        env={"PYTHONPATH": str(REPOSITORY), "PATH": "/usr/bin:/bin"},
        cwd=tmp_path,
        check=True,
        capture_output=True,
        timeout=120,
    )
    bpy.ops.wm.open_mainfile(filepath=str(saved), load_ui=False)
    assert summary(bpy) == expected


def test_a_script_holds_only_the_functions_that_it_calls():
    text = script({"objects": [{"kind": "TEXT"}]})
    assert "def make_text(" in text
    assert "def make_metaball(" not in text
    assert "def make_world(" not in text


def test_anything_may_be_left_out_of_a_recipe(aplanat_bpy):
    scene = build({"scene": {"render.resolution_x": 5, "render.resolution_y": 4}, "settings": {}})
    scene.render.engine = "APLANAT"
    pictures = render(scene)
    assert pictures["ViewLayer", "Combined"].shape == (4, 5, 4)
    assert np.isfinite(pictures["ViewLayer", "Combined"]).all()
