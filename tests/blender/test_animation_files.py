"""`blender -b -a`, `-f` and the command line leave the same files, in the real Blender."""

import shutil
import subprocess

import imageio.v3 as iio
import numpy as np
import OpenEXR
import pytest

BUILD = """
import bpy
for thing in list(bpy.data.objects):
    bpy.data.objects.remove(thing)
scene = bpy.context.scene
scene.render.engine = "APLANAT"
scene.aplanat.method, scene.aplanat.render_samples = "REFERENCE", 2
scene.render.resolution_x, scene.render.resolution_y = 32, 24
scene.frame_start, scene.frame_end, scene.frame_step = 1, 5, 2
scene.render.filepath = "//frames/main_"
render = scene.render
render.use_multiview, render.views_format = True, "STEREO_3D"
bpy.ops.mesh.primitive_plane_add(size=2, location=(0, 0, -5))
material = bpy.data.materials.new("glow")
glow = material.node_tree.nodes.new("ShaderNodeEmission")
end = next(n for n in material.node_tree.nodes if n.type == "OUTPUT_MATERIAL")
material.node_tree.links.new(glow.outputs[0], end.inputs[0])
bpy.context.object.data.materials.append(material)
camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
scene.collection.objects.link(camera)
scene.camera = camera
tree = bpy.data.node_groups.new("C", "CompositorNodeTree")
tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
layers, end = (tree.nodes.new(k) for k in ("CompositorNodeRLayers", "NodeGroupOutput"))
tree.links.new(layers.outputs["Image"], end.inputs[0])
scene.compositing_node_group = tree
for folder, kind in (("//multilayer/", None), ("//png/", "PNG")):
    node = tree.nodes.new("CompositorNodeOutputFile")
    node.directory, node.file_name = folder, "node_"
    if kind:
        node.format.media_type, node.format.file_format = "IMAGE", kind
    node.file_output_items.new("RGBA", "Image")
    tree.links.new(layers.outputs["Image"], node.inputs[0])
scene.view_layers[0].use_pass_cryptomatte_object = True
bpy.context.object.name = "Square"
pick = tree.nodes.new("CompositorNodeCryptomatteV2")
pick.source, pick.scene, pick.layer_name = "RENDER", scene, "ViewLayer.CryptoObject"
pick.matte_id = "Square"
node = tree.nodes.new("CompositorNodeOutputFile")
node.directory, node.file_name = "//matte/", "node_"
node.file_output_items.new("FLOAT", "Matte")
tree.links.new(pick.outputs["Matte"], node.inputs[0])
"""


@pytest.fixture(scope="module")
def shot(blender, tmp_path_factory):
    path = tmp_path_factory.mktemp("shot") / "shot.blend"
    blender.run_code(BUILD + f"\nbpy.ops.wm.save_as_mainfile(filepath={str(path)!r})\n")
    return path


def files_in(folder):
    return {str(p.relative_to(folder)) for p in folder.rglob("*") if p.is_file()}


@pytest.mark.parametrize(
    ("of_blender", "of_ours"),
    [(["-a"], ["--frames", "1..5"]), (["-f", "3"], ["--frame", "3"])],
    ids=["-a", "-f"],
)
def test_the_command_leaves_the_files_that_blender_leaves(
    blender, shot, tmp_path, of_blender, of_ours
):
    theirs, ours = tmp_path / "theirs", tmp_path / "ours"
    for folder in (theirs, ours):
        folder.mkdir()
        shutil.copy(shot, folder)
    blender.run(theirs / "shot.blend", *of_blender)
    done = subprocess.run(
        [blender.path, "--command", "aplanat", "render", str(ours / "shot.blend"), *of_ours],
        env=blender.env,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert files_in(ours) == files_in(theirs)
    frames = ["0001", "0003", "0005"] if of_blender == ["-a"] else ["0003"]
    assert files_in(ours) - {"shot.blend"} == {
        *(f"frames/main_{frame}_{eye}.png" for frame in frames for eye in "LR"),
        *(f"multilayer/node_{frame}_{eye}.exr" for frame in frames for eye in "LR"),
        *(f"png/node_Image{frame}_{eye}.png" for frame in frames for eye in "LR"),
        *(f"matte/node_{frame}_{eye}.exr" for frame in frames for eye in "LR"),
    }
    for name in files_in(ours):
        if name.endswith(".png"):
            picture = iio.imread(ours / name)
            np.testing.assert_array_equal(picture, iio.imread(theirs / name))
            assert picture[..., :3].any()
    with OpenEXR.File(str(ours / f"matte/node_{frames[-1]}_L.exr"), separate_channels=True) as file:
        (matte,) = [channel.pixels for part in file.parts for channel in part.channels.values()]
    # The square of side 2 at 5 m covers the middle of the left eye's picture, not its corner.
    assert matte[12, 16] == 1.0 and matte[0, 0] == 0.0
