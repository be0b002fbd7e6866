#!/usr/bin/env bash
# glTF and FBX into Blender: what an orthographic camera frames stays as it is when the scene is scaled.
#
# In a scene whose unit is a centimetre the importers make sizes fit: a glTF of metres gets a hundred
# times larger, an FBX comes back a hundred times smaller (Blender's own FBX reader of 5.x; the one in
# Python before it keeps the size). One would expect a camera to show the same picture of the scaled scene.
# Seen (bpy 5.2.3): places, sizes, and for FBX the clipping distances are scaled; the orthographic scale
# is not, in either. A cube that filled half of the frame is fifty times as wide as the frame, or half a
# hundredth of it. With glTF the clipping planes stay as well, and cut everything off. Perspective
# cameras show nothing of it.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3
cat >look.py <<'PY'
import os

import bpy


def empty():
    """Open an empty scene in centimetres, and return it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.unit_settings.scale_length = 0.01
    return scene


scene = empty()
data = bpy.data.cameras.new("camera")
data.type, data.ortho_scale, data.clip_end = "ORTHO", 4.0, 50.0
camera = bpy.data.objects.new("camera", data)
camera.location = (0.0, 0.0, 10.0)
scene.collection.objects.link(camera)
bpy.ops.mesh.primitive_cube_add(size=2.0)
bpy.ops.export_scene.gltf(filepath=os.path.abspath("scene.glb"), export_cameras=True)
bpy.ops.export_scene.fbx(filepath=os.path.abspath("scene.fbx"))
for name, reader, scale, clip in (
    ("glb", bpy.ops.import_scene.gltf, 100.0, 50.0),
    ("fbx", bpy.ops.wm.fbx_import, 0.01, 0.5),
    ("fbx", bpy.ops.import_scene.fbx, 1.0, 50.0),
):
    empty()
    reader(filepath=os.path.abspath(f"scene.{name}"))
    bpy.context.view_layer.update()
    data = bpy.data.cameras[0]
    camera = next(o for o in bpy.data.objects if o.data == data)
    cube = next(o for o in bpy.data.objects if o.type == "MESH")
    distance, width = camera.matrix_world.translation.z, cube.dimensions.x
    print(
        f"seen: {name}: cube {width:g} wide at {distance:g}, frame {data.ortho_scale:g},"
        f" clipped beyond {data.clip_end:g}"
    )
    assert abs(distance / (10.0 * scale) - 1.0) < 1e-4 and abs(width / (2.0 * scale) - 1.0) < 1e-4
    assert abs(data.ortho_scale - 4.0) < 1e-5 and abs(data.clip_end / clip - 1.0) < 1e-4
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
