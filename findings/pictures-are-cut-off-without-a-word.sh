#!/usr/bin/env bash
# Blender: a picture that could not be written to its end is no error, but for some formats.
#
# Where a disk is full, `Image.save_render` would be expected to raise an exception whatever the
# format, as it does where a folder is missing, and a render with `write_still` not to be FINISHED.
# Seen (bpy 5.2.3): with a limit on the size of files, which a process may give itself
# (RLIMIT_FSIZE), `save_render` raises for OpenEXR, and goes on without a word for PNG; a render is
# FINISHED. The file that is cut off stays in each case. Whoever wants to know looks for its end.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3 numpy==2.5.5
cat >look.py <<'PY'
import os
import resource
import bpy
import numpy as np
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 1
scene.render.resolution_x, scene.render.resolution_y = 64, 64
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
scene.camera = camera
image = bpy.data.images.new("noise", 64, 64, float_buffer=True)
image.pixels.foreach_set(np.random.default_rng(1).random(64 * 64 * 4, np.float32))
most, free = 1000, resource.RLIM_INFINITY


def saved(kind, name):
    """Save the image, and return whether there was an exception, and the size of the file."""
    scene.render.image_settings.file_format = kind
    try:
        image.save_render(os.path.abspath(name), scene=scene)
    except RuntimeError:
        return True, os.path.getsize(name)
    return False, os.path.getsize(name)


assert saved("PNG", "whole.png")[1] > 2 * most and saved("OPEN_EXR", "whole.exr")[1] > 2 * most
resource.setrlimit(resource.RLIMIT_FSIZE, (most, free))
for kind, raises in (("PNG", False), ("OPEN_EXR", True)):
    found = saved(kind, f"cut.{kind}")
    print(f"{kind}, cut off: exception {found[0]}, {found[1]} bytes")
    assert found == (raises, most), found
resource.setrlimit(resource.RLIMIT_FSIZE, (200, free))
scene.render.filepath = os.path.abspath("render.exr")
answer = bpy.ops.render.render(write_still=True)
print("a render, cut off:", answer, os.path.getsize("render.exr"), "bytes")
assert answer == {"FINISHED"} and os.path.getsize("render.exr") == 200
PY
venv/bin/python look.py 2>/dev/null | grep "cut off"
echo "as described"
