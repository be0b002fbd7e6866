"""Colours of the circle of confusion over a 3D view."""

import numpy as np
import pytest

from addon.passes import focus_overlay
from addon.sampling.thin_lens import DepthOfField

NEAR, FAR = 0.1, 100.0
# Perspective of a square picture, 90 degrees wide, as OpenGL has it.
PERSPECTIVE = np.array(
    [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, -(FAR + NEAR) / (FAR - NEAR), -2.0 * FAR * NEAR / (FAR - NEAR)],
        [0.0, 0.0, -1.0, 0.0],
    ]
)
FOCUS, REACH = 5.0, 100.0


@pytest.fixture
def tint(gpu_context):
    """The colour over a surface at a distance from the camera, or over the world."""
    import gpu

    from addon.device import geometry

    screen = gpu.types.GPUOffScreen(4, 4, format="RGBA32F")
    blur = DepthOfField(FOCUS, REACH, False)

    def draw(distance, from_clip=None):
        value = 1.0
        if np.isfinite(distance):
            clip = PERSPECTIVE @ (0.0, 0.0, -distance, 1.0)
            value = 0.5 + 0.5 * clip[2] / clip[3]
        from_clip = np.linalg.inv(PERSPECTIVE) if from_clip is None else from_clip
        with screen.bind():
            framebuffer = gpu.state.active_framebuffer_get()
            framebuffer.clear(color=(0.0, 0.0, 0.0, 1.0), depth=value)
            focus_overlay.draw(geometry.fullscreen_batch(), from_clip, blur, 2.0)
            found = framebuffer.read_color(2, 2, 1, 1, 4, 0, "FLOAT")
        return np.array(found, np.float64).reshape(4)[:3]

    yield draw
    screen.free()


def at(diameter):
    """The distance at which a point has a circle of confusion of so many pixels."""
    return 1.0 / (1.0 / FOCUS - diameter / REACH)


def test_colours_turn_softly_from_green_at_the_limit(tint):
    focus, before, behind = tint(FOCUS), tint(at(-40.0)), tint(at(15.0))
    assert focus.argmax() == 1 and before.argmax() == 0 and behind.argmax() == 2
    np.testing.assert_allclose(tint(at(1.9)), focus, atol=1e-3)
    steps = [tint(at(diameter)) for diameter in np.geomspace(1.8, 16.0, 60)]
    # None of 60 steps from green to full blue is seen as an edge: 5 per cent of the range.
    assert np.abs(np.diff(steps, axis=0)).max() < 0.05


def test_the_world_is_beyond_all_distances_in_front_of_the_camera_only(tint):
    np.testing.assert_allclose(tint(np.inf), tint(99.9), atol=0.02)
    # A view that looks the other way sees what lies behind the camera.
    turned = np.diag([-1.0, 1.0, -1.0, 1.0]) @ np.linalg.inv(PERSPECTIVE)
    np.testing.assert_array_equal(tint(np.inf, turned), 0.0)
