#!/usr/bin/env bash
# Blender: the depth of field of an orthographic camera is that of two different lenses.
#
# Cycles and EEVEE blur what a perspective camera sees by its focal length over its f-stop, EEVEE's discs
# being a little larger. One would expect one measure for an orthographic camera, too.
# Seen (bpy 5.2.3): neither asks for the focal length there. Cycles takes 1 m: at f/0.25, focus 4, 6 away,
# and 8 pixels a unit, a lamp gets a disc of 8 pixels radius, whether the lens is 50 or 100 mm. EEVEE takes
# about a sixth of that: at f/0.25 the lamp is hardly larger than without depth of field, and at f/0.05 the
# disc is smaller than Cycles' at f/0.25. So whoever sets up such a shot in EEVEE's viewport gets five to
# six times the blur from Cycles.
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

SIZE = 64


def radius(engine, kind, f_stop, lens=50.0):
    """Return the radius of a small lamp's blur in pixels: twice the deviation, the lamp's own included."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.cycles.samples, scene.cycles.use_adaptive_sampling = 256, False
    scene.cycles.use_denoising, scene.cycles.pixel_filter_type = False, "BOX"
    scene.eevee.taa_render_samples = 4
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    scene.render.filepath = os.path.abspath("picture.exr")
    data = bpy.data.cameras.new("camera")
    scene.camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(scene.camera)
    data.type, data.ortho_scale, data.lens = kind, 8.0, lens
    data.dof.use_dof, data.dof.focus_distance = f_stop is not None, 4.0
    data.dof.aperture_fstop = f_stop or 1.0
    bpy.ops.mesh.primitive_plane_add(size=0.3, location=(0.0, 0.0, -6.0))
    material = bpy.data.materials.new("lamp")
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    shader.inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    shader.inputs["Emission Strength"].default_value = 1.0
    bpy.context.object.data.materials.append(material)
    bpy.ops.render.render(write_still=True)
    with OpenEXR.File("picture.exr") as file:
        light = file.channels()["RGB"].pixels.mean(-1).astype(float)
    columns, place = light.sum(0) / light.sum(), np.arange(SIZE)
    return 2.0 * np.sqrt((columns * (place - (columns * place).sum()) ** 2).sum())


found = {}
for engine in ("CYCLES", "BLENDER_EEVEE"):
    for kind, f_stop, lens in (
        ("PERSP", 0.05, 50.0),
        ("ORTHO", None, 50.0),
        ("ORTHO", 0.25, 50.0),
        ("ORTHO", 0.25, 100.0),
        ("ORTHO", 0.05, 50.0),
    ):
        found[engine, kind, f_stop, lens] = value = radius(engine, kind, f_stop, lens)
        print(f"seen: {engine} {kind}, f-stop {f_stop}, lens {lens:g}: {value:.2f} px")
cycles = {key[1:]: value for key, value in found.items() if key[0] == "CYCLES"}
eevee = {key[1:]: value for key, value in found.items() if key[0] != "CYCLES"}
assert 0.9 < eevee["PERSP", 0.05, 50.0] / cycles["PERSP", 0.05, 50.0] < 1.3
assert abs(cycles["ORTHO", 0.25, 50.0] - 8.0) < 0.5 and eevee["ORTHO", 0.05, 50.0] < 7.5
for seen in (cycles, eevee):
    assert abs(seen["ORTHO", 0.25, 50.0] / seen["ORTHO", 0.25, 100.0] - 1.0) < 0.02
# Without the lamp's own size: deviations add up in squares.
blur = [(s["ORTHO", 0.25, 50.0] ** 2 - s["ORTHO", None, 50.0] ** 2) ** 0.5 for s in (cycles, eevee)]
assert 4.0 < blur[0] / blur[1] < 7.0
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
