#!/usr/bin/env bash
# Blender: an AOV whose name has a dot stays black, without a word.
#
# An AOV is declared in the view layer and filled by AOV Output nodes of that name. One would expect
# that a name one can type in both places ("key.light", as render farms and other renderers name
# their lights) joins them.
# Seen (bpy 5.2.3, Cycles): the view layer turns the dot into an underscore, the node keeps it. The
# pass `key_light` is written and holds zeros in all four channels; nothing is reported, and
# `AOV.is_valid` is True. With an underscore in the node, too, the pass is filled. A script that
# declares AOVs reads the name back after setting it, and gives that one to the nodes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3 OpenEXR==3.5.3
cat >look.py <<'PY'
import bpy
import OpenEXR

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.engine = "CYCLES"
scene.cycles.samples = 1
scene.render.resolution_x = scene.render.resolution_y = 8
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location = (0.0, 0.0, 5.0)
scene.collection.objects.link(camera)
scene.camera = camera

bpy.ops.mesh.primitive_plane_add(size=20.0)
material = bpy.data.materials.new("wall")
bpy.context.object.data.materials.append(material)
for name in ("key.light", "fill_light"):
    node = material.node_tree.nodes.new("ShaderNodeOutputAOV")
    node.aov_name = name
    node.inputs["Color"].default_value = (0.5, 0.5, 0.5, 1.0)
    aov = scene.view_layers[0].aovs.add()
    aov.name = name
    print(f"node {node.aov_name!r}, view layer {aov.name!r}, valid {aov.is_valid}")
    assert node.aov_name == name and aov.name == name.replace(".", "_") and aov.is_valid

settings = scene.render.image_settings
settings.media_type = "MULTI_LAYER_IMAGE"
settings.file_format = "OPEN_EXR_MULTILAYER"
settings.color_depth = "32"
scene.render.filepath = bpy.path.abspath("//out.exr") or "out.exr"
bpy.ops.render.render(write_still=True)

channels = {}
for part in OpenEXR.File(scene.render.filepath).parts:
    channels.update(part.channels)
for name, expected in (("key_light", 0.0), ("fill_light", 0.5)):
    (pixels,) = (c.pixels for key, c in channels.items() if name in key)
    print(f"pass {name}: {pixels[4, 4].tolist()}")
    assert abs(pixels[..., 0] - expected).max() < 1e-6
PY
venv/bin/python look.py 2>/dev/null | grep -E "^(node|pass)"
echo "as described"
