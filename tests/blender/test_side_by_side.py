"""A Rendered viewport that never rests and final renders at the same time, in Blender's window.

`--side-by-side-seconds 600` goes on for ten minutes, and then measures what the memory grew by.
"""

import json
import time
from pathlib import Path

import imageio.v3 as iio
import numpy as np
import pytest

HERE = Path(__file__).parent
# What a process takes wanders by more than a short run could tell from a leak.
LEAST_SECONDS_OF_A_MEASUREMENT = 240.0
# Between the medians of two thirds of a run, MB. A frame's targets take 1 MB, a viewport's 10, its
# levels of detail 3; hundreds of each are made.
MOST_GROWTH_MB = 40.0


# A run of ten minutes ends within this time on a busy machine; each wait has its own limit.
pytestmark = pytest.mark.timeout(1800)


@pytest.fixture
def stage(blender, display, tmp_path):
    with blender.window(display, folder=tmp_path / "window") as window:
        window.run((HERE / "stage.py").read_text())
        window.run("build_crowd()")
        yield window
        log = window.log.read_text()
        assert "Traceback" not in log and "rror:" not in log, log


def rendered(window, path):
    """Save the render result; return its pixels."""
    window.run(f"bpy.data.images['Render Result'].save_render({str(path)!r})")
    return iio.imread(path)


def same(a, b):
    return a.shape == b.shape and bool((a == b).all())


def difference(a, b):
    apart = np.abs(a.astype(int) - b.astype(int)).max(axis=2)
    return f"{np.count_nonzero(apart)} pixels differ, by up to {apart.max()} of 255"


def render(window):
    window.run("start_render()")
    window.wait_for("'render_complete' in events", timeout=180)


def escape(window):
    """Render, press Escape while levels of detail are made or samples drawn, and look again."""
    window.run("shared().levels.rebuild(); start_render()")
    window.wait_for("'render_pre' in events")
    for _ in range(20):
        window.xdotool("mousemove", 300, 500)
        window.xdotool("key", "Escape")
        if window.run("result = 'render_cancel' in events or 'render_complete' in events"):
            break
    window.wait_for("'render_cancel' in events or 'render_complete' in events", timeout=60)
    return window.run("result = 'render_cancel' in events")


def rest(window):
    """Let the viewport come to rest; return what is left of the shared state."""
    window.run("stirred['on'] = False; viewports.clear(); area().tag_redraw()")
    window.wait_for("converged()", timeout=180)
    return window.run("result = look()")


def test_a_viewport_at_work_and_final_renders_leave_each_other_alone(stage, tmp_path, request):
    seconds = request.config.getoption("--side-by-side-seconds")
    render(stage)
    alone = rendered(stage, tmp_path / "alone.png")
    # By the iris' picture, which viewport and final render read at once.
    told = "result = shared().notes.of(bpy.context.scene).counts['splatted']"
    assert stage.run(told) > 0
    assert alone[..., :3].std() > 20.0
    stage.run("view(); viewports.clear(); stirred['on'] = True; area().tag_redraw()")
    stage.wait_for("stirred['ticks'] > 10 and texts()", timeout=120)
    before = stage.run("result = look()")
    assert before["handles"] == 1
    end = time.monotonic() + seconds
    rounds, cancelled, taken = 0, 0, []
    while time.monotonic() < end or rounds < 3:
        if rounds % 3 == 1:
            cancelled += escape(stage)
        else:
            if rounds % 3 == 2:
                stage.run("start_render(); shared().levels.rebuild()")
                stage.wait_for("'render_complete' in events", timeout=180)
            else:
                render(stage)
            beside = rendered(stage, tmp_path / "beside.png")
            assert same(beside, alone), f"round {rounds}: {difference(beside, alone)}"
        rounds += 1
        state = stage.run("result = look()")
        # The viewport's, and no final render's.
        assert state["handles"] == 1, state
        taken.append(state["megabytes"])
        stage.run("result = sorted(texts())")
    state = stage.run("result = look()")
    # Both were at work all the time.
    assert state["simplified"] > before["simplified"] + rounds
    assert state["ticks"] > before["ticks"] + 2 * rounds
    assert cancelled
    state = rest(stage)
    assert not state["busy"] and state["progress"][0] == state["progress"][1], state
    assert state["waiting"] == 0 and state["listeners"] == 0
    assert not any(
        "failed" in text or "No levels" in text for text in stage.run("result = texts()")
    )
    render(stage)
    assert same(rendered(stage, tmp_path / "after.png"), alone)
    third = len(taken) // 3
    growth = float(np.median(taken[-third:]) - np.median(taken[third : 2 * third])) if third else 0
    told = {"rounds": rounds, "cancelled": cancelled, "growth_mb": growth, "megabytes": taken}
    print(json.dumps(told | {"ticks": state["ticks"], "simplified": state["simplified"]}))
    if seconds >= LEAST_SECONDS_OF_A_MEASUREMENT:
        assert growth < MOST_GROWTH_MB, told
