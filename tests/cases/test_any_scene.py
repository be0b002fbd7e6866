"""Scenes that ended the default method with an error: each now has its right picture."""

import numpy as np
import pytest

from tests.pictures import energy_ratio, render_cycles

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

# Pixels along the side of the lamp and the flames: 0.1 wide, 9 away, 50 mm on a 36 mm sensor.
_LAMP_PIXELS = (0.1 / 9.0 * 50.0 / 36.0 * 160.0) ** 2


@pytest.mark.parametrize("kind", ["mix", "alpha", "add"])
def test_a_shining_material_that_lets_light_through_has_the_energy_of_the_reference(
    kind, open_case, render_default
):
    open_case(f"g-{kind}")
    picture = render_default()["ViewLayer"]["Combined"]
    expected = render_default(4096, "REFERENCE")["ViewLayer"]["Combined"]
    # The reference decides opacity by chance: 4096 of its samples are within half a percent.
    assert energy_ratio(picture, expected) == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("kind", ["mix", "alpha", "add"])
def test_discs_of_a_shining_material_that_lets_light_through_hold_its_light(
    kind, aplanat_bpy, open_case, render_default
):
    scene = open_case(f"g-{kind}")
    card = next(item for item in scene.objects if item.type == "MESH" and item.location.y < 4.0)
    aplanat_bpy.data.objects.remove(card)
    picture = render_default()["ViewLayer"]["Combined"]
    # Half of the light where it is mixed or has alpha 0.5; added light is whole.
    light = 3 * _LAMP_PIXELS * (30.0 if kind == "add" else 15.0)
    # What is listed are whole texels of a quad of 2.5 pixels.
    assert picture[..., 0].sum(dtype=np.float64) == pytest.approx(light, rel=0.01)


def test_what_is_behind_a_shining_material_shines_through(aplanat_bpy, open_case, render_default):
    scene = open_case("g-mix")
    flame, *others = (x for x in scene.objects if x.type == "MESH" and x.location.y > 4.0)
    flame.location, flame.scale = (0.0, 2.9, -0.2), (2.0, 1.0, 2.0)
    for other in others:
        aplanat_bpy.data.objects.remove(other)
    picture = render_default(256)["ViewLayer"]["Combined"]
    # In focus, 15 pixels wide: the emission of 30 mixed in half before the card of 0.3. Chance
    # decides which of them a sample sees: 15 / sqrt(256 samples x 121 pixels) is half a percent.
    inside = picture[45 - 15 - 5 : 45 - 15 + 6, 80 - 5 : 80 + 6, 0]
    assert inside.mean() == pytest.approx(15.0 + 0.15, rel=0.02)


def test_a_held_out_object_is_a_hole_beside_the_disc_of_a_lamp(open_case, render_default):
    open_case("h1-holdout")
    picture = render_default()["ViewLayer"]["Combined"]
    # The hole's middle: 0.4 to the right at 3, blurred over 4.9 pixels.
    middle = (45, int(80 + 0.4 / 3.0 * 50.0 / 36.0 * 160.0))
    np.testing.assert_array_equal(picture[middle], (0.0, 0.0, 0.0, 0.0))
    np.testing.assert_array_equal(picture[5, 5], (0.0, 0.0, 0.0, 1.0))
    assert picture[..., 0].sum(dtype=np.float64) == pytest.approx(30.0 * _LAMP_PIXELS, rel=0.01)
    # A square of 0.5 at 3.
    hole = (1.0 - picture[..., 3]).sum(dtype=np.float64)
    assert hole == pytest.approx((0.5 / 3.0 * 50.0 / 36.0 * 160.0) ** 2, rel=0.005)


def test_a_world_image_of_one_row_is_seen_and_lights_in_its_colours(
    aplanat_bpy, open_case, render_default
):
    scene = open_case("h2-narrow-world")
    picture = render_default()["ViewLayer"]["Combined"]
    np.testing.assert_allclose(picture[5, 5], (0.2, 0.4, 0.6, 1.0), atol=1e-6)
    np.testing.assert_allclose(picture[45, 80], (1.0, 1.0, 1.0, 1.0), atol=1e-6)
    # A white surface in it has its colours, whatever way it faces.
    white = aplanat_bpy.data.materials.new("white")
    nodes = white.node_tree.nodes
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    output = next(node for node in nodes if node.type == "OUTPUT_MATERIAL")
    white.node_tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    quad = next(item for item in scene.objects if item.type == "MESH")
    quad.data.materials[0] = white
    for tilt in (0.0, 1.2, -1.2):
        quad.rotation_euler.x = tilt
        picture = render_default(64)["ViewLayer"]["Combined"]
        # Half floats keep 11 bits.
        np.testing.assert_allclose(picture[45, 80], (0.2, 0.4, 0.6, 1.0), rtol=2e-3)


def test_colours_of_a_mesh_that_has_none_are_black_as_in_cycles(open_case, render_default):
    scene = open_case("h3-no-colours")
    picture = render_default()["ViewLayer"]["Combined"]
    assert picture[..., :3].max() == 0.0
    np.testing.assert_array_equal(picture[..., 3], 1.0)
    assert render_cycles(scene, 4)[..., :3].max() == 0.0


def test_a_frame_with_nothing_in_view_is_the_world_and_the_next_shows_its_square(
    open_case, render_default
):
    scene = open_case("r1-empty-frame")
    scene.frame_set(1)
    empty = render_default(16)["ViewLayer"]["Combined"]
    np.testing.assert_array_equal(empty[..., :3], 0.0)
    np.testing.assert_array_equal(empty[..., 3], 1.0)
    scene.frame_set(2)
    picture = render_default(16)["ViewLayer"]["Combined"]
    assert picture[45, 80, 0] == pytest.approx(1.0, abs=1e-6)
    # A square of 1 at 5, in focus.
    area = (1.0 / 5.0 * 50.0 / 36.0 * 160.0) ** 2
    assert picture[..., 0].sum(dtype=np.float64) == pytest.approx(area, rel=0.01)


@pytest.mark.parametrize("transparent", [False, True])
@pytest.mark.parametrize("samples", [None, 16])
def test_a_view_layer_without_objects_is_the_world_or_nothing(
    samples, transparent, aplanat_bpy, open_case, render_default
):
    scene = open_case("r1-empty-view-layer")
    world = scene.world = aplanat_bpy.data.worlds.new("world")
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.1, 0.2, 0.3, 1.0)
    scene.render.film_transparent = transparent
    layers = render_default(samples)
    expected = (0.0,) * 4 if transparent else (0.1, 0.2, 0.3, 1.0)
    np.testing.assert_allclose(layers["Empty"]["Combined"] - np.float32(expected), 0.0, atol=1e-6)
    assert layers["ViewLayer"]["Combined"][45, 80, 0] == pytest.approx(1.0, abs=1e-6)
