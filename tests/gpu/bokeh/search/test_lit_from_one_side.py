"""Lit surfaces whose other sides, or none, are seen by parts of the lens."""

from dataclasses import replace

import numpy as np
import pytest

from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.brightness import reflects
from addon.snapshot.content import Light, MaterialSnapshot, MeshSnapshot
from addon.snapshot.surface_graph import Constant, Link, ShaderNode, SurfaceGraph

from ...conftest import render_snapshot
from ..bokeh_scenes import energy
from .test_lens_views import glossy_ball

pytestmark = pytest.mark.usefixtures("gpu_context")


def square_and_card(kind, samples, bokeh=True):
    """Return a lit square, and above it a dark card in the plane of the axis: one object."""
    snapshot = glossy_ball(4, samples, bokeh)
    ((mesh_uid,), (material_uid,)) = snapshot.content.meshes, snapshot.content.materials
    square = [(-0.5, -0.7, -1.0), (0.5, -0.7, -1.0), (0.5, 0.3, -1.0), (-0.5, 0.3, -1.0)]
    card = [(0.0, 0.35, 1.0), (0.0, 0.35, -1.0), (0.0, 0.8, -1.0), (0.0, 0.8, 1.0)]
    mesh = MeshSnapshot(
        mesh_uid,
        "square and card",
        np.array(square + card, np.float32),
        np.array([(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7)], np.int32),
        ((0, 0, 4),),
    )
    inputs = (("Color", Constant((0.8, 0.8, 0.8))), ("Roughness", Constant((0.9,))))
    material = MaterialSnapshot(
        material_uid,
        "lit",
        SurfaceGraph((ShaderNode(kind, inputs[: 1 + (kind == "glossy")]),), Link(0, "BSDF")),
    )
    content = replace(
        snapshot.content,
        meshes={mesh_uid: mesh},
        materials={material_uid: material},
        # In the plane of the card, which it does not light.
        lights=(Light("POINT", (0.0, -2.0, -4.0), (0.0, 0.0, -1.0), (9e3, 6e3, 3e3), 0.01),),
    )
    camera = replace(snapshot.camera, lens=ThinLens(0.6, 4.0, Iris()))
    return replace(snapshot, content=content, camera=camera)


@pytest.mark.parametrize("kind", ["diffuse", "glossy"])
def test_the_bright_side_does_not_stand_for_the_dark_one(kind):
    expected = energy(render_snapshot(square_and_card(kind, 512, False))["Combined"])
    pictures = render_snapshot(square_and_card(kind, 64))
    assert energy(pictures["Bokeh"]).min() > 0.8 * expected.min()
    # With the card's area for more of the square's light, a matt one had 4 % too much.
    assert energy(pictures["Combined"]) == pytest.approx(expected, rel=0.01)


def test_every_reflecting_surface_is_known():
    lit = {"diffuse", "translucent", "sheen", "glossy", "metallic", "glass", "toon", "hair"}
    for kind in sorted(lit | {"emission", "transparent"}):
        inputs = (("Color", Constant((0.8, 0.8, 0.8))), ("Strength", Constant((1.0,))))
        graph = SurfaceGraph((ShaderNode(kind, inputs),), Link(0, "BSDF"))
        assert reflects(graph) == (kind in lit)
