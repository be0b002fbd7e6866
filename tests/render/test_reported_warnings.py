"""Warnings in Blender's own report of a render: each line once a render, and again in the next."""

import pytest

from benchmarks.scenes.small_scene import build_scene

LINE = "scene 'Scene': motion blur is not drawn"


@pytest.fixture
def reported(aplanat_bpy, capfd, tmp_path):
    """Render and return how often Blender printed the warning for each time it was reported."""
    scene = build_scene(aplanat_bpy)
    scene.render.engine = "APLANAT"
    scene.render.use_motion_blur = True
    scene.render.filepath = f"{tmp_path}/f_"
    scene.frame_start, scene.frame_end = 1, 3

    def render(**options):
        capfd.readouterr()
        aplanat_bpy.ops.render.render(**options)
        out, err = capfd.readouterr()
        return (out + err).count(LINE)

    return scene, render


def test_several_view_layers_and_frames_report_a_line_as_often_as_one(reported):
    scene, render = reported
    once = render()
    assert once >= 1
    scene.view_layers.new("Second")
    scene.render.use_multiview = True
    assert render() == once
    assert render(animation=True) == once


def test_every_render_reports_anew(reported):
    _, render = reported
    assert render(animation=True) == render(animation=True) == render()
