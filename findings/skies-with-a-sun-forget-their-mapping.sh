#!/usr/bin/env bash
# Sky Texture: switching the sun's disc on undoes a mapping that turned the sky.
#
# A sky that is turned by Texture Coordinate and Mapping would be expected to stay so when *Sun Disc* is
# switched on, with the disc where the sky is brightest; or to be refused.
# Seen (bpy 5.2.3): the sky jumps back to where it was without a mapping, in Cycles, without a word. The
# link stays in the tree, but is no longer valid: with the disc the node's only input is unavailable, and
# `inputs["Vector"]` is a KeyError while `inputs[0]` is that socket. New nodes have the disc, so that this
# is what a script meets first. With it only `sun_rotation` turns the sky.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"${PYTHON:-python3.13}" -m venv venv
venv/bin/pip install -q bpy==5.2.3 numpy==2.5.5 OpenEXR==3.5.3
cat >look.py <<'PY'
import math
import os

import bpy
import numpy as np
import OpenEXR


def picture(kind, disc, turn, by_rotation=0.0):
    """Return the brightness of a wide picture over the horizon."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 4, False
    scene.render.resolution_x, scene.render.resolution_y = 48, 24
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    scene.render.filepath = os.path.abspath("picture.exr")
    data = bpy.data.cameras.new("camera")
    scene.camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(scene.camera)
    data.lens, scene.camera.rotation_euler = 12.0, (math.radians(110.0), 0.0, 0.0)
    scene.world = bpy.data.worlds.new("world")
    tree = scene.world.node_tree
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    sky, places, mapping = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("TexSky", "TexCoord", "Mapping")
    )
    assert sky.sun_disc
    # Too weak to be seen: the sky alone is compared.
    sky.sky_type, sky.sun_elevation, sky.sun_intensity = kind, 0.5, 0.001
    sky.sun_disc, sky.sun_rotation = False, by_rotation
    mapping.inputs["Rotation"].default_value[2] = turn
    tree.links.new(places.outputs["Generated"], mapping.inputs["Vector"])
    link = tree.links.new(mapping.outputs["Vector"], sky.inputs["Vector"])
    tree.links.new(sky.outputs["Color"], background.inputs["Color"])
    sky.sun_disc = disc
    socket = sky.inputs[0]
    assert socket.identifier == "Vector" and socket.is_linked and len(sky.inputs) == 1
    assert ("Vector" in sky.inputs, socket.is_unavailable, link.is_valid) == (not disc, disc, not disc)
    bpy.ops.render.render(write_still=True)
    with OpenEXR.File("picture.exr") as file:
        return file.channels()["RGB"].pixels.mean(-1)


for kind in ("MULTIPLE_SCATTERING", "SINGLE_SCATTERING"):
    for disc in (False, True):
        plain, turned = picture(kind, disc, 0.0), picture(kind, disc, math.pi)
        rotated = picture(kind, disc, 0.0, by_rotation=math.pi)
        by_mapping, by_sun = (np.abs(other - plain).mean() / plain.mean() for other in (turned, rotated))
        print(f"seen: {kind}, disc {disc}: changed {by_mapping:.2f} by mapping, {by_sun:.2f} by the sun")
        assert by_sun > 0.2 and (by_mapping == 0.0 if disc else by_mapping > 0.2)
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
