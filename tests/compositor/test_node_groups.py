"""The node groups against numpy twins, rendered in the background."""

import numpy as np
import OpenEXR
import pytest

from addon.compositor.node_groups import FRINGE, GROUPS, MIX, is_ours, node_group
from addon.compositor.sprite_image import sprite_group, store_sprite
from addon.compositor.wiring import wire_render
from benchmarks.bokeh.charts import many_highlights


def places(shape):
    """Where pixels are: 0 in the middle, length 1 in a corner; and half the diagonal, px."""
    height, width = shape[:2]
    x = np.arange(width) + 0.5 - 0.5 * width
    y = np.arange(height) + 0.5 - 0.5 * height
    half = 0.5 * np.hypot(width, height)
    return np.stack(np.meshgrid(x, y), axis=-1) / half, half


def test_groups_are_made_once_and_marked(aplanat_bpy, empty_scene):
    for name, group in GROUPS.items():
        tree = node_group(name)
        assert tree.name == name and is_ours(tree, name) and node_group(name) == tree
        assert tree.description == group.description
        inputs = [i for i in tree.interface.items_tree if i.in_out == "INPUT"]
        assert all(i.description for i in inputs if i.name not in ("Image",))


def test_a_neutral_mix_is_the_sum_to_the_last_bit(nodes, noise):
    light = np.where(noise > 2.0, noise * 100.0, 0.0).astype(np.float32)
    light[..., 3] = 0.0

    def build(tree):
        links = {"Defocus": nodes.image(tree, noise), "Bokeh": nodes.image(tree, light)}
        return nodes.group(tree, node_group(MIX), links).outputs[0]

    wanted = noise + light
    assert np.array_equal(nodes.through(build), wanted)


def test_mix_has_exposures_colours_and_vignetting(nodes, noise):
    light = noise[::-1] * 5.0

    def build(tree):
        links = {"Defocus": nodes.image(tree, noise), "Bokeh": nodes.image(tree, light)}
        values = {"Defocus_Exposure": -1.0, "Bokeh_Exposure": 2.0, "Bokeh_Saturation": 0.25}
        values |= {"Bokeh_Tint": (1.0, 0.5, 0.25, 1.0), "Vignette": 0.3}
        return nodes.group(tree, node_group(MIX), links, **values).outputs[0]

    found = nodes.through(build)
    bright = 4.0 * light[..., :3]
    # Blender's own luminance of Rec.709.
    grey = bright @ np.array([0.2126, 0.7152, 0.0722])
    bright = grey[..., None] + 0.25 * (bright - grey[..., None])
    place, _ = places(noise.shape)
    falloff = (1.0 + 0.3 * (place**2).sum(axis=-1)) ** -2
    wanted = (0.5 * noise[..., :3] + bright * (1.0, 0.5, 0.25)) * falloff[..., None]
    assert np.allclose(found[..., :3], wanted, rtol=1e-4, atol=1e-4)
    assert np.array_equal(found[..., 3], noise[..., 3])


def test_fringe_at_0_is_the_picture_to_the_last_bit(nodes, noise):
    def build(tree):
        links = {"Image": nodes.image(tree, noise)}
        return nodes.group(tree, node_group(FRINGE), links, Red=0.0, Blue=0.0, Field=3.0).outputs[0]

    assert np.array_equal(nodes.through(build), noise)


def sampled(channel, at):
    """Bilinear, going on at the edges; `at` in pixels from the middle of the first one."""
    height, width = channel.shape
    x, y = np.clip(at[..., 0], 0, width - 1), np.clip(at[..., 1], 0, height - 1)
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    x1, y1 = np.minimum(x0 + 1, width - 1), np.minimum(y0 + 1, height - 1)
    u, v = x - x0, y - y0
    low = channel[y0, x0] * (1 - u) + channel[y0, x1] * u
    high = channel[y1, x0] * (1 - u) + channel[y1, x1] * u
    return low * (1 - v) + high * v


