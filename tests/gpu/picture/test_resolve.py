"""The picture is placed where it is wanted, each pixel as large as it is wanted."""

import numpy as np
import pytest

from addon.device.readback import read_color
from addon.device.targets import Targets, TargetSpec

from ..conftest import LENS, make_renderer, some_triangles, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")


@pytest.mark.parametrize("pixel_size", [1, 3])
def test_a_picture_is_drawn_at_its_place_in_squares(pixel_size):
    corners, colors = some_triangles()
    renderer = make_renderer(triangles_snapshot(corners, colors, lens=LENS, samples=4))
    renderer.advance(4)
    picture = renderer.read_image()
    height, width = picture.shape[:2]
    specs = [TargetSpec("image", "RGBA32F")]
    x, y = 5, 9
    with Targets(x + width * pixel_size, y + height * pixel_size, specs) as targets:
        framebuffer = targets.framebuffer("image")
        with framebuffer.bind():
            renderer.resolve((x, y), pixel_size)
        found = read_color(framebuffer, targets.width, targets.height)[y:, x:]
    renderer.release()
    expected = np.repeat(np.repeat(picture, pixel_size, axis=0), pixel_size, axis=1)
    assert found.tobytes() == expected.tobytes()


def test_the_picture_is_the_mean_at_any_time():
    corners, colors = some_triangles()
    snapshot = triangles_snapshot(corners, colors, lens=LENS, samples=8)
    renderer = make_renderer(snapshot)
    means = []
    for _ in range(8):
        renderer.advance(1)
        means.append(renderer.read_image())
    renderer.release()
    # Covered or not, a pixel of the sum grows by the sample alone.
    samples = np.diff([(i + 1) * mean for i, mean in enumerate(means)], axis=0)
    # Sums of up to 8 float32 values of at most 1.
    assert samples.min() > -2e-6
    assert samples.max() < 1.0 + 2e-6
