#!/usr/bin/env bash
# FBX cameras in Blender: keys of focal length and focus distance survive, those of f-stop and shift do not.
#
# A camera whose lens, focus, f-stop and shift are animated goes through FBX and back. One would expect
# all four to move, or none: FBX stores all four, and both importers set all four.
# Seen (bpy 5.2.3, both importers): focal length and focus distance follow their keys; f-stop and shift
# have the value of the first frame in all of them. The picture's blur is then wrong in each frame but
# that one, while a look at the focus says that the animation came along. Of a camera that stands still
# (no keys of its place) nothing moves at all, focus and focal length included.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3
cat >look.py <<'PY'
import os
import bpy
path = os.path.abspath("camera.fbx")


def values():
    scene = bpy.context.scene
    data = next(o.data for o in scene.objects if o.type == "CAMERA")
    for frame in (1, 6, 11):
        scene.frame_set(frame)
        found = (data.lens, data.dof.focus_distance, data.dof.aperture_fstop, data.shift_x)
        yield tuple(round(value, 3) for value in found)


def round_trip(moving, read):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    bpy.context.scene.collection.objects.link(camera)
    bpy.context.scene.frame_end = 11
    data.dof.use_dof = True
    for frame, share in ((1, 0.0), (11, 1.0)):
        data.lens, data.shift_x = 35.0 + 50.0 * share, 0.2 * share
        data.dof.focus_distance, data.dof.aperture_fstop = 2.0 + 3.0 * share, 2.8 + 5.0 * share
        data.keyframe_insert("lens", frame=frame)
        data.keyframe_insert("shift_x", frame=frame)
        data.dof.keyframe_insert("focus_distance", frame=frame)
        data.dof.keyframe_insert("aperture_fstop", frame=frame)
        if moving:
            camera.location.z = share
            camera.keyframe_insert("location", frame=frame)
    made = list(values())
    bpy.context.scene.frame_set(1)
    bpy.ops.export_scene.fbx(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    read(filepath=path)
    return made, list(values())


for read in (bpy.ops.wm.fbx_import, bpy.ops.import_scene.fbx):
    made, found = round_trip(True, read)
    print("moving:", made, "read:", found)
    assert [f[:2] for f in found] == [m[:2] for m in made]
    assert [f[2:] for f in found] == [made[0][2:]] * 3
    made, found = round_trip(False, read)
    print("still:", made, "read:", found)
    assert found == [made[0]] * 3
PY
venv/bin/python look.py 2>/dev/null
echo "as described"
