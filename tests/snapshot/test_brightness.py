"""Bounds of how bright surfaces may be."""

from dataclasses import replace

import numpy as np
import pytest

from addon.snapshot.brightness import brightest, emits, mirrors
from addon.snapshot.content import (
    ImageSnapshot,
    InstanceGroup,
    InstanceTable,
    Light,
    MaterialSnapshot,
    MeshSnapshot,
    SceneContent,
    World,
    next_uid,
)
from addon.snapshot.surface_graph import Constant, Link, ShaderNode, SurfaceGraph
from tests.surface_graphs import emission_graph

IMAGE = 77


SUN = Light("SUN", (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), (1.0, 1.0, 1.0))


def bound(graph, attributes=None, images=None, holdout=False, lights=(), world=None):
    mesh = MeshSnapshot(
        next_uid(),
        "m",
        np.zeros((3, 3), np.float32),
        np.array([[0, 1, 2]], np.int32),
        ((0, 0, 1),),
        attributes or {},
    )
    material = MaterialSnapshot(next_uid(), "m", graph)
    content = SceneContent(
        meshes={mesh.uid: mesh},
        images=images or {},
        materials={material.uid: material},
        instances=InstanceTable(np.eye(4, dtype=np.float32)[None], np.zeros(1, np.float32)),
        groups=(InstanceGroup(mesh.uid, (material.uid,), 0, 1, holdout),),
        lights=lights,
        world=world or World(),
    )
    ((found,),) = brightest(content)
    return found


def emission(color, strength=1.0):
    return ShaderNode("emission", (("Color", color), ("Strength", Constant((strength,)))))


def test_emission_is_as_bright_as_its_largest_channel():
    assert bound(emission_graph((0.5, 2.0, 1.0), 3.0)) == 6.0
    assert bound(emission_graph((0.0, 0.0, 0.0), 1e9)) == 0.0


def test_colours_of_vertices_count_with_their_largest():
    colors = np.array([[0.1, 0, 0, 1], [0, 4.0, 0, 1], [0, 0, 0.2, 1]], np.float32)
    graph = SurfaceGraph(
        (
            ShaderNode("color_attribute", settings=(("name", "Col"),)),
            emission(Link(0, "Color"), 2.0),
        ),
        Link(1, "Emission"),
    )
    assert bound(graph, {"color:Col": colors}) == 8.0


@pytest.mark.parametrize(("pixels", "expected"), [(np.uint8(255), 2.0), (np.float32(30.0), 60.0)])
def test_images_count_with_their_largest_pixel(pixels, expected):
    picture = ImageSnapshot(IMAGE, "i", np.full((2, 2, 4), pixels))
    texture = ShaderNode("image_texture", (("Vector", Constant((0.0, 0.0, 0.0))),), image=IMAGE)
    graph = SurfaceGraph((texture, emission(Link(0, "Color"), 2.0)), Link(1, "Emission"))
    assert bound(graph, images={IMAGE: picture}) == expected


def test_mixed_surfaces_are_as_bright_as_the_brighter_and_added_ones_as_both():
    nodes = (emission(Constant((2.0, 0, 0))), emission(Constant((3.0, 0, 0))))
    inputs = (("Shader", Link(0, "Emission")), ("Shader_001", Link(1, "Emission")))
    mixed = ShaderNode("mix_shader", (("Fac", Constant((0.5,))), *inputs))
    assert bound(SurfaceGraph((*nodes, mixed), Link(2, "Shader"))) == 3.0
    added = ShaderNode("add_shader", inputs)
    assert bound(SurfaceGraph((*nodes, added), Link(2, "Shader"))) == 5.0


def test_lit_and_unknown_surfaces_may_be_of_any_brightness():
    lit = ShaderNode("diffuse", (("Color", Constant((0.1, 0.1, 0.1))),))
    graph = SurfaceGraph((lit,), Link(0, "BSDF"))
    assert bound(graph, lights=(SUN,)) == np.inf
    assert bound(graph, world=World((1.0, 1.0, 1.0), image=IMAGE)) == np.inf
    unknown = ShaderNode("math")
    graph = SurfaceGraph((unknown, emission(Link(0, "Value"))), Link(1, "Emission"))
    assert bound(graph) == np.inf


