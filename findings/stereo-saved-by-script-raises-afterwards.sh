#!/usr/bin/env bash
# Blender: saving a stereo render by script writes both eyes and then says that it could not.
#
# `Image.save_render` of the Render Result is how a script writes a picture again with other settings.
# One would expect an error to mean that nothing was written, and Stereo 3D (one file, side by side)
# to be obeyed as it is when the render itself writes.
# Seen (bpy 5.2.3): with multiview both eyes are written, whole, as NAME_L and NAME_R, and then a
# RuntimeError says the picture could not be saved. That is so for Stereo 3D and for Individual views
# alike: the one side-by-side file is only written by `render(write_still=True)`.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3
cat >look.py <<'PY'
import os

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 1
scene.render.resolution_x = scene.render.resolution_y = 16
scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(scene.camera)
scene.render.use_multiview = True
scene.render.image_settings.file_format = "PNG"
scene.render.image_settings.stereo_3d_format.display_mode = "SIDEBYSIDE"


def size(path):
    """Return a picture's width and height."""
    image = bpy.data.images.load(os.path.abspath(path))
    return tuple(image.size)


for views in ("STEREO_3D", "INDIVIDUAL"):
    scene.render.image_settings.views_format = views
    scene.render.filepath = os.path.abspath(f"render_{views}.png")
    bpy.ops.render.render(write_still=True)
    raised = False
    try:
        bpy.data.images["Render Result"].save_render(os.path.abspath(f"saved_{views}.png"))
    except RuntimeError as error:
        raised = "could not be saved" in str(error)
    files = sorted(f for f in os.listdir(".") if views in f and f.endswith(".png"))
    print(f"seen: {views}: raised {raised}, files {files}")
    saved = [f"saved_{views}_L.png", f"saved_{views}_R.png"]
    assert raised and [f for f in files if f.startswith("saved")] == saved
    assert [size(f) for f in saved] == [(16, 16)] * 2
    if views == "STEREO_3D":
        assert f"render_{views}.png" in files and size(f"render_{views}.png") == (32, 16)
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
