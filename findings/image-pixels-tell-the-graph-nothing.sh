#!/usr/bin/env bash
# Blender: writing an image's pixels from Python tells the dependency graph nothing.
#
# `Image.pixels.foreach_set` followed by `Image.update()` is how scripts fill images. A render engine
# that keeps what it read until the graph reports a change would expect a report.
# Seen (bpy 5.2.3): no update is reported for the image after foreach_set and update();
# `update_tag()` makes one.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3
cat >look.py <<'PY'
import bpy
import numpy as np
bpy.ops.wm.read_factory_settings(use_empty=True)
image = bpy.data.images.new("image", 4, 4)
material = bpy.data.materials.new("material")
tree = material.node_tree
node = tree.nodes.new("ShaderNodeTexImage")
node.image = image
tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs[0])
mesh = bpy.data.meshes.new("mesh")
mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
mesh.materials.append(material)
bpy.context.scene.collection.objects.link(bpy.data.objects.new("object", mesh))
seen = []
bpy.app.handlers.depsgraph_update_post.append(
    lambda scene, graph: seen.extend(update.id.original.name for update in graph.updates)
)
bpy.context.view_layer.update()


def reported(change):
    seen.clear()
    change()
    bpy.context.view_layer.update()
    return "image" in seen


def write():
    image.pixels.foreach_set(np.full(64, 0.5, np.float32))
    image.update()


after_writing, after_tag = reported(write), reported(image.update_tag)
print("pixels and update():", after_writing, " update_tag():", after_tag)
assert not after_writing
assert after_tag
PY
venv/bin/python look.py 2>/dev/null
echo "as described"