def test_holdouts_and_empty_surfaces_are_dark():
    assert bound(emission_graph((9.0, 9.0, 9.0)), holdout=True) == 0.0
    assert bound(SurfaceGraph()) == 0.0


def principled(metallic, specular, strength=0.0, base=(0.8, 0.8, 0.8)):
    inputs = (
        ("Base Color", Constant(base)),
        ("Metallic", Constant((metallic,))),
        ("Specular IOR Level", specular),
        ("Emission Color", Constant((1.0, 1.0, 1.0))),
        ("Emission Strength", Constant((strength,))),
    )
    return SurfaceGraph((ShaderNode("principled", inputs),), Link(0, "BSDF"))


def test_lamps_that_give_no_highlights_do_not_count():
    dark = replace(SUN, highlights=False)
    gloss = ShaderNode("glossy", (("Color", Constant((0.5, 2.0, 0.5))),))
    graph = SurfaceGraph((gloss,), Link(0, "BSDF"))
    assert bound(graph, lights=(dark,)) == 0.0
    assert bound(graph, lights=(dark, SUN)) == np.inf
    # A world of one colour is reflected, brighter than the surface by what it scatters again.
    assert 1.2 <= bound(graph, lights=(dark,), world=World((0.1, 0.3, 0.2))) < 1.4
    world = World((0.5, 0.5, 0.5))
    assert 3.5 <= bound(principled(0.0, Constant((0.5,)), 3.0), world=world) < 3.6
    # A base above white makes the diffuse part brighter.
    over = principled(0.0, Constant((0.5,)), base=(3.0, 0.2, 0.2))
    assert 1.5 <= bound(over, world=world) < 1.7


def test_nodes_before_an_emission_keep_a_bound():
    def lit(*nodes):
        glow = ShaderNode(
            "emission",
            (("Color", Link(len(nodes) - 1, "Color")), ("Strength", Constant((2.0,)))),
        )
        return SurfaceGraph((*nodes, glow), Link(len(nodes), "Emission"))

    red = Constant((3.0, 0.1, 0.1))
    parts = (("factor", Constant((0.5,))), ("a", red), ("b", Constant((0.5, 0.5, 0.5))))
    mix = ShaderNode("mix_color", parts, (("blend", "MIX"), ("clamp_factor", "1")))
    assert bound(lit(mix)) == 6.0
    added = ShaderNode("mix_color", parts, (("blend", "ADD"), ("clamp_factor", "1")))
    assert bound(lit(added)) == np.inf
    clamped = ShaderNode("mix_color", parts, (("blend", "ADD"), ("clamp_result", "1")))
    assert bound(lit(clamped)) == 2.0
    ramp = ShaderNode("ramp", (("Fac", Constant((0.5,))),), table=((0.1,) * 4, (0.7,) * 4))
    assert bound(lit(ramp)) == pytest.approx(1.4)


def test_only_gloss_looks_different_from_elsewhere():
    half = Constant((0.5,))
    assert not mirrors(emission_graph((1.0, 1.0, 1.0)))
    assert not mirrors(SurfaceGraph((ShaderNode("diffuse"),), Link(0, "BSDF")))
    assert mirrors(SurfaceGraph((ShaderNode("glossy"),), Link(0, "BSDF")))
    assert not mirrors(principled(0.0, Constant((0.0,))))
    assert mirrors(principled(1.0, Constant((0.0,))))
    assert mirrors(principled(0.0, half))
    assert mirrors(principled(0.0, Link(0, "Value")))


def test_lamps_do_not_mirror():
    half = Constant((0.5,))
    assert emits(principled(0.0, half, 3.0)) and not mirrors(principled(0.0, half, 3.0))
    assert not emits(principled(0.0, half))
    assert emits(emission_graph((0.0, 0.0, 1.0))) and not emits(
        emission_graph((1.0, 1.0, 1.0), 0.0)
    )