@pytest.mark.parametrize("power", [1.0, 3.0])
def test_fringe_moves_red_and_blue_by_the_field(nodes, noise, power):
    red, blue = 40.0, -25.0

    def build(tree):
        links = {"Image": nodes.image(tree, noise)}
        values = {"Red": red, "Blue": blue, "Field": power}
        return nodes.group(tree, node_group(FRINGE), links, **values).outputs[0]

    found = nodes.through(build)
    place, half = places(noise.shape)
    far = np.linalg.norm(place, axis=-1, keepdims=True)
    pixels = place * half + 0.5 * np.array(noise.shape[1::-1]) - 0.5
    for channel, amount in ((0, red), (2, blue)):
        # What is seen here comes from nearer to the middle, if it is moved outwards.
        shift = place * far ** (power - 1.0) * amount * 1e-3 * half
        wanted = sampled(noise[..., channel].astype(float), pixels - shift)
        assert np.abs(shift).max() > 0.4
        assert np.allclose(found[..., channel], wanted, rtol=0.0, atol=2e-3)
    assert np.array_equal(found[..., [1, 3]], noise[..., [1, 3]])


@pytest.mark.parametrize("blur", ["Convolve", "Bokeh Blur"])
def test_a_point_becomes_the_sprite_upright_with_its_energy(nodes, scene, blur):
    size = 17
    light = np.zeros((size, size), np.float32)
    light[2:9, 3:14], light[9:15, 3:6] = 0.5, 1.0
    group = sprite_group(store_sprite("Bokeh of Test", light))
    point = np.zeros((32, 48, 4), np.float32)
    point[15, 24] = 8.0, 4.0, 2.0, 1.0

    def build(tree):
        sprite = nodes.group(tree, group, {})
        if blur == "Convolve":
            node = tree.nodes.new("CompositorNodeConvolve")
            node.inputs["Kernel Data Type"].default_value = "Color"
            tree.links.new(sprite.outputs["Kernel"], node.inputs[3])
        else:
            node = tree.nodes.new("CompositorNodeBokehBlur")
            node.inputs["Size"].default_value = size // 2
            tree.links.new(sprite.outputs["Bokeh"], node.inputs["Bokeh"])
        tree.links.new(nodes.image(tree, point), node.inputs["Image"])
        return node.outputs[0]

    found = nodes.through(build)
    # Energy of each channel, alpha too, within what Blender's Fourier transform leaves.
    assert np.allclose(found.sum(axis=(0, 1)), point[15, 24], rtol=1e-4)
    wanted = light / light.sum() * 8.0
    half = size // 2
    around = found[15 - half : 16 + half, 24 - half : 25 + half, 0]
    assert np.allclose(around, wanted, atol=1e-4)


def test_the_mix_of_a_render_is_combined(aplanat_bpy, tmp_path):
    bpy = aplanat_bpy
    many_highlights((96, 54), 50)
    scene = bpy.context.scene
    scene.aplanat.method, scene.aplanat.use_target_error = "ADAPTIVE", False
    scene.aplanat.render_samples, scene.aplanat.subsamples = 4, 0
    scene.render.filepath = str(tmp_path / "picture")
    changed, notes = wire_render(scene, scene.view_layers[0])
    assert changed and not notes
    tree = scene.compositing_node_group
    source = next(node for node in tree.nodes if node.type == "R_LAYERS")
    mix = next(node for node in tree.nodes if node.type == "GROUP")
    output = tree.nodes.new("CompositorNodeOutputFile")
    output.directory, output.file_name = f"{tmp_path}/", "parts"
    output.format.media_type = "MULTI_LAYER_IMAGE"
    output.format.file_format = "OPEN_EXR_MULTILAYER"
    output.format.color_depth, output.format.exr_codec = "32", "ZIP"
    for name, socket in (
        ("mix", mix.outputs["Image"]),
        ("combined", source.outputs["Image"]),
        ("highlights", source.outputs["Bokeh"]),
    ):
        output.file_output_items.new("RGBA", name)
        tree.links.new(socket, output.inputs[name])
    bpy.ops.render.render(animation=True, frame_start=1, frame_end=1)
    (path,) = tmp_path.glob("parts*.exr")
    with OpenEXR.File(str(path), separate_channels=True) as file:
        parts = {}
        for part in file.parts:
            for name, channel in part.channels.items():
                parts[name] = np.array(channel.pixels)
    for letter in "RGBA":
        mixed = next(p for name, p in parts.items() if name.endswith(f"mix.{letter}"))
        whole = next(p for name, p in parts.items() if name.endswith(f"combined.{letter}"))
        assert np.array_equal(mixed, whole), letter
    assert max(p.max() for name, p in parts.items() if "highlights.R" in name) > 0.1
