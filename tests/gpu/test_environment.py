"""The world as a light: levels of a constant image are constant; they are made once an image."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.drawing.scene_buffers import SceneBuffers
from addon.passes.surface import environment
from addon.snapshot.content import ImageSnapshot, World, next_uid

from .conftest import some_triangles, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")


def content_in(world, images):
    content = triangles_snapshot(*some_triangles(count=1)).content
    return replace(content, world=world, images=images)


def read(texture):
    return np.asarray(texture.read(), np.float64).reshape(environment.TILE, -1, 4)[..., :3]


def test_a_constant_world_stays_constant_in_every_level_and_gutter():
    color = np.array([0.25, 0.5, 2.0])
    pixels = np.broadcast_to(np.float32(color), (32, 64, 3))
    levels = read(environment.prefilter(np.ascontiguousarray(pixels)))
    # Half floats keep 11 bits.
    assert np.abs(levels / color - 1.0).max() < 2e-3


def test_diffuse_light_of_a_sky_is_the_share_of_it_that_a_surface_sees():
    """A white upper half: (1 + cos) / 2 of it for a surface tilted by an angle."""
    pixels = np.zeros((32, 64, 3), np.float32)
    pixels[16:] = 1.0
    tile = read(environment.prefilter(pixels))[:, -environment.TILE :]
    middle, edge = tile[64, 64, 0], tile[64, 1, 0]
    # The middle looks straight up, the edge's middle to the side; texels of 7.5 degrees, and the
    # middle of a map of even width lies between texels.
    assert middle == pytest.approx(1.0, abs=5e-3)
    assert edge == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize("elevation", [0.2, 0.35, 0.7, 1.2])
def test_a_small_sun_lights_from_where_it_is(elevation):
    """Against the sum over all texels; a cell of the sums is 7.5 degrees wide."""
    height, width = 256, 512
    rows = ((np.arange(height) + 0.5) / height - 0.5) * np.pi
    row = int((elevation / np.pi + 0.5) * height)
    pixels = np.full((height, width, 3), 0.1, np.float32)
    pixels[row - 1 : row + 2, 280:283] = 2000.0
    weights = np.maximum(np.sin(rows), 0.0) * np.cos(rows)
    wanted = (pixels[..., 0] * weights[:, None]).sum() * 2.0 * np.pi / (height * width)
    tile = read(environment.prefilter(pixels))[:, -environment.TILE :]
    # Straight up lies between four texels; a texel is 1.5 degrees.
    assert tile[63:65, 63:65, 0].mean() == pytest.approx(wanted, rel=3e-3)


def test_levels_are_made_once_an_image_and_not_for_colour_rotation_or_lights():
    rng = np.random.default_rng(0)
    image = ImageSnapshot(next_uid(), "sky", rng.random((16, 32, 4)).astype(np.float32))
    images = {image.uid: image}
    world = World((1.0, 1.0, 1.0), image.uid)
    buffers = SceneBuffers()
    buffers.update(content_in(world, images))
    first = dict(buffers.lighting)["environment_levels_tx"]
    turned = ((0.0, 1.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    buffers.update(content_in(World((2.0, 1.0, 1.0), image.uid, turned), images))
    assert dict(buffers.lighting)["environment_levels_tx"] is first
    assert buffers.uploads["environments"] == 1
