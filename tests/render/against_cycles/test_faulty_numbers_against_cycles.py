"""What is no number, infinite or negative is drawn as Cycles draws it, and told."""

import numpy as np
import pytest

from tests.surface_scenes import Tree, add_light, both, card_scene, image, world_image

NAN, INF = float("nan"), float("inf")
# Constant light: nothing but rounding may differ.
EXACT = 1e-5


@pytest.fixture
def bpy(aplanat_bpy):
    return aplanat_bpy


@pytest.fixture
def told(bpy, monkeypatch):
    """What Aplanat's renders have reported."""
    from addon.engine import final_render

    lines = []

    def note(_engine, _session, _scene, report):
        lines.extend(report)

    monkeypatch.setattr(final_render, "_show_report", note)
    return lines


def uniform_image(bpy, value):
    pixels = np.tile(np.float32(value), (4, 4, 1))
    return image(bpy, "faulty", pixels, True, "Linear Rec.709")


def white_world(bpy, color=(1.0, 1.0, 1.0), strength=1.0):
    tree = world_image(bpy, None).node_tree
    node = next(n for n in tree.nodes if n.type == "BACKGROUND")
    node.inputs["Color"].default_value = (*color, 1.0)
    node.inputs["Strength"].default_value = strength
    return tree, node


def assert_equal(scene, cycles_samples=16, tolerance=EXACT):
    ours, cycles = both(scene, cycles_samples)
    assert np.isfinite(ours).all()
    assert ours[..., :3].mean(axis=(0, 1)) == pytest.approx(
        cycles[..., :3].mean(axis=(0, 1)), abs=tolerance
    )
    return ours


FAULTY_TEXELS = [(NAN, 0.4, 0.4, 1.0), (0.4, INF, 0.4, 1.0), (-INF, 0.4, 0.4, 1.0)]


@pytest.mark.parametrize("texel", [*FAULTY_TEXELS, (0.4, 0.5, 0.6, NAN)])
def test_a_texel_that_is_not_finite_is_black_and_transparent(bpy, told, texel):
    scene, _, tree = card_scene(bpy, 4)
    white_world(bpy, (0.25, 0.5, 0.25))
    node = tree.node("TexImage", image=uniform_image(bpy, texel))
    inputs = {"Base Color": node.outputs["Color"], "Alpha": node.outputs["Alpha"]}
    tree.surface(tree.node("BsdfPrincipled", inputs).outputs[0])
    assert_equal(scene)
    tree.emission(node.outputs["Color"])
    assert assert_equal(scene)[0, 0].tolist() == [0.0, 0.0, 0.0, 1.0]
    assert any("'faulty'" in line and "not finite" in line for line in told)


@pytest.mark.parametrize("texel", FAULTY_TEXELS)
def test_a_world_image_drops_texels_that_are_not_finite_as_background_and_light(bpy, told, texel):
    scene, card, tree = card_scene(bpy, 4)
    world, background = white_world(bpy)
    pixels = np.full((8, 16, 4), 0.5, np.float32)
    pixels[4, 3] = texel
    made = image(bpy, "sky", pixels, True, "Linear Rec.709")
    node = Tree(world, "ShaderNodeOutputWorld").node("TexEnvironment", image=made)
    world.links.new(node.outputs[0], background.inputs["Color"])
    tree.surface(tree.node("BsdfDiffuse").outputs[0])
    # The light of one texel less of 128, by the prefiltered map; Cycles has 64 noisy samples.
    assert_equal(scene, 64, tolerance=0.01)
    card.location.x = 5.0
    assert_equal(scene)
    assert any("'sky'" in line and "1 of its pixels" in line for line in told)


@pytest.mark.parametrize("number", [NAN, INF, -INF])
@pytest.mark.parametrize("name", ["Emission Strength", "Alpha", "Metallic", "Roughness", "IOR"])
def test_a_number_that_is_none_counts_as_zero_in_a_principled_surface(bpy, told, name, number):
    scene, _, tree = card_scene(bpy, 4)
    white_world(bpy, (0.5, 0.5, 0.5))
    value = tree.node("Value")
    value.outputs[0].default_value = number
    tree.surface(tree.node("BsdfPrincipled", {name: value.outputs[0]}).outputs[0])
    # Ours approximates what lobes reflect of the world by up to 2 %.
    assert_equal(scene, 256, tolerance=0.01)
    # Blender has taken the Value node's number into the socket that it feeds.
    assert any(f"'{name}' of node 'Principled BSDF'" in line for line in told)


