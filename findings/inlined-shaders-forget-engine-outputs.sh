#!/usr/bin/env bash
# Blender: the inlined form of a material is empty where its outputs are meant for single engines.
#
# `Material.inline_shader_nodes()` gives a render engine the material's tree without groups, reroutes
# and muted nodes. One would expect it to hold the output that each engine would render: materials
# made for two engines have one Material Output for Cycles and one for EEVEE, and none for all.
# Seen (bpy 5.2.3): only an output whose target is All is followed. With outputs for Cycles and EEVEE,
# or for one of them, the inlined tree has no node at all, without an error, though both engines draw
# the material. An engine of one's own has to look at the material's own tree then.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3
cat >look.py <<'PY'
import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
for targets, nodes in (
    (("ALL",), 2),
    (("CYCLES",), 0),
    (("EEVEE",), 0),
    (("CYCLES", "EEVEE"), 0),
    (("CYCLES", "ALL"), 2),
):
    material = bpy.data.materials.new("glow")
    tree = material.node_tree
    tree.nodes.clear()
    emission = tree.nodes.new("ShaderNodeEmission")
    for target in targets:
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        output.target = target
        tree.links.new(emission.outputs[0], output.inputs["Surface"])
    inlined = material.inline_shader_nodes()
    found = [node.bl_idname for node in inlined.node_tree.nodes]
    print(f"seen: outputs for {targets}: {found}")
    assert len(found) == nodes
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
