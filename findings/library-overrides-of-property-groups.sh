#!/usr/bin/env bash
# Blender: overridable property groups of add-ons lose their library overrides on reload.
#
# A PropertyGroup and its pointer are declared with override={'LIBRARY_OVERRIDABLE'}. A camera is
# linked, overridden, its setting changed, and the file saved. One would expect the setting back.
# Seen (bpy 5.2.3): a group is stored only after its first use. If the library's camera never used
# its group, Blender stores one operation that replaces the whole group, and refuses it on opening
# ("RNA_property_pointer_set: expected ID type"): the setting is the default again. Reading any
# setting of `override_library.reference` once before saving is enough to have each setting stored
# by itself, and kept.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3
cat >look.py <<'PY'
import os
import sys

import bpy

OPTION = {"LIBRARY_OVERRIDABLE"}


class LensSettings(bpy.types.PropertyGroup):
    strength: bpy.props.FloatProperty(default=1.0, override=OPTION)


def start():
    bpy.ops.wm.read_factory_settings(use_empty=True)


bpy.utils.register_class(LensSettings)
bpy.types.Camera.lens_settings = bpy.props.PointerProperty(type=LensSettings, override=OPTION)


def library(touched):
    start()
    data = bpy.data.cameras.new("camera")
    data.use_fake_user = True
    if touched:
        data.lens_settings.strength = 2.0
    path = os.path.abspath("library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path, check_existing=False)
    return path


def round_trip(touched, read_first):
    path = library(touched)
    start()
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.cameras = ["camera"]
    data = bpy.data.cameras["camera"].override_create()
    data.use_fake_user = True
    data.lens_settings.strength = 5.0
    if read_first:
        _ = data.override_library.reference.lens_settings.strength
    shot = os.path.abspath("shot.blend")
    bpy.ops.wm.save_as_mainfile(filepath=shot, check_existing=False)
    stored = [
        (p.rna_path, [o.operation for o in p.operations]) for p in data.override_library.properties
    ]
    bpy.ops.wm.open_mainfile(filepath=shot)
    data = next(c for c in bpy.data.cameras if c.override_library)
    return data.lens_settings.strength, stored


seen = {
    (touched, read_first): round_trip(touched, read_first)
    for touched in (True, False)
    for read_first in (True, False)
}
for (touched, read_first), (strength, stored) in seen.items():
    used = "used" if touched else "never used"
    print(f"library {used}, reference read {read_first}: {strength}, stored {stored}")
assert seen[True, False][0] == seen[True, True][0] == seen[False, True][0] == 5.0
assert seen[False, False] == (1.0, [("lens_settings", ["REPLACE"])])
PY
venv/bin/python look.py 2>/dev/null | grep library
echo "as described"
