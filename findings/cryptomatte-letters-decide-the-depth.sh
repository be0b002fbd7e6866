#!/usr/bin/env bash
# Cryptomatte of a Python render engine: the channel letters decide whether the ids survive.
#
# An engine registers its Cryptomatte passes as four-channel colour passes; 'RGBA' is what every
# example of a colour pass uses. At a depth of 16 bits Blender stores colour as half floats, and
# one would expect it to know a Cryptomatte pass by its name.
# Seen (bpy 5.2.3): a pass registered with the letters RGBA is stored as half in a multilayer file
# of 16 bits, so that no id is left as it was; registered as rgba it stays float, and ids are exact.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3 OpenEXR==3.5.3
cat >look.py <<'PY'
import os
import bpy
import numpy as np
import OpenEXR

# An id as Cryptomatte makes them: 32 bits of a hash, read as a float.
ID = np.float32(3.1415926e-7)


class Engine(bpy.types.RenderEngine):
    bl_idname = "CRYPTO"
    bl_label = "Crypto"
    letters = "RGBA"

    def update_render_passes(self, scene, layer):
        self.register_pass(scene, layer, "Combined", 4, "RGBA", "COLOR")
        self.register_pass(scene, layer, "CryptoObject00", 4, self.letters, "COLOR")

    def render(self, depsgraph):
        self.add_pass("CryptoObject00", 4, self.letters, layer=depsgraph.view_layer.name)
        result = self.begin_result(0, 0, 4, 4)
        for layer_pass in result.layers[0].passes:
            layer_pass.rect.foreach_set(np.full(64, ID, np.float32))
        self.end_result(result)


bpy.utils.register_class(Engine)
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
scene.camera = camera
render = scene.render
render.engine = "CRYPTO"
render.resolution_x, render.resolution_y = 4, 4
render.image_settings.media_type = "MULTI_LAYER_IMAGE"
render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
render.image_settings.color_depth = "16"
seen = {}
for letters in ("RGBA", "rgba"):
    Engine.letters = letters
    render.filepath = os.path.abspath(f"{letters}.exr")
    bpy.ops.render.render(write_still=True)
    with OpenEXR.File(render.filepath, separate_channels=True) as file:
        for part in file.parts:
            for name, channel in part.channels.items():
                if "Crypto" in name and name.lower().endswith(".r"):
                    seen[letters] = (channel.pixels.dtype, channel.pixels.ravel()[0])
for letters, (kind, value) in seen.items():
    print(letters, kind, value, "exact" if np.float32(value) == ID else "another id")
assert seen["RGBA"][0] == np.float16 and np.float32(seen["RGBA"][1]) != ID
assert seen["rgba"][0] == np.float32 and seen["rgba"][1] == ID
PY
venv/bin/python look.py 2>/dev/null | grep -i rgba
echo "as described"
