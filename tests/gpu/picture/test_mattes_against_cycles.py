"""Cryptomattes cover the same share of each pixel as in Cycles, through the same lens."""

import json

import numpy as np
import pytest

from addon.snapshot.cryptomatte import cryptomatte_id
from tests.pass_pictures import build_scene, render_passes_aplanat, render_passes_cycles, use_passes
from tests.pictures import render_aplanat


def coverage(passes, kind, identifier):
    """Return the coverage of one id, summed over all ranks."""
    total = 0.0
    for name, picture in passes.items():
        if f".{kind}" in name:
            for i in (0, 2):
                total = total + np.where(picture[..., i] == identifier, picture[..., i + 1], 0.0)
    return total


@pytest.fixture(scope="module")
def passes_of_both(aplanat_bpy):
    bpy = aplanat_bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 72, 48
    build_scene(scene)
    use_passes(scene.view_layers[0], "cryptomatte_object", "cryptomatte_material")
    cycles = render_passes_cycles(scene, 512)
    aplanat = render_passes_aplanat(scene, 512)
    return cycles, aplanat


@pytest.mark.parametrize("kind", ["CryptoObject", "CryptoMaterial"])
def test_coverage_of_a_defocused_scene_equals_cycles(passes_of_both, kind):
    (cycles, cycles_header), (aplanat, _) = passes_of_both
    manifest = json.loads(_entry(cycles_header, f"ViewLayer.{kind}", "manifest"))
    seen = 0
    for text in manifest.values():
        identifier = np.uint32(int(text, 16)).view(np.float32)
        expected = coverage(cycles, kind, identifier)
        if not expected.any():
            continue
        seen += 1
        found = coverage(aplanat, kind, identifier)
        # Two independent sample sets of 512: a coverage of one half has a standard error of
        # 0.022 in Cycles' at worst; five of them over a few thousand pixels.
        assert np.abs(found - expected).max() < 0.11
        assert np.abs(found - expected).mean() < 0.004
        assert found.sum() == pytest.approx(expected.sum(), rel=0.005)
    assert seen == 3


def test_coverage_of_blurred_edges_is_partial(passes_of_both):
    _, (aplanat, _) = passes_of_both
    first = aplanat["ViewLayer.CryptoObject00"]
    partial = (first[..., 1] > 0.05) & (first[..., 1] < 0.95)
    assert partial.mean() > 0.05


def test_ranks_fall_and_sum_to_at_most_one(passes_of_both):
    _, (aplanat, _) = passes_of_both
    ranks = [aplanat[f"ViewLayer.CryptoObject{i:02d}"][..., j] for i in range(3) for j in (1, 3)]
    ranks = np.stack(ranks)
    assert (np.diff(ranks, axis=0) <= 0.0).all()
    # One rounding of a float32 a rank.
    assert ranks.sum(axis=0).max() <= 1.0 + 1e-6


@pytest.mark.parametrize("kind", ["CryptoObject", "CryptoMaterial"])
def test_metadata_names_what_cycles_names(passes_of_both, kind):
    (_, cycles_header), (_, header) = passes_of_both
    layer = f"ViewLayer.{kind}"
    for key in ("hash", "conversion", "name"):
        assert _entry(header, layer, key) == _entry(cycles_header, layer, key)
    ours = json.loads(_entry(header, layer, "manifest"))
    theirs = json.loads(_entry(cycles_header, layer, "manifest"))
    assert ours
    assert ours.items() <= theirs.items()


def test_metadata_key_is_the_one_of_cycles(passes_of_both):
    (_, cycles_header), (_, header) = passes_of_both
    keys = {key for key in cycles_header if key.startswith("cryptomatte/")}
    assert keys == {key for key in header if key.startswith("cryptomatte/")}


def _entry(header, layer, what):
    for key, value in header.items():
        if key.startswith("cryptomatte/") and key.endswith("/name") and value == layer:
            return header[key.removesuffix("name") + what]
    raise AssertionError(f"no Cryptomatte metadata of {layer}")


def test_the_cryptomatte_node_picks_an_object_by_name(aplanat_bpy):
    bpy = aplanat_bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 72, 48
    build_scene(scene)
    use_passes(scene.view_layers[0], "cryptomatte_object")
    tree = bpy.data.node_groups.new("pick", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    node = tree.nodes.new("CompositorNodeCryptomatteV2")
    node.source = "RENDER"
    node.scene = scene
    node.layer_name = "ViewLayer.CryptoObject"
    node.matte_id = "Cube"
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(node.outputs["Matte"], output.inputs[0])
    scene.compositing_node_group = tree
    picked = render_aplanat(scene, 32)[..., 0]
    scene.compositing_node_group = None
    passes, _ = render_passes_aplanat(scene, 32)
    identifier = np.float32(cryptomatte_id("Cube"))
    # The compositor may work in half precision.
    assert np.abs(picked - coverage(passes, "CryptoObject", identifier)).max() < 1e-3
    assert picked.max() == pytest.approx(1.0, abs=1e-3)
