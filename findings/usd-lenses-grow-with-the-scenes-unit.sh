#!/usr/bin/env bash
# USD cameras from Blender: in a scene whose unit is a centimetre the lens is a hundred times too large.
#
# USD measures a camera's focal length and apertures in tenths of the scene's unit, so a stage in metres
# has a lens of 40 mm as 0.4. One would expect a scene with a unit scale of 0.01 to come out with
# everything in one measure, and to come back as it was.
# Seen (bpy 5.2.3): places and focus distance are written as if the unit were a metre, whatever the unit
# scale; the lens alone is divided by it. From a scene in centimetres 40 mm come back as 4000 mm with a
# sensor of 3600 mm: the same field of view at the same places, so that nobody sees it, but at the same
# f-stop a pupil of 2 m instead of 2 cm, and with depth of field nothing stays sharp. Writing the stage in
# centimetres changes nothing about it. In millimetres it is a thousand times.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3
cat >look.py <<'PY'
import os

import bpy

path = os.path.abspath("camera.usda")
for unit, stage, factor in (
    (1.0, "METERS", 1.0),
    (1.0, "CENTIMETERS", 1.0),
    (0.01, "METERS", 100.0),
    (0.01, "CENTIMETERS", 100.0),
    (0.001, "METERS", 1000.0),
):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.unit_settings.scale_length = unit
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    camera.location = (0.0, 0.0, 3.0)
    scene.collection.objects.link(camera)
    data.lens, data.sensor_width = 40.0, 36.0
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 3.0, 2.0
    angle = data.angle
    bpy.ops.wm.usd_export(filepath=path, convert_scene_units=stage)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.unit_settings.scale_length = unit
    bpy.ops.wm.usd_import(filepath=path)
    bpy.context.view_layer.update()
    data = bpy.data.cameras[0]
    camera = next(o for o in bpy.data.objects if o.data == data)
    height = camera.matrix_world.translation.z
    pupil = data.lens / data.dof.aperture_fstop
    print(
        f"seen: unit {unit}, stage in {stage.lower()}: lens {data.lens:.6g} mm, sensor"
        f" {data.sensor_width:.6g} mm, pupil {pupil:.6g} mm, focus {data.dof.focus_distance:g}"
        f" of height {height:g}"
    )
    assert abs(data.lens / (40.0 * factor) - 1.0) < 1e-5
    assert abs(data.sensor_width / (36.0 * factor) - 1.0) < 1e-5
    assert abs(data.angle - angle) < 1e-5 and data.dof.aperture_fstop == 2.0
    assert abs(data.dof.focus_distance - 3.0) < 1e-4 and abs(height - 3.0) < 1e-4
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
