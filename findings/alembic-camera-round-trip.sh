#!/usr/bin/env bash
# Alembic cameras in Blender: the round trip keeps focus distance and f-stop, and loses the rest.
#
# Alembic's camera has focus distance, f-stop and both apertures. One would expect a camera that
# Blender wrote to come back with its framing.
# Seen (bpy 5.2.3): a sensor fit of VERTICAL comes back as AUTO (of a 30 x 20 mm sensor in a wide
# picture that is another field of view), depth of field is off, blades and ratio are the defaults.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3
cat >look.py <<'PY'
import os
import bpy
path = os.path.abspath("camera.abc")
bpy.ops.wm.read_factory_settings(use_empty=True)
data = bpy.data.cameras.new("camera")
bpy.context.scene.collection.objects.link(bpy.data.objects.new("camera", data))
data.sensor_fit, data.sensor_width, data.sensor_height = "VERTICAL", 30.0, 20.0
data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 3.0, 1.4
data.dof.aperture_blades, data.dof.aperture_ratio = 7, 2.0
bpy.ops.wm.alembic_export(filepath=path, as_background_job=False)
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.alembic_import(filepath=path, as_background_job=False)
data = bpy.data.cameras[0]
dof = data.dof
print(data.sensor_fit, data.sensor_width, data.sensor_height)
print(dof.use_dof, dof.focus_distance, dof.aperture_fstop, dof.aperture_blades, dof.aperture_ratio)
assert (data.sensor_fit, data.sensor_width, data.sensor_height) == ("AUTO", 30.0, 20.0)
assert abs(dof.focus_distance - 3.0) < 1e-6 and abs(dof.aperture_fstop - 1.4) < 1e-6
assert not dof.use_dof and dof.aperture_blades == 0 and dof.aperture_ratio == 1.0
PY
venv/bin/python look.py 2>/dev/null
echo "as described"
