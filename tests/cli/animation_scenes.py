"""Scenes with compositors and views, and their files from Blender and from us."""

import imageio.v3 as iio
import numpy as np
import OpenEXR


def read_exr(path):
    """Return every channel of every part, by the part's name and its own, and the headers."""
    channels, headers = {}, {}
    with OpenEXR.File(str(path), separate_channels=True) as file:
        for part in file.parts:
            name = part.header["name"]
            headers[name] = dict(part.header)
            for key, channel in part.channels.items():
                channels[name, key] = np.array(channel.pixels)
    return channels, headers


def add_compositor(bpy, scene):
    """Give a scene a compositor that shows the picture; return its tree and Render Layers."""
    tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    layers, end = (tree.nodes.new(k) for k in ("CompositorNodeRLayers", "NodeGroupOutput"))
    tree.links.new(layers.outputs["Image"], end.inputs["Image"])
    scene.compositing_node_group = tree
    return tree, layers


def add_file_output(tree, source, directory, name, file_format=None, items=("Image",)):
    """Add a File Output node fed by `source`, with an item for each name."""
    node = tree.nodes.new("CompositorNodeOutputFile")
    node.directory, node.file_name = directory, name
    if file_format is not None:
        node.format.media_type = "IMAGE"
        node.format.file_format = file_format
    for item in items:
        node.file_output_items.new("RGBA", item)
    for socket in node.inputs[: len(items)]:
        tree.links.new(source, socket)
    return node


def one_node(bpy, scene):
    tree, layers = add_compositor(bpy, scene)
    add_file_output(tree, layers.outputs["Image"], "//files/", "node_")


def many_nodes(bpy, scene):
    """Folders, formats, slots with their own format, subfolders, patterns, names of all kinds."""
    tree, layers = add_compositor(bpy, scene)
    image = layers.outputs["Image"]
    add_file_output(tree, image, "//a/", "multilayer_", items=("one", "two"))
    add_file_output(tree, image, "//b/", "png_", "PNG", ("one", "two/three", "x####y", "Tail_"))
    add_file_output(tree, image, "//c/{blend_name}", "exr_{resolution_x}_", "OPEN_EXR")
    add_file_output(tree, image, "{blend_dir}/d/", "sub/deep_", "JPEG")
    add_file_output(tree, image, "//e/../f", "up/../down/#_", "PNG", ("../out", "in"))
    add_file_output(tree, image, "//g", "", "PNG")
    mixed = add_file_output(tree, image, "//h/", "mixed_", "PNG", ("plain", "other"))
    mixed.file_output_items[1].override_node_format = True
    mixed.file_output_items[1].format.file_format = "TIFF"
    bare = add_file_output(tree, image, "//i/", "bare_", "PNG")
    bare.use_file_extension = False
    add_file_output(tree, image, "//j/", "muted_", "PNG").mute = True
    unlinked = tree.nodes.new("CompositorNodeOutputFile")
    unlinked.directory = "//k/"
    unlinked.file_output_items.new("RGBA", "Image")


def nodes_in_groups(bpy, scene):
    tree, layers = add_compositor(bpy, scene)
    inner = bpy.data.node_groups.new("inner", "CompositorNodeTree")
    inner.interface.new_socket("Image", in_out="INPUT", socket_type="NodeSocketColor")
    start = inner.nodes.new("NodeGroupInput")
    add_file_output(inner, start.outputs[0], "//nested/", "n_", "PNG")
    for _ in range(2):
        group = tree.nodes.new("CompositorNodeGroup")
        group.node_tree = inner
        tree.links.new(layers.outputs["Image"], group.inputs[0])


def nodes_only(bpy, scene):
    one_node(bpy, scene)
    scene.render.save_output = False


def no_compositing(bpy, scene):
    one_node(bpy, scene)
    scene.render.use_compositing = False


def two_eyes(views_format, stereo="INDIVIDUAL", file_format="PNG"):
    def change(bpy, scene):
        one_node(bpy, scene)
        render = scene.render
        render.use_multiview, render.views_format = True, views_format
        render.image_settings.file_format = file_format
        render.image_settings.views_format = stereo
        render.image_settings.stereo_3d_format.display_mode = "SIDEBYSIDE"

    return change


def odd_output(bpy, scene):
    scene.render.filepath = "//{scene_name}/../shot.##.v1"
    scene.render.use_file_extension = False


def every_second(bpy, scene):
    one_node(bpy, scene)
    scene.frame_step = 2


def multilayer(bpy, scene):
    one_node(bpy, scene)
    scene.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"


def png_of(folder):
    return {path.name: iio.imread(path).shape[:2] for path in folder.glob("*.png")}
