"""Levels of detail where a material bends an attribute into light: the light stays as it is."""

import numpy as np
import pytest

from addon.levels.bent_attributes import bent_attributes
from addon.levels.bent_levels import unbent_levels
from addon.levels.making.mesh_levels import simplify
from addon.snapshot.surface_graph import Constant, Link, ShaderNode, SurfaceGraph

from .test_mesh_levels import areas, cube_sphere, grid, mesh_of


def terrain(roughness):
    """A board with waves of 1, 2, 4 ... cells, seen in its normals and in a mask."""

    def place(u, v):
        height = sum(
            roughness / 2**k * np.sin(2**k * 9.0 * (u * np.cos(k) + v * np.sin(k)))
            for k in range(6)
        )
        return np.stack([u, v, 0.05 * height], axis=1)

    positions, triangles, _ = grid(64, place)
    a, b, c = (positions[corner] for corner in triangles.T)
    across = np.cross(b - a, c - a)
    normals = np.zeros_like(positions)
    for corner in triangles.T:
        np.add.at(normals, corner, across)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return mesh_of(positions, triangles, **{"normal": normals, "color:mask": normals[:, [2, 2, 2]]})


def light(mesh, key, bend):
    """The mean of a function of an attribute over the surface, by corners of small triangles."""
    weights = np.random.default_rng(2).dirichlet((1.0, 1.0, 1.0), 40)
    values = np.einsum("sc,tck->stk", weights, mesh.attributes[key].astype(float)[mesh.triangles])
    if key == "normal":
        values /= np.linalg.norm(values, axis=2, keepdims=True)
    return float((bend(values[..., 2]) * areas(mesh)).sum() / areas(mesh).sum()) / len(weights)


@pytest.mark.parametrize("key", ["normal", "color:mask"])
@pytest.mark.parametrize("roughness", [0.02, 0.3, 1.0])
def test_levels_that_are_kept_have_the_light_of_full_detail(key, roughness):
    mesh = terrain(roughness)
    levels, _ = simplify(mesh, 64)
    kept = unbent_levels(mesh, levels, frozenset({key}))
    steep = float(np.median(mesh.attributes[key][:, 2]))
    span = np.ptp(mesh.attributes[key][:, 2])

    def ramp(z):
        return np.clip((z - steep) / (0.1 * span) + 0.5, 0.0, 1.0)

    right = light(mesh, key, ramp)
    errors = [abs(light(level, key, ramp) - right) for level in levels]
    # A ramp goes up by 1 once: the bound of the distributions, and a little for 40 places each.
    assert max(errors[:kept], default=0.0) < 0.004
    # Where no level is left out, nothing is tried.
    assert kept < len(levels)
    assert max(errors) > 0.01


def test_what_the_material_does_not_bend_limits_no_level():
    mesh = terrain(1.0)
    levels, _ = simplify(mesh, 64)
    assert unbent_levels(mesh, levels, frozenset()) == len(levels)
    assert unbent_levels(mesh, levels, frozenset({"color:none"})) == len(levels)
    # A mask of one value has no distribution that could shift.
    even = mesh_of(
        mesh.positions, mesh.triangles, **{"color:mask": np.full((len(mesh.positions), 3), 0.3)}
    )
    levels, _ = simplify(even, 64)
    assert unbent_levels(even, levels, frozenset({"color:mask"})) == len(levels)


def test_smooth_surfaces_keep_levels_whose_normals_are_bent():
    mesh = cube_sphere(48)
    levels, _ = simplify(mesh, 64)
    assert 1 <= unbent_levels(mesh, levels, frozenset({"normal"})) < len(levels)


GEOMETRY = ShaderNode("geometry")
MASK = ShaderNode("color_attribute", settings=(("name", "mask"),))
HALF = Constant((0.5,))


def node(kind, settings=(), **inputs):
    return ShaderNode(kind, tuple((k.replace("_", " "), v) for k, v in inputs.items()), settings)


def emission(last, output, strength=HALF):
    return node("emission", Color=Link(last, output), Strength=strength)


MULTIPLY = (("operation", "MULTIPLY"), ("clamp", ""))


@pytest.mark.parametrize(
    ("nodes", "expected"),
    [
        ((GEOMETRY, emission(0, "Normal")), set()),
        ((GEOMETRY, node("ramp", Fac=Link(0, "Normal")), emission(1, "Color")), {"normal"}),
        ((GEOMETRY, node("noise", Vector=Link(0, "Position")), emission(1, "Fac")), set()),
        ((GEOMETRY, node("image_texture", Vector=Link(0, "Normal"))), {"normal"}),
        ((MASK, emission(0, "Color")), set()),
        ((MASK, emission(0, "Color", Link(0, "Color"))), {"color:mask"}),
        ((MASK, node("math", MULTIPLY, a=Link(0, "Color"), b=HALF), emission(1, "Value")), set()),
        ((MASK, node("math", MULTIPLY, a=Link(0, "Color"), b=Link(0, "Color"))), {"color:mask"}),
        ((MASK, node("math", (("operation", "POWER"),), a=Link(0, "Color"))), {"color:mask"}),
        ((MASK, node("mix_color", factor=HALF, a=Link(0, "Color"), b=HALF)), set()),
        ((MASK, node("mix_color", factor=Link(0, "Color"), a=HALF, b=HALF)), {"color:mask"}),
        ((MASK, node("mix_shader", Fac=Link(0, "Color"))), {"color:mask"}),
        ((MASK, node("principled", Base_Color=Link(0, "Color"))), set()),
        ((MASK, node("principled", Roughness=Link(0, "Color"))), {"color:mask"}),
        ((GEOMETRY, node("bump", Normal=Link(0, "Normal")),
          node("diffuse", Color=HALF, Normal=Link(1, "Normal"))), set()),
        ((node("layer_weight", Blend=HALF),), {"normal"}),
    ],
)  # fmt: skip
def test_what_a_material_bends(nodes, expected):
    assert bent_attributes(SurfaceGraph(tuple(nodes), Link(len(nodes) - 1, "x"))) == expected
