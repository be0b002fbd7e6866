#!/usr/bin/env bash
# Cycles: Depth is what one ray through the middle of the pixel meets, whatever the samples see.
#
# The Depth pass drives a depth of field made afterwards. One would expect it to be the nearest or the
# mean of a pixel's samples, and a pixel that is mostly or half covered to have the object's depth.
# Seen (bpy 5.2.3, 64 samples, box filter, transparent film): at the edge of a sphere every pixel whose
# middle misses it holds 1e10, though half of its samples met the sphere, and no pixel lies between the
# two depths. A wire of a fifth of a pixel on the line between two rows has an alpha of 0.1 in both and
# no depth at all; moved by half a pixel, onto the middles of a row, it has one everywhere. So a depth
# of field by this pass needs the coverage beside it, and thin things can be missing from it.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3 OpenEXR==3.5.3
cat >look.py <<'PY'
import os

import bpy
import numpy as np
import OpenEXR

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 64
scene.cycles.use_denoising = False
scene.cycles.pixel_filter_type = "BOX"  # a sample counts for the pixel that it lies in
scene.render.resolution_x = scene.render.resolution_y = 32
scene.render.film_transparent = True
scene.view_layers[0].use_pass_z = True
settings = scene.render.image_settings
settings.media_type = "MULTI_LAYER_IMAGE"
settings.file_format = "OPEN_EXR_MULTILAYER"
settings.color_depth = "32"
data = bpy.data.cameras.new("camera")
data.type, data.ortho_scale = "ORTHO", 3.2  # a pixel is 0.1 wide
camera = bpy.data.objects.new("camera", data)
camera.location = (0.0, 0.0, 5.0)
scene.collection.objects.link(camera)
scene.camera = camera


def picture(name):
    """Render, and return alpha and depth."""
    scene.render.filepath = os.path.abspath(f"{name}.exr")
    bpy.ops.render.render(write_still=True)
    channels = {}
    for part in OpenEXR.File(scene.render.filepath).parts:
        channels.update(part.channels)
    combined = next(c.pixels for key, c in channels.items() if key.endswith("Combined"))
    depth = next(c.pixels for key, c in channels.items() if "Depth" in key)
    return combined[..., 3], depth


bpy.ops.mesh.primitive_uv_sphere_add(radius=1.2, segments=128, ring_count=64)
alpha, depth = picture("sphere")
partly = (alpha > 0.02) & (alpha < 0.98)
far = partly & (depth > 1e9)
print(f"seen: of {partly.sum()} pixels covered in part {far.sum()} have depth 1e10, "
      f"covered by up to {alpha[far].max():.2f}")
assert far.sum() > 20 and alpha[far].max() > 0.3
assert not ((depth > 10.0) & (depth < 1e9)).any()
bpy.ops.object.delete()

bpy.ops.mesh.primitive_plane_add(size=1.0)
wire = bpy.context.object
wire.scale = (10.0, 0.02, 1.0)
for place, expected in ((0.0, True), (0.05, False)):
    wire.location.y = place
    alpha, depth = picture("wire")
    rows = alpha.mean(axis=1) > 0.05
    print(f"seen: wire at {place}: alpha {np.round(alpha[rows].mean(axis=1), 2).tolist()}, "
          f"pixels with a depth {(depth < 1e9).sum()}")
    assert rows.any() and (not (depth < 1e9).any()) == expected
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
