#!/usr/bin/env bash
# USD cameras in Blender: an f-stop without a focus distance arrives as a focus at 0 m.
#
# UsdGeomCamera has `fStop` and `focusDistance`, both with a default of 0, where an fStop of 0 turns
# depth of field off. Files that author only fStop are common. One would expect the importer to leave
# depth of field off, or to keep Blender's own distance of 10 m.
# Seen (bpy 5.2.3): use_dof is True and focus_distance 0.0, so that everything is out of focus at
# once; a camera that authors neither arrives with use_dof False.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3
cat >camera.usda <<'USD'
#usda 1.0
(
    defaultPrim = "root"
    metersPerUnit = 1
    upAxis = "Z"
)
def Xform "root"
{
    def Camera "with_f_stop"
    {
        float fStop = 2.8
        float focalLength = 50
    }
    def Camera "plain"
    {
        float focalLength = 50
    }
}
USD
cat >look.py <<'PY'
import os
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.usd_import(filepath=os.path.abspath("camera.usda"))
found = {camera.name: camera.dof for camera in bpy.data.cameras}
for name, dof in found.items():
    print(name, dof.use_dof, dof.focus_distance, dof.aperture_fstop)
dof = found["with_f_stop"]
assert dof.use_dof and dof.focus_distance == 0.0 and abs(dof.aperture_fstop - 2.8) < 1e-6
assert not found["plain"].use_dof
PY
venv/bin/python look.py 2>/dev/null
echo "as described"
