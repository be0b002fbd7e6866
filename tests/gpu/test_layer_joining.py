"""Layers on the device are joined as the twin joins them, without a mark on anything else."""

import numpy as np
import pytest

from addon.device.targets import Targets
from addon.device.textures import texture_array
from addon.layers.joining import open_ends
from addon.passes.layered import joining, layers

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT, COUNT, EYES = 45, 37, 5, 2


def scene_depths():
    """A wavy slope with a ball before it, cut at even depths without overlap."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    slope = 0.1 + 0.022 * y + 0.02 * np.sin(0.2 * x)
    inside = 1.0 - ((x - 20) ** 2 + (y - 18) ** 2) / 9.0**2
    ball = np.where(inside > 0.0, 0.45 - 0.3 * np.sqrt(np.maximum(inside, 0.0)), layers.EMPTY)
    cuts = np.linspace(0.0, 1.0, COUNT + 1)
    found = np.full((COUNT, HEIGHT, WIDTH), layers.EMPTY, np.float32)
    for surface in (slope, ball):
        for number in range(COUNT):
            here = (cuts[number] <= surface) & (surface < cuts[number + 1])
            found[number] = np.where(here, np.minimum(found[number], surface), found[number])
    return found


def scene_shares(depths):
    """Texels are whole, but for some near the cuts that a layer has a part of."""
    rng = np.random.default_rng(3)
    cuts = np.linspace(0.0, 1.0, COUNT + 1)
    near = np.abs(depths[..., None] - cuts[1:-1]).min(axis=-1) < 0.02
    parts = rng.integers(1, 10, depths.shape) / 9.0
    found = np.where(near & (rng.uniform(size=depths.shape) < 0.6), parts, 1.0)
    return np.where(depths <= 1.0, found, 0.0).astype(np.float32)


def read(texture, slot, channels):
    import gpu

    framebuffer = gpu.types.GPUFrameBuffer(color_slots={"texture": texture, "layer": slot})
    with framebuffer.bind():
        found = framebuffer.read_color(0, 0, WIDTH, HEIGHT, channels, 0, "FLOAT")
    return np.array(found, np.float32).reshape(HEIGHT, WIDTH, channels)


def test_the_device_joins_what_the_twin_joins():
    depths = scene_depths()
    shares = scene_shares(depths)
    colors = np.random.default_rng(1).uniform(0.0, 1.0, (COUNT * EYES, HEIGHT, WIDTH, 4))
    # As exact as what the device keeps.
    colors = colors.astype(np.float16).astype(np.float32)
    mattes = np.random.default_rng(2).uniform(0.0, 1.0, (COUNT, HEIGHT, WIDTH, 4))
    mattes = mattes.astype(np.float32)
    with Targets(WIDTH, HEIGHT, []) as targets:
        kept = targets.textures
        kept["colors"] = texture_array(colors, layers.COLOR_FORMAT)
        kept["depths"] = texture_array(np.stack([depths, shares], axis=-1), layers.DEPTH_FORMAT)
        kept["mattes"] = texture_array(mattes)
        joining.join(targets, COUNT, EYES)
        read_depths = np.stack([read(kept["depths"], number, 2) for number in range(COUNT)])
        found_colors = [read(kept["colors"], number, 4) for number in range(COUNT * EYES)]
        found_mattes = [read(kept["mattes"], number, 4) for number in range(COUNT)]
    total = 0
    for number in range(1, COUNT):
        part = slice(number - 1, number + 1)
        pair = shares[part]
        widened = open_ends(pair, depths[part], reach=2, in_parts=True)
        # Those that it has a part of keep what they are.
        ends = widened & (shares[number] == 0.0)
        shares[number][widened] = 1.0
        depths[number][ends] = depths[number - 1][ends]
        mattes[number][ends] = mattes[number - 1][ends]
        for eye in range(EYES):
            layer = number + eye * COUNT
            colors[layer][ends] = colors[layer - 1][ends]
        total += ends.sum()
    assert total > 2 * WIDTH
    assert np.array_equal(read_depths[..., 0], depths)
    assert np.array_equal(read_depths[..., 1], shares)
    assert np.array_equal(found_mattes, mattes)
    assert np.array_equal(found_colors, colors)
