#!/usr/bin/env bash
# UDIM images in Cycles: UVs left of the first tile are in the first tile, those right of the last are not.
#
# Tile 1001 holds U and V from 0 to 1. A UV of -0.7 lies in no tile, as one of 2.3 does where there is no
# 1003; one would expect the magenta of what is missing for both, in Cycles as in EEVEE.
# Seen (bpy 5.2.3): Cycles cuts the fraction off towards zero, so that the first column and the first row
# of tiles reach from -1 to 1, and the picture is repeated in them: (-0.7, 0.5) has the colour of (0.3, 0.5),
# (-0.7, 1.5) that of tile 1011. From -1 on, and beyond the last tile, there is magenta. EEVEE has magenta
# for all that is negative. So an island that is off its tile by a margin looks right in a Cycles render.
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

SIZE = 8
COLORS = {1001: (1, 0, 0), 1002: (0, 1, 0), 1011: (0, 0, 1)}
MAGENTA = (1, 0, 1)


def picture(engine, u, v):
    """Return the colours left and right in a picture of the unit square of UVs that begins at (u, v)."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.cycles.samples, scene.cycles.use_denoising = 4, False
    scene.eevee.taa_render_samples = 2
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    scene.render.filepath = os.path.abspath("picture.exr")
    for number, color in COLORS.items():
        # Half as bright on its left.
        pixels = np.ones((4, 4, 4), np.float32)
        pixels[..., :3] = color
        pixels[:, :2, :3] *= 0.5
        tile = bpy.data.images.new("tile", 4, 4)
        tile.pixels.foreach_set(pixels.ravel())
        tile.filepath_raw, tile.file_format = os.path.abspath(f"tile.{number}.png"), "PNG"
        tile.save()
    image = bpy.data.images.load(os.path.abspath("tile.1001.png"))
    image.source, image.filepath = "TILED", os.path.abspath("tile.<UDIM>.png")
    image.colorspace_settings.name = "Non-Color"
    for number in COLORS:
        if number != 1001:
            image.tiles.new(number)
    data = bpy.data.cameras.new("camera")
    scene.camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(scene.camera)
    data.type, data.ortho_scale, scene.camera.location = "ORTHO", 1.0, (0.0, 0.0, 1.0)
    bpy.ops.mesh.primitive_plane_add(size=1)
    mesh = bpy.context.object.data
    for loop in mesh.loops:
        x, y, _ = mesh.vertices[loop.vertex_index].co
        mesh.uv_layers[0].data[loop.index].uv = (x + 0.5 + u, y + 0.5 + v)
    material = bpy.data.materials.new("tiles")
    tree = material.node_tree
    tree.nodes.clear()
    texture, emission, output = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexImage", "Emission", "OutputMaterial")
    )
    texture.image, texture.interpolation = image, "Closest"
    tree.links.new(texture.outputs["Color"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    mesh.materials.append(material)
    bpy.ops.render.render(write_still=True)
    with OpenEXR.File("picture.exr") as file:
        row = file.channels()["RGB"].pixels[SIZE // 2]
    return row[1], row[-2]


for place, in_cycles, in_eevee in (
    ((0, 0), COLORS[1001], COLORS[1001]),
    ((1, 0), COLORS[1002], COLORS[1002]),
    ((2, 0), MAGENTA, MAGENTA),
    ((0, 2), MAGENTA, MAGENTA),
    ((-1, 0), COLORS[1001], MAGENTA),
    ((0, -1), COLORS[1001], MAGENTA),
    ((-1, 1), COLORS[1011], MAGENTA),
    ((-2, 0), MAGENTA, MAGENTA),
):
    for engine, wanted in (("CYCLES", in_cycles), ("BLENDER_EEVEE", in_eevee)):
        left, right = picture(engine, *place)
        print(f"seen: {engine}, UVs from {place}: left {left.round(2)}, right {right.round(2)}")
        dim = 1.0 if wanted == MAGENTA else 0.5
        assert np.abs(right - wanted).max() < 0.01 and np.abs(left - dim * np.array(wanted)).max() < 0.01
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
