"""A capture leaves the scene as it was: after it, after an error, and when it is stopped."""

import pytest

from addon.capture.frame_capture import FrameCapture, render_now
from addon.capture.settings import CaptureSettings
from addon.errors import UnfinishedFileError
from tests.capture.conftest import all_data


@pytest.fixture
def lively(blocks):
    """A scene with animation, a change that is not keyed yet, markers and a render result less."""
    near, data = blocks.objects["Near"], blocks.camera.data
    for frame, x in ((1, -0.6), (9, 0.6)):
        near.location.x = x
        near.keyframe_insert("location", frame=frame)
        data.clip_end = 90.0 + frame
        data.keyframe_insert("clip_end", frame=frame)
    blocks.frame_set(3)
    near.location.x = 0.123
    blocks.timeline_markers.new("cut", frame=1).camera = blocks.camera
    blocks.render.use_motion_blur = True
    blocks.view_layers[0].update()
    return blocks


def assert_same(found, expected):
    changed = {k for k in found.keys() | expected.keys() if found.get(k) != expected.get(k)}
    assert not {k: (expected.get(k), found.get(k)) for k in sorted(changed)[:8]}


def test_a_capture_leaves_all_data_as_it_was(lively, capture, aplanat_bpy):
    before = all_data(aplanat_bpy)
    assert any(path.endswith(".location") for path in before)
    capture(lively, 7, layers=2, overscan=0.1)
    assert_same(all_data(aplanat_bpy), before)
    # Each engine keeps memories of its own of what it has rendered.
    capture(lively, 3, layers=1, engine="APLANAT")
    assert_same(all_data(aplanat_bpy), before)


@pytest.mark.parametrize("renders", [0, 1, 2])
def test_a_stopped_capture_leaves_all_data_and_no_files(renders, lively, aplanat_bpy, tmp_path):
    before = all_data(aplanat_bpy)
    with FrameCapture(lively, 5, CaptureSettings(layers=2), tmp_path) as captured:
        steps = captured.steps()
        for _ in range(renders):
            render_now(next(steps))
    assert_same(all_data(aplanat_bpy), before)
    assert not list(tmp_path.iterdir())


def test_a_failed_capture_leaves_all_data_as_it_was(lively, aplanat_bpy, tmp_path):
    before = all_data(aplanat_bpy)
    with (
        pytest.raises(UnfinishedFileError, match="left no picture of measuring depths"),
        FrameCapture(lively, 5, CaptureSettings(layers=2), tmp_path) as captured,
    ):
        steps = captured.steps()
        next(steps)
        # As if nothing could be written.
        next(steps)
    assert_same(all_data(aplanat_bpy), before)
