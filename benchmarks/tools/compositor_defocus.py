"""A capture through our lens, and one layer of it through Blender's Defocus node and ours.

    python -m benchmarks.tools.compositor_defocus LAYERS.exr --reference SEED_0.exr SEED_1.exr

Prints SSIM, worst tile and energy of each against what two reference pictures with the capture's
own focus and f-number, but other seeds, have in common (see `compare_with_two`). The one layer is
the capture laid over itself, with the depth of the first surface of each pixel.
"""

import argparse
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))

# Of the Defocus node, which works on squares of this radius: more than any blur of a small picture.
_MOST_BLUR_PX = 64.0


def arguments(words=None):
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("layers", type=Path)
    parser.add_argument("--reference", type=Path, required=True, nargs=2, metavar="EXR")
    parser.add_argument("--samples", type=int, default=128)
    parser.add_argument("--pictures", type=Path, help="folder for PNG files of all")
    return parser.parse_args(words)


def one_layer(stack):
    """Return the colours of a capture laid over itself, and the depth of its first surfaces.

    Parameters
    ----------
    stack : LayerStack

    Returns
    -------
    color : ndarray of shape (height, width, 4)
        Bottom row first, without overscan.
    depth : ndarray of shape (height, width)
        In m; inf where nothing is.
    """
    color = np.zeros_like(stack.layers[0].color)
    depth = np.full(color.shape[:2], np.inf, np.float32)
    for layer in stack.layers:
        through = 1.0 - color[..., 3:]
        seen = np.isinf(depth) & (through[..., 0] * layer.color[..., 3] > 0.5)
        depth[seen] = layer.depth[seen]
        color = color + through * layer.color
    across, up = stack.overscan
    part = np.s_[up : up + stack.height, across : across + stack.width]
    return color[part], depth[part]


def defocused(color, depth, camera):
    """Return a picture through the compositor's Defocus node.

    Parameters
    ----------
    color, depth : ndarray
        As of `one_layer`.
    camera : LayerCamera

    Returns
    -------
    ndarray of shape (height, width, 4)
        Bottom row first.
    """
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    height, width = depth.shape
    render = scene.render
    # Of nothing: only the compositor is wanted.
    render.engine, scene.cycles.samples = "CYCLES", 1
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    data = bpy.data.cameras.new("camera")
    scene.camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(scene.camera)
    data.lens, data.sensor_width = camera.focal_length_mm, (camera.sensor_mm or (36.0, 0.0))[0]
    data.dof.use_dof, data.dof.focus_distance = True, camera.focus_distance
    data.dof.aperture_fstop = camera.f_stop
    tree = scene.compositing_node_group = bpy.data.node_groups.new("c", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    far = np.where(np.isfinite(depth), depth, 1e9)[..., None].repeat(4, axis=2)
    nodes = []
    for name, pixels in (("color", color), ("depth", far)):
        image = bpy.data.images.new(name, width, height, alpha=True, float_buffer=True)
        image.colorspace_settings.name = "Non-Color"
        image.alpha_mode = "CHANNEL_PACKED"
        image.pixels.foreach_set(np.ascontiguousarray(pixels, np.float32).ravel())
        nodes.append(tree.nodes.new("CompositorNodeImage"))
        nodes[-1].image = image
    lens = tree.nodes.new("CompositorNodeDefocus")
    lens.scene, lens.use_zbuffer, lens.f_stop = scene, True, camera.f_stop
    lens.blur_max = _MOST_BLUR_PX
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(nodes[0].outputs["Image"], lens.inputs["Image"])
    tree.links.new(nodes[1].outputs["Image"], lens.inputs["Z"])
    tree.links.new(lens.outputs[0], output.inputs[0])
    from benchmarks.referees.picture_metrics import read_picture
    from benchmarks.scenes.pictures import write_floats

    with tempfile.TemporaryDirectory() as folder:
        write_floats(render, f"{folder}/defocused.exr")
        bpy.ops.render.render(write_still=True)
        return read_picture(Path(render.filepath))[::-1]


def main(words=None):
    """Measure and print."""
    options = arguments(words)
    import addon
    from addon.device.context import ensure_context
    from addon.engine.refocus.refocusing import refocus
    from addon.engine.refocus.settings import RefocusSettings
    from addon.layers.layer_file import load_layers
    from addon.layers.layer_stack import DepthLayer
    from addon.snapshot.camera import BokehSettings
    from benchmarks.referees.picture_metrics import compare_with_two, read_picture, srgb

    addon.register()
    ensure_context()
    stack = load_layers(options.layers)
    truths = [read_picture(file) for file in options.reference]
    color, depth = one_layer(stack)
    nothing = np.isinf(depth)[..., None]
    flat = replace(
        stack,
        layers=(
            DepthLayer(np.where(nothing, 0.0, color).astype(np.float32), depth, 0.0, np.inf),
            DepthLayer(
                np.where(nothing, color, 0.0).astype(np.float32),
                np.full_like(depth, np.inf),
                np.inf,
            ),
        ),
        overscan=(0, 0),
        fills=True,
    )
    settings = RefocusSettings(samples=options.samples, bokeh=BokehSettings())
    pictures = {
        "all layers": refocus(stack, settings),
        "one layer, ours": refocus(flat, settings),
        "one layer, Defocus node": defocused(color, depth, stack.camera),
    }
    for name, picture in pictures.items():
        found = compare_with_two(picture[::-1, :, :3].astype(np.float64), *truths)
        print(
            f"{name}: SSIM {found['ssim_srgb']:.4f}, worst tile {found['ssim_tile']:.3f}, energy"
            f" {found['energy']:.4f}"
        )
    if options.pictures:
        import imageio.v3 as iio

        options.pictures.mkdir(parents=True, exist_ok=True)
        for name, picture in (pictures | {"reference": sum(truths)[::-1] / 2.0}).items():
            shown = (srgb(picture[::-1, :, :3]) * 255.0).astype(np.uint8)
            iio.imwrite(options.pictures / f"{name}.png", shown)


if __name__ == "__main__":
    main()
