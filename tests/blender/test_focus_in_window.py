"""The focus in Blender's window: picked with key and mouse; and why a view has no picture."""

from pathlib import Path

import imageio.v3 as iio
import pytest

STAGE = Path(__file__).with_name("stage.py").read_text()
PLACE = """
from bpy_extras.view3d_utils import location_3d_to_region_2d
thing = bpy.data.objects[{name!r}].matrix_world.translation
seen = location_3d_to_region_2d(region(), area().spaces.active.region_3d, thing)
result = [int(region().x + seen.x), int(window().height - 1 - region().y - seen.y)]
"""
DISTANCE = "bpy.context.scene.camera.data.dof.focus_distance"


@pytest.fixture
def stage(window):
    window.run(STAGE)
    window.run("build(); view()\nbpy.context.scene.aplanat.preview_samples = 1")
    window.wait_for("converged()", timeout=60)
    yield window
    log = window.log.read_text()
    assert "Traceback" not in log and "rror:" not in log, log


def test_focus_is_picked_with_key_and_mouse_and_undone(stage, tmp_path):
    def point_at(name):
        stage.xdotool("mousemove", *stage.run(PLACE.format(name=name)))
        stage.run("result = 1")

    point_at("thing0")
    stage.xdotool("key", "ctrl+shift+f")
    # The camera is 10 m in front of the origin, the near cube's front 4.3 m nearer.
    stage.wait_for(f"5.4 < {DISTANCE} < 6.2", timeout=20)
    stage.run("with override(): bpy.ops.view3d.aplanat_focus_pick('INVOKE_DEFAULT')")
    point_at("thing4")
    stage.xdotool("click", "1")
    stage.wait_for(f"13.2 < {DISTANCE} < 14.2", timeout=20)
    stage.run("with override(): bpy.ops.ed.undo()")
    stage.wait_for(f"5.4 < {DISTANCE} < 6.2", timeout=20)
    check_pull(stage)
    stage.run(
        "bpy.context.scene.aplanat.show_coc = bpy.context.scene.aplanat.show_focus_planes = 1"
    )
    stage.wait_for("converged()", timeout=20)
    # A view without overlays says itself why it has no picture.
    stage.run("bpy.context.scene.camera.data.type = 'PANO'; view(bare=True)")
    stage.wait_for("any('panoramic' in text for text in texts())", timeout=20)
    stage.run("redraw(2)")
    picture = iio.imread(stage.screenshot(tmp_path / "why.png"))[..., :3].astype(int)
    left, bottom, width, height = stage.run("r = region(); result = [r.x, r.y, r.width, r.height]")
    top = picture.shape[0] - bottom - height
    head = picture[top + 40 : top + 140, left : left + width]
    assert ((head[..., 0] > 150) & (head[..., 0] - head[..., 2] > 60)).sum() > 200


def check_pull(stage):
    """Each click counts where it was made, however slow the picture; undo is for later."""
    near, far = (stage.run(PLACE.format(name=name)) for name in ("thing0", "thing4"))
    stage.run("with override(): bpy.ops.view3d.aplanat_focus_pull('INVOKE_DEFAULT', length=5)")
    for place in (near, far):
        stage.xdotool("mousemove", *place)
        stage.xdotool("click", "1")
        if place is near:
            stage.xdotool("key", "ctrl+z")
    data = "bpy.context.scene.camera.data"
    stage.wait_for(f"{data}.animation_data is not None", timeout=20)
    distances = [
        stage.run(f"bpy.context.scene.frame_set({frame}); result = {DISTANCE}") for frame in (6, 1)
    ]
    assert 13.2 < distances[0] < 14.2 and 5.4 < distances[1] < 6.2
