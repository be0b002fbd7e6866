#!/usr/bin/env bash
# Blender: what a library override changed is gone once an add-on renames the property.
#
# An add-on that renames a setting reads the old value from what the file stored under the old name
# (`bl_system_properties_get` shows values whose property is not declared any more) and sets the new
# one, when the file has been opened. One would expect the same of a library override: its data-block
# stores values, too.
# Seen (bpy 5.2.3): for a data-block of the file itself the old value is there. For an override it is
# the library's value: Blender makes an override anew from the library and applies the changes by the
# path of the property, before any handler runs; where that path is gone the change is dropped, and
# saving makes that final. An add-on that renames has to keep the old property declared, hidden and
# overridable, to read it.
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


def declare(*names):
    """Declare a group of camera settings with properties of these names."""
    group = type(
        "LensGroup",
        (bpy.types.PropertyGroup,),
        {"__annotations__": {n: bpy.props.FloatProperty(default=1.0, override=OPTION) for n in names}},
    )
    bpy.utils.register_class(group)
    bpy.types.Camera.lens_group = bpy.props.PointerProperty(type=group, override=OPTION)


def stored(camera):
    """Return what the file stored of a camera's group under the old name."""
    return camera.bl_system_properties_get()["lens_group"].get("blur")


step = sys.argv[1]
bpy.ops.wm.read_factory_settings(use_empty=True)
if step == "library":
    declare("blur")
    camera = bpy.data.cameras.new("linked")
    camera.use_fake_user = True
    camera.lens_group.blur = 2.0
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath("library.blend"))
elif step == "shot":
    declare("blur")
    with bpy.data.libraries.load(os.path.abspath("library.blend"), link=True) as (_, to):
        to.cameras = ["linked"]
    own = bpy.data.cameras.new("own")
    own.lens_group.blur = 5.0
    changed = to.cameras[0].override_create()
    # Stored property by property only if the library's group was read once.
    changed.override_library.reference.lens_group.blur
    changed.lens_group.blur = 7.0
    own.use_fake_user = changed.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath("shot.blend"))
else:
    declare("softness", *(["blur"] if step == "kept" else []))
    bpy.ops.wm.open_mainfile(filepath=os.path.abspath("shot.blend"))
    own = bpy.data.cameras["own"]
    changed = next(c for c in bpy.data.cameras if c.override_library)
    print(f"{step}: own {stored(own)}, override {stored(changed)}")
    assert stored(own) == 5.0
    assert stored(changed) == (7.0 if step == "kept" else 2.0)
PY
for step in library shot renamed kept; do
    venv/bin/python look.py "$step" 2>/dev/null | grep "own" || [ "$step" = library ] || [ "$step" = shot ]
done
echo "as described"
