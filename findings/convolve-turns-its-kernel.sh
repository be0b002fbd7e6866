#!/usr/bin/env bash
# Blender's compositor: Convolve turns its kernel by half a turn, Bokeh Blur does not.
#
# A point of light through either node would be expected to become the picture of the kernel (bokeh)
# as it is: that is what a convolution does, and what Bokeh Blur does.
# Seen (bpy 5.2.3): of the same image, Bokeh Blur makes the picture as it is, Convolve the one that is
# turned by half a turn (a correlation). So a kernel that is not symmetric has to be flipped first.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3 numpy==2.5.5 OpenEXR==3.5.3
cat >look.py <<'PY'
import os
import bpy
import numpy as np
import OpenEXR
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 1
scene.render.resolution_x, scene.render.resolution_y = 32, 32
scene.render.filepath = os.path.abspath("picture.exr")
settings = scene.render.image_settings
settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGBA", "32"
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
scene.camera = camera


def image(pixels):
    made = bpy.data.images.new(
        "pixels", pixels.shape[1], pixels.shape[0], alpha=True, float_buffer=True, is_data=True
    )
    made.pixels.foreach_set(np.repeat(pixels[..., None], 4, axis=-1).astype(np.float32).ravel())
    made.pack()
    return made


kernel = np.zeros((9, 9))
kernel[0:4, 0:2] = 1.0  # lower left, of an odd number of pixels so that its middle is a pixel
point = np.zeros((32, 32))
point[16, 16] = 8.0


def through(kind):
    tree = bpy.data.node_groups.new(kind, "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    blur, end = tree.nodes.new(kind), tree.nodes.new("NodeGroupOutput")
    images = [tree.nodes.new("CompositorNodeImage") for _ in range(2)]
    images[0].image, images[1].image = image(point), image(kernel)
    tree.links.new(images[0].outputs[0], blur.inputs["Image"])
    if kind == "CompositorNodeConvolve":
        blur.inputs["Kernel Data Type"].default_value = "Color"
        tree.links.new(images[1].outputs[0], blur.inputs[3])
    else:
        blur.inputs["Size"].default_value = 4
        tree.links.new(images[1].outputs[0], blur.inputs["Bokeh"])
    tree.links.new(blur.outputs[0], end.inputs[0])
    scene.compositing_node_group = tree
    bpy.ops.render.render(write_still=True)
    with OpenEXR.File("picture.exr") as file:
        rows = np.array(file.channels()["RGBA"].pixels)[::-1]
    return rows[12:21, 12:21, 0]


wanted = kernel / kernel.sum() * 8.0
blurred, convolved = through("CompositorNodeBokehBlur"), through("CompositorNodeConvolve")
for name, found in (("Bokeh Blur", blurred), ("Convolve", convolved)):
    print(name, "as it is:", np.allclose(found, wanted, atol=1e-3), end="; ")
    print("turned:", np.allclose(found, wanted[::-1, ::-1], atol=1e-3))
assert np.allclose(blurred, wanted, atol=1e-3)
assert np.allclose(convolved, wanted[::-1, ::-1], atol=1e-3)
PY
venv/bin/python look.py 2>/dev/null | grep as.it.is
echo "as described"
