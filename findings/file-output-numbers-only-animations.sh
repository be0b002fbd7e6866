#!/usr/bin/env bash
# Blender's compositor: File Output nodes number their files only in an animation render.
#
# A script that renders frame after frame with `frame_set(n)` and `bpy.ops.render.render()` would be
# expected to leave one file a frame, as `blender -f n` does.
# Seen (bpy 5.2.3): each still overwrites the same file, whose name has no number;
# `render(animation=True, frame_start=n, frame_end=n)` numbers it.
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
scene.render.resolution_x, scene.render.resolution_y = 8, 8
scene.render.filepath = os.path.abspath("frames/frame_")
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
scene.camera = camera
tree = bpy.data.node_groups.new("compositor", "CompositorNodeTree")
scene.compositing_node_group = tree
tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
layers, end, out = (
    tree.nodes.new(kind)
    for kind in ("CompositorNodeRLayers", "NodeGroupOutput", "CompositorNodeOutputFile")
)
tree.links.new(layers.outputs["Image"], end.inputs[0])
out.directory, out.file_name = os.path.abspath("stills"), "node_"
out.file_output_items.new("RGBA", "Image")
tree.links.new(layers.outputs["Image"], out.inputs[0])
for frame in (1, 2):
    scene.frame_set(frame)
    bpy.ops.render.render()
stills = sorted(os.listdir("stills"))
out.directory = os.path.abspath("animation")
for frame in (1, 2):
    bpy.ops.render.render(animation=True, frame_start=frame, frame_end=frame)
numbered = sorted(os.listdir("animation"))
print(stills, numbered)
assert len(stills) == 1 and not any(letter.isdigit() for letter in stills[0]), stills
assert len(numbered) == 2 and "0001" in numbered[0] and "0002" in numbered[1], numbered
PY
venv/bin/python look.py 2>/dev/null
echo "as described"