@pytest.mark.parametrize("color", [(NAN, 0.4, 0.3), (-1.0, 0.5, 0.25)])
@pytest.mark.parametrize("kind", ["BsdfDiffuse", "Emission", "BsdfGlossy"])
def test_channels_of_a_color_that_are_none_are_dropped_and_negative_ones_kept_where_light(
    bpy, kind, color
):
    """Emission of a negative colour takes light away; reflection of one is none."""
    scene, _, tree = card_scene(bpy, 4)
    white_world(bpy)
    node = tree.node("CombineXYZ", dict(zip("XYZ", color, strict=True)))
    if not np.isnan(color).any():
        node = tree.node("TexImage", image=uniform_image(bpy, (*color, 1.0)))
        tree.surface(tree.node(kind, {"Color": node.outputs[0]}).outputs[0])
    else:
        tree.surface(tree.node(kind, {"Color": color}).outputs[0])
    # Where a channel of a glossy colour is no number, Cycles leaves repeated scattering out in all.
    glossy = kind == "BsdfGlossy"
    assert_equal(scene, 1024 if glossy else 16, tolerance=0.015 if glossy else EXACT)


def test_glossy_colors_above_white_scatter_repeatedly_as_in_cycles(bpy):
    scene, _, tree = card_scene(bpy, 4)
    white_world(bpy)
    over = tree.node("TexImage", image=uniform_image(bpy, (1.5, 3.0, 5.0, 1.0)))
    tree.surface(tree.node("BsdfGlossy", {"Color": over.outputs[0]}).outputs[0])
    # 1 % of the largest, 9: the albedo table's mean over directions.
    assert_equal(scene, 256, tolerance=0.1)


def test_negative_emission_lamps_and_worlds_take_light_away(bpy):
    scene, card, tree = card_scene(bpy, 4)
    white_world(bpy, (0.2, 0.4, 0.6), -0.5)
    lamp = add_light(bpy, "SUN", (0.0, 0.0, 3.0), energy=-2.0, color=(1.0, 0.5, 0.2))
    parts = {"Shader": tree.node("BsdfDiffuse", {"Color": (0.8, 0.8, 0.8)}).outputs[0]}
    glow = tree.node("Emission", {"Color": (0.5, 0.5, 0.5), "Strength": -0.5})
    parts["Shader_001"] = glow.outputs[0]
    tree.surface(tree.node("AddShader", parts).outputs[0])
    # Cycles chooses between lamp and world by chance.
    ours = assert_equal(scene, 1024, tolerance=0.01)
    assert ours[..., :3].max() < -0.25
    lamp.data.energy = 0.0
    card.location.x = 5.0
    assert assert_equal(scene)[0, 0, 0] == pytest.approx(-0.1)


def test_a_base_color_above_white_brightens_the_diffuse_part_only(bpy):
    scene, _, tree = card_scene(bpy, 4)
    white_world(bpy, (0.5, 0.5, 0.5))
    # A value of the socket itself cannot be above 1.
    over = tree.node("TexImage", image=uniform_image(bpy, (3.0, 1.5, 0.5, 1.0)))
    node = tree.node("BsdfPrincipled", {"Base Color": over.outputs[0], "Specular IOR Level": 0.0})
    tree.surface(node.outputs[0])
    assert_equal(scene, 64, tolerance=1e-3)
    node.inputs["Metallic"].default_value = 1.0
    # Cycles' tables of multiple scattering and ours differ by up to 2 %.
    assert_equal(scene, 256, tolerance=0.01)


@pytest.mark.parametrize(
    "settings",
    [
        {"energy": NAN},
        {"energy": INF},
        {"color": (INF, 1.0, 1.0)},
        {"exposure": NAN},
        {"shadow_soft_size": NAN},
    ],
)
def test_a_lamp_whose_power_or_size_is_none_does_not_shine(bpy, told, settings):
    scene, _, tree = card_scene(bpy, 4)
    white_world(bpy, (0.1, 0.1, 0.1))
    add_light(bpy, "POINT", (0.0, 0.0, 3.0), **{"energy": 100.0, **settings})
    tree.surface(tree.node("BsdfDiffuse").outputs[0])
    assert_equal(scene, 64)
    assert any("'POINT'" in line and "not finite" in line for line in told)


