#!/usr/bin/env bash
# Blender: the angle of the compositor's bokeh turns the other way than the camera's blades.
#
# A depth of field made in the compositor gets the blades and the rotation of the camera, so that it
# looks like the render. One would expect the same numbers to make the same polygon.
# Seen (bpy 5.2.3): of three blades without rotation, Cycles has a corner on the right for what is in
# front of the focus and on the left for what is behind it; Bokeh Image and Defocus have one at the top,
# for both. A rotation of 20 degrees turns Cycles' discs to the left, the compositor's to the right. So
# the compositor needs 90 degrees less the camera's rotation for what is in front, 270 for what is behind.
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

SIZE = 48


def scene_of(samples):
    """Return an empty scene with a camera that has three blades and is small and square."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_adaptive_sampling = samples, False
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    scene.render.filepath = os.path.abspath("picture.exr")
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(scene.camera)
    return scene


def corner(scene):
    """Render, and return where a corner of the triangle points: degrees to the left from the right, of 120."""
    bpy.ops.render.render(write_still=True)
    with OpenEXR.File("picture.exr") as file:
        light = file.channels()["RGB"].pixels.mean(-1).astype(float)[::-1]
    y, x = np.mgrid[:SIZE, :SIZE]
    place = x + 1j * y
    place = place - (light * place).sum() / light.sum()
    # The third harmonic of the outline: corners weigh more than the sides between them.
    return math.degrees(np.angle((light * place**3).sum())) / 3.0 % 120.0


def rendered(rotation, focus, distance):
    """Return the corner of a lamp's disc in Cycles."""
    scene = scene_of(128)
    dof = scene.camera.data.dof
    dof.use_dof, dof.focus_distance, dof.aperture_fstop = True, focus, 0.02
    dof.aperture_blades, dof.aperture_rotation = 3, math.radians(rotation)
    bpy.ops.mesh.primitive_plane_add(size=0.3, location=(0.0, 0.0, -distance))
    material = bpy.data.materials.new("lamp")
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    shader.inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    shader.inputs["Emission Strength"].default_value = 100.0
    bpy.context.object.data.materials.append(material)
    return corner(scene)


def composed(kind, rotation):
    """Return the corner of Bokeh Image's own picture, or of what Defocus makes of a point."""
    scene = scene_of(1)
    tree = bpy.data.node_groups.new(kind, "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    node = tree.nodes.new(kind)
    end = tree.nodes.new("NodeGroupOutput")
    if kind == "CompositorNodeBokehImage":
        node.inputs["Flaps"].default_value = 3
        node.inputs["Angle"].default_value = math.radians(rotation)
        smaller = tree.nodes.new("CompositorNodeScale")
        smaller.inputs["X"].default_value = smaller.inputs["Y"].default_value = 0.08
        tree.links.new(node.outputs[0], smaller.inputs[0])
        tree.links.new(smaller.outputs[0], end.inputs[0])
    else:
        node.bokeh, node.angle = "TRIANGLE", math.radians(rotation)
        node.use_zbuffer, node.blur_max, node.f_stop = False, 16, 128
        for socket, value in ((0, 0.0), (1, 10.0)):
            pixels = np.full((SIZE, SIZE, 4), value, np.float32)
            if socket == 0:
                pixels[SIZE // 2, SIZE // 2, :3], pixels[..., 3] = 100.0, 1.0
            image = bpy.data.images.new("pixels", SIZE, SIZE, float_buffer=True, is_data=True)
            image.pixels.foreach_set(pixels.ravel())
            image.pack()
            source = tree.nodes.new("CompositorNodeImage")
            source.image = image
            tree.links.new(source.outputs[0], node.inputs[socket])
        tree.links.new(node.outputs[0], end.inputs[0])
    scene.compositing_node_group = tree
    return corner(scene)


def near(found, wanted):
    """Return whether two corners of a triangle are the same within 3 degrees."""
    return abs((found - wanted + 60.0) % 120.0 - 60.0) < 3.0


for rotation in (0, 20):
    front, behind = rendered(rotation, 6.0, 3.0), rendered(rotation, 4.0, 8.0)
    image = composed("CompositorNodeBokehImage", rotation)
    defocus = composed("CompositorNodeDefocus", rotation)
    print(
        f"seen: rotation {rotation}: Cycles in front {front:.0f}, behind {behind:.0f},"
        f" Bokeh Image {image:.0f}, Defocus {defocus:.0f}"
    )
    assert near(front, 0 + rotation) and near(behind, 180 + rotation)
    assert near(image, 90 - rotation) and near(defocus, 90 - rotation)
PY
venv/bin/python look.py 2>/dev/null | grep "^seen"
echo "as described"
