#!/usr/bin/env bash
# Blender: a float image made by script is saved with the curve of sRGB in it, in EXR and HDR, too.
#
# `images.new(..., float_buffer=True)` says that its colour space is Linear Rec.709, and OpenEXR and
# Radiance HDR are linear formats. One would expect `Image.save` to write the pixels that were set.
# Seen (bpy 5.2.3): 0.4 is written as 0.665, and the image's colour space is sRGB afterwards, also where
# it was set to Linear Rec.709 by hand. The EXR tells so (colorInteropID), so Blender reads it back as it
# was and only other programs are wrong; HDR cannot tell, and is too bright in Blender itself. Nor are
# colours multiplied by alpha, as EXR wants: with an alpha of a half, 0.4 is read back as 0.96. An image
# that is packed first keeps colour space and values, and so does `is_data=True`. A byte image gets
# darker: its EXR holds linear values and tells that they are sRGB. Setting the colour space after
# the pixels, to the same name, throws them away: the file named .exr is then a PNG, and black.
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

COLOR = (0.8, 0.4, 0.2)
CURVED = (0.906, 0.665, 0.485)  # 1.055 COLOR^(1 / 2.4) - 0.055
LINEAR, ENCODED = "lin_rec709_scene", "srgb_rec709_display"


def written(name, kind="OPEN_EXR", alpha=1.0, pack=False, linear=False, **options):
    """Make an image, save it, and return its colour space, and what the file holds and tells."""
    image = bpy.data.images.new(name, 4, 4, alpha=True, **options)
    if linear:
        image.colorspace_settings.name = "Linear Rec.709"
    image.pixels.foreach_set(np.tile(np.array((*COLOR, alpha), np.float32), 16))
    if pack:
        image.pack()
    image.filepath_raw = os.path.abspath(name)
    image.file_format = kind
    image.save()
    if kind != "OPEN_EXR":
        return image.colorspace_settings.name, None, None
    with OpenEXR.File(name) as file:
        color = file.channels()["RGBA"].pixels[0, 0, :3].astype(float)
        return image.colorspace_settings.name, color, file.header()["colorInteropID"]


def read(name):
    """Return the colour of a file as Blender reads it."""
    return np.array(bpy.data.images.load(os.path.abspath(name)).pixels[:3])


bpy.ops.wm.read_factory_settings(use_empty=True)
image = bpy.data.images.new("new", 4, 4, float_buffer=True)
assert image.colorspace_settings.name == "Linear Rec.709"
image.pixels.foreach_set(np.ones(64, np.float32))
image.colorspace_settings.name = "Linear Rec.709"
image.filepath_raw, image.file_format = os.path.abspath("after.exr"), "OPEN_EXR"
image.save()
with open("after.exr", "rb") as file:
    start = file.read(4)
print(f"seen: colour space set after the pixels: file begins with {start}, red {image.pixels[0]}")
assert start == b"\x89PNG" and image.pixels[0] == 0.0
for name, options, space, color, told, back in (
    ("new.exr", {}, "sRGB", CURVED, ENCODED, COLOR),
    ("linear.exr", {"linear": True}, "sRGB", CURVED, ENCODED, COLOR),
    ("alpha.exr", {"alpha": 0.5}, "sRGB", CURVED, ENCODED, (1.969, 0.961, 0.466)),
    ("new.hdr", {"kind": "HDR"}, "sRGB", None, None, CURVED),
    ("packed.exr", {"pack": True}, "Linear Rec.709", COLOR, LINEAR, COLOR),
    ("data.exr", {"is_data": True}, "Non-Color", COLOR, "data", COLOR),
    ("byte.exr", {"float_buffer": False}, "sRGB", (0.604, 0.133, 0.033), ENCODED, None),
):
    found = written(name, **{"float_buffer": True, **options})
    seen = read(name)
    print(f"seen: {name}: image {found[0]}, file {found[1]} {found[2]}, read back {seen.round(3)}")
    assert (found[0], found[2]) == (space, told)
    assert color is None or np.allclose(found[1], color, atol=2e-3)
    assert back is None or np.allclose(seen, back, atol=3e-3)
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