def test_a_world_whose_strength_is_none_is_black(bpy, told):
    scene, card, _ = card_scene(bpy, 4)
    card.location.x = 5.0
    for strength in (NAN, INF):
        white_world(bpy, (0.5, 0.4, 0.3), strength)
        assert (assert_equal(scene)[..., :3] == 0.0).all()
    assert any("'Strength'" in line for line in told)
    assert any("stronger than a picture" in line for line in told)


def test_triangles_and_objects_that_are_nowhere_are_left_out(bpy, told):
    scene, card, tree = card_scene(bpy, 8)
    white_world(bpy, (0.5, 0.5, 0.5))
    tree.emission((0.1, 0.2, 0.3))
    mesh = card.data
    mesh.clear_geometry()
    steps = np.linspace(-1.0, 1.0, 5)
    mesh.from_pydata(
        # Set off, so that no pixel's middle lies on an edge.
        [(1.1 * x + 0.037, 1.1 * y, 0.0) for y in steps for x in steps],
        [],
        [
            (5 * j + i, 5 * j + i + 1, 5 * j + i + 6, 5 * j + i + 5)
            for j in range(4)
            for i in range(4)
        ],
    )
    places = np.empty(75, np.float32)
    mesh.attributes["position"].data.foreach_get("vector", places)
    places[3 * 12] = NAN
    mesh.attributes["position"].data.foreach_set("vector", places)
    lost = card.copy()
    lost.location.y = NAN
    scene.collection.objects.link(lost)
    ours, cycles = both(scene)
    assert np.abs(ours - cycles).max() < EXACT
    # The hole shows the world, the rest of the mesh is there.
    assert set(np.round(ours[..., 0], 3).ravel().tolist()) == {np.float32(0.1), np.float32(0.5)}
    assert any("1 vertices of mesh 'card'" in line for line in told)
    assert any("its transform" in line for line in told)


@pytest.mark.parametrize("assigned", ["no slot", "an empty slot"])
def test_a_surface_without_material_is_blenders_default(bpy, assigned):
    scene, card, _ = card_scene(bpy, 8)
    white_world(bpy, (0.5, 0.5, 0.5))
    add_light(bpy, "SUN", (1.0, 0.0, 1.0), energy=3.0)
    if assigned == "no slot":
        card.data.materials.clear()
    else:
        card.data.materials[0] = None
    # 2 %: how Cycles layers the coat's reflection of the world is fitted, not computed.
    ours = assert_equal(scene, 512, tolerance=0.02)
    # A diffuse surface would be even: this one mirrors the sun where it is seen.
    card.data.materials.clear()
    principled = bpy.data.materials.new("added")
    card.data.materials.append(principled)
    again, _ = both(scene, 1)
    assert np.array_equal(ours, again)


@pytest.mark.parametrize("domain", ["POINT", "CORNER"])
def test_a_channel_of_a_color_attribute_is_none_all_over_a_face_with_a_faulty_corner(
    bpy, told, domain
):
    scene, card, tree = card_scene(bpy, 12)
    mesh = card.data
    mesh.clear_geometry()
    # Two triangles; the diagonal passes between the pixels' middles.
    mesh.from_pydata(
        [(-1.13, -1, 0), (1, -1, 0), (1, 1.09, 0), (-1, 1, 0)], [], [(0, 1, 2), (0, 2, 3)]
    )
    colors = np.tile(np.float32([0.5, 0.4, 0.3, 1.0]), (4 if domain == "POINT" else 6, 1))
    # The second vertex, which only the first triangle has.
    colors[1, 0] = NAN
    mesh.attributes.new("Col", "FLOAT_COLOR", domain).data.foreach_set("color", colors.ravel())
    tree.emission(tree.node("VertexColor", layer_name="Col").outputs["Color"])
    ours, cycles = both(scene)
    assert np.abs(ours - cycles).max() < EXACT
    assert set(np.round(ours[..., 0], 4).ravel().tolist()) == {0.0, 0.5}
    assert any("attribute 'color:Col'" in line for line in told)
