#!/usr/bin/env bash
# Cycles: the blur of a panoramic camera follows the focal length of the camera that it no longer is.
#
# A fisheye has a lens of its own (`fisheye_lens`), other panoramas have none, and their panel shows no
# focal length. One would expect the f-stop to divide the fisheye's lens, or a fixed one.
# Seen (bpy 5.2.3): it divides `Camera.lens`, the focal length of the perspective camera, which the panel
# hides for panoramas and which has no influence on what they frame. At one f-stop the blur is twice as
# wide after `lens` went from 50 to 100 mm, in a fisheye and in an equirectangular picture. Twice the
# `fisheye_lens` makes the whole fisheye picture twice as large and the blur with it, not four times as
# large as a lens of that focal length would. So two cameras that look the same in their panels blur
# differently, and who makes a panorama by script sets `lens` for its depth of field.
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

SIZE, SAMPLES = 64, 256


def radius(kind, lens, fisheye_lens):
    """Return the height of a small lamp's blur in pixels: twice the deviation, the lamp's own included."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_adaptive_sampling = SAMPLES, False
    scene.cycles.use_denoising, scene.cycles.pixel_filter_type = False, "BOX"
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    scene.render.filepath = os.path.abspath("picture.exr")
    data = bpy.data.cameras.new("camera")
    scene.camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(scene.camera)
    data.type, data.panorama_type, data.fisheye_fov = "PANO", kind, 2.0
    data.lens, data.fisheye_lens = lens, fisheye_lens
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 2.0, 0.04
    bpy.ops.mesh.primitive_plane_add(size=0.3, location=(0.0, 0.0, -6.0))
    material = bpy.data.materials.new("lamp")
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    shader.inputs["Emission Strength"].default_value = 100.0
    bpy.context.object.data.materials.append(material)
    bpy.ops.render.render(write_still=True)
    with OpenEXR.File("picture.exr") as file:
        light = file.channels()["RGB"].pixels.mean(-1).astype(float)
    rows, place = light.sum(1) / light.sum(), np.arange(SIZE)
    return 2.0 * np.sqrt((rows * (place - (rows * place).sum()) ** 2).sum())


for kind in ("FISHEYE_EQUISOLID", "EQUIRECTANGULAR"):
    found = [radius(kind, *lenses) for lenses in ((50.0, 10.5), (100.0, 10.5), (50.0, 21.0))]
    print(f"seen: {kind}: {found[0]:.2f} px, lens x 2 {found[1]:.2f}, fisheye lens x 2 {found[2]:.2f}")
    # The lamp's own size, the projection and noise give and take some of the factor of two.
    assert 1.6 < found[1] / found[0] < 2.1
    scale = 2.0 if kind == "FISHEYE_EQUISOLID" else 1.0
    assert abs(found[2] / found[0] / scale - 1.0) < 0.1
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
