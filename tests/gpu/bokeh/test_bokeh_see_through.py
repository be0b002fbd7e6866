"""See-through surfaces in front of highlights dim them, at whatever distance."""

from dataclasses import replace

import numpy as np
import pytest

from addon.snapshot.surface_graph import Constant, Link, ShaderNode, SurfaceGraph

from ..conftest import render_snapshot, triangles_snapshot
from .bokeh_scenes import HEIGHT, LENS, WIDTH, energy, lamp, with_bokeh

pytestmark = pytest.mark.usefixtures("gpu_context")

BRIGHT, DARK = (40.0, 20.0, 10.0), (0.0, 0.0, 0.0)


def alpha(color, through):
    """Return the graph of a card that shines and lets a share of the light through."""
    white = (("Color", Constant((1.0, 1.0, 1.0))),)
    light = (("Color", Constant(color)), ("Strength", Constant((1.0,))))
    mix = (("Fac", Constant((through,))), ("Shader", Link(0, "Emission")))
    nodes = (
        ShaderNode("emission", light),
        ShaderNode("transparent", white),
        ShaderNode("mix_shader", (*mix, ("Shader_001", Link(1, "BSDF")))),
    )
    return SurfaceGraph(nodes, Link(2, "Shader"))


def stack(cards, lamp_depth=None, parallel=False):
    """Return a snapshot of cards (size, depth, colour, share that passes), and a lamp behind.

    Cards of one size cover the same pixels at any depth.
    """
    places = [(size, depth) for size, depth, _, _ in cards]
    places += [(0.25, lamp_depth)] * (lamp_depth is not None)
    triangles = []
    for size, depth in places:
        scale = 1.0 if parallel else depth / 8.0
        triangles.append(lamp(0.1 * scale, 0.05 * scale, depth, size * scale))
    shot = triangles_snapshot(
        triangles, [BRIGHT] * len(places), WIDTH, HEIGHT, LENS, 16, parallel=parallel
    )
    materials = dict(shot.content.materials)
    for (_, _, color, through), uid in zip(cards, list(materials), strict=False):
        materials[uid] = replace(materials[uid], graph=alpha(color, through))
    content = replace(shot.content, materials=materials)
    content = replace(content, world=replace(content.world, color=(0.0, 0.0, 0.0)))
    return with_bokeh(replace(shot, content=content), ("Bokeh",), visibility="RASTER")


def light(*arguments):
    return energy(render_snapshot(stack(*arguments))["Bokeh"])


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize(
    ("spacing", "count"), [(1e-4, 1), (1e-4, 40), (4e-3, 40), (5e-2, 2), (5e-2, 12)]
)
def test_bright_cards_behind_one_another_dim_each_other(spacing, count, parallel):
    # Their circles of confusion differ by nearly nothing to more than a pixel. Over longer ways,
    # light passes beside the cards in front.
    cards = [(0.3, 8.0 + spacing * i, BRIGHT, 0.5) for i in range(count)]
    one = light(cards[:1], None, parallel)
    all_light = 2.0 * (1.0 - 0.5**count)
    np.testing.assert_allclose(light(cards, None, parallel), one * all_light, rtol=0.01)


@pytest.mark.parametrize("spacing", [1e-4, 5e-2, 0.5])
@pytest.mark.parametrize("count", [1, 6])
def test_dark_cards_dim_the_lamp_behind_them(spacing, count):
    cards = [(2.5, 8.0 - spacing * (i + 1), DARK, 0.7) for i in range(count)]
    np.testing.assert_allclose(light(cards, 8.0), light([], 8.0) * 0.7**count, rtol=0.01)


def test_cards_behind_a_lamp_do_not_dim_it():
    behind = [(2.5, 8.0 + 1e-3 * (i + 1), DARK, 0.5) for i in range(3)]
    pictures = [render_snapshot(stack(cards, 8.0))["Bokeh"] for cards in ([], behind)]
    assert pictures[0].max() > 0.1
    assert pictures[0].tobytes() == pictures[1].tobytes()


@pytest.mark.parametrize("visibility", ["RASTER", "WARP", "SPLAT"])
@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("distance", [1e-3, 3e-2])
def test_a_lamp_close_behind_a_plate_is_dark_behind_something_nearer_too(
    distance, parallel, visibility
):
    # The nearer card leaves most of the lens free, and is the nearest surface in the lamp's pixels.
    near, plate, behind = (0.3, 3.0), (0.6, 8.0), (0.25, 8.0 + distance)
    for cards, dark in (((near, plate, behind), True), ((near, behind), False)):
        triangles = []
        for size, depth in cards:
            scale = 1.0 if parallel else depth / 8.0
            triangles.append(lamp(0.1 * scale, 0.05 * scale, depth, size * scale))
        colors = [DARK] * (len(cards) - 1) + [BRIGHT]
        shot = triangles_snapshot(triangles, colors, WIDTH, HEIGHT, LENS, 16, parallel=parallel)
        shot = with_bokeh(shot, ("Bokeh",), visibility=visibility)
        found = energy(render_snapshot(shot)["Bokeh"]).sum()
        assert (found == 0.0) if dark else (found > 0.0)
