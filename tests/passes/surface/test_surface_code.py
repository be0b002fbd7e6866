"""Graphs of one shape generate one text; only what can be seen through gives up the depth test."""

import numpy as np
import pytest

from addon.passes.nodes import surface_code
from addon.passes.surface.environment import ggx_table
from addon.passes.surface.light_table import list_texels, table_texels
from addon.sampling.lights.light_turns import LightList
from addon.snapshot.content import Light
from addon.snapshot.surface_graph import Constant, Link, ShaderNode, SurfaceGraph
from tests.surface_graphs import emission_graph


def shaders(*kinds_and_color):
    return tuple(
        ShaderNode(kind, (("Color", Constant(color)), ("Strength", Constant((1.0,)))))
        for kind, color in kinds_and_color
    )


def added(first, second):
    nodes = shaders(first, second)
    outputs = [{"emission": "Emission"}.get(node.kind, "BSDF") for node in nodes]
    parts = (("Shader", Link(0, outputs[0])), ("Shader_001", Link(1, outputs[1])))
    return SurfaceGraph((*nodes, ShaderNode("add_shader", parts)), Link(2, "Shader"))


def test_constants_are_no_part_of_the_text():
    red = surface_code.generate(emission_graph((1.0, 0.0, 0.0)), ())
    blue = surface_code.generate(emission_graph((0.0, 0.0, 1.0), 3.0), ())
    assert red.source == blue.source
    assert red.constants != blue.constants


def test_an_attribute_that_the_mesh_lacks_is_zero():
    node = ShaderNode("color_attribute", settings=(("name", "Col"),))
    glow = ShaderNode("emission", (("Color", Link(0, "Color")), ("Strength", Constant((1.0,)))))
    graph = SurfaceGraph((node, glow), Link(1, "Emission"))
    assert surface_code.generate(graph, ()).attributes == ()
    assert surface_code.generate(graph, ("color:Col",)).attributes == ("color:Col",)


@pytest.mark.parametrize(
    "first, second, transparent, glows",
    [
        (("emission", (1, 1, 1)), ("emission", (1, 1, 1)), False, False),
        (("transparent", (1, 1, 1)), ("emission", (1, 1, 1)), True, True),
        (("transparent", (0.5,)), ("transparent", (0.5,)), True, False),
    ],
)
def test_light_added_to_what_is_let_through_is_drawn_apart(first, second, transparent, glows):
    code = surface_code.generate(added(first, second), ())
    assert (code.transparent, code.glows) == (transparent, glows)


def test_smooth_lobes_reflect_everything_and_rough_ones_lose_what_theory_says():
    table = ggx_table()
    total = table[..., 0] + table[..., 1]
    assert total[0, 4:] == pytest.approx(np.ones(28), abs=2e-3)
    assert (total < 1.001).all() and (total > 0.2).all()
    # Along the normal a lobe of roughness 1 keeps what is left by masking: the integral over the
    # upper half of D G2 / 4 cos by quadrature, alpha = 1.
    theta = (np.arange(4000) + 0.5) / 4000 * np.pi / 2
    visibility = 0.5 / (np.cos(theta) + 1.0)
    density = 1.0 / np.pi
    light = density * visibility * np.cos(theta) * np.sin(theta) * 2 * np.pi
    expected = light.sum() * (np.pi / 2 / 4000)
    # 512 samples a table entry.
    assert total[-1, -1] == pytest.approx(expected, abs=5e-3)


def test_the_light_table_says_how_many_lights_there_are():
    none = table_texels((), np.zeros((0, 3, 4)))
    assert none.shape[0] == 1 and none[0, 0].tolist() == [0.0, 1.0, 0.0, 0.0]
    sun = Light("SUN", (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), (1.0, 1.0, 1.0))
    table = table_texels([sun] * 3, np.full((2, 9, 4), 7.0))
    assert table[0, 0].tolist() == [3.0, 4.0, 0.0, 0.0]
    assert table[1:4, 0, 3].tolist() == [1.0, 1.0, 1.0]
    assert (table[4:6] == 7.0).all()


def test_a_list_of_places_says_which_are_on_each_light():
    own = LightList(np.array([4, 9, 2]), np.array([0, 2, 2]), np.array([2, 0, 1]), np.ones(3))
    other = LightList(np.array([1]), np.array([0, 0, 1]), np.array([1, 0, 0]), np.full(3, 2.0))
    texels = list_texels((own, other))
    assert texels.shape == (2, 6, 4)
    assert texels[0, :3, :3].tolist() == [[3, 2, 1], [5, 0, 1], [5, 1, 1]]
    assert texels[0, 3:, 0].tolist() == [4, 9, 2]
    assert texels[1, :3, 2].tolist() == [2, 2, 2] and texels[1, 3, 0] == 1
