"""Draw docs/images/compositor/sprites.png: sprites of a camera, and what nodes make of them.

Above, the image of the sprite: a thin lens with seven blades; a traced lens in the middle of the
picture, halfway to its corner, and in it. Below, two points of light through Bokeh Blur and through
Convolve with the last of them.

    .venv/bin/python scripts/compositor_picture.py
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPOSITORY))

import bpy  # noqa: E402  (after the path is set)

import addon  # noqa: E402
from benchmarks.scenes.compositor_nodes import Nodes  # noqa: E402

SIZE, LARGE = 160, (320, 160)


def main():
    addon.register()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.resolution_x, scene.render.resolution_y = 3 * LARGE[0], 3 * LARGE[1]
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    sprites, group = drawn(camera)
    scene.render.resolution_x, scene.render.resolution_y = LARGE
    blurred = [through(scene, group, node) for node in ("CompositorNodeBokehBlur", "Convolve")]
    rows = np.concatenate([np.concatenate(blurred, 1), np.concatenate(sprites, 1)])[::-1]
    path = REPOSITORY / "docs" / "images" / "compositor" / "sprites.png"
    path.parent.mkdir(exist_ok=True)
    shown = np.clip(rows, 0.0, 1.0) ** (1.0 / 2.2) * 255.0
    Image.fromarray(shown.round().astype(np.uint8)).save(path, optimize=True)
    print(path)


def drawn(camera):
    from addon.compositor.sprite_image import camera_sprite, sprite_group, store_sprite

    data = camera.data
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 3.0, 2.0
    data.dof.aperture_blades = 7
    data.aplanat.bokeh.blade_curvature = 0.4
    pictures = [made(camera_sprite, camera, (0.0, 0.0))]
    data.aplanat.lens, data.aplanat.bokeh.vignetting = "double-gauss-50mm-f2", "LENS"
    data.dof.aperture_blades = 0
    for field in ((0.0, 0.0), (0.5, 0.5), (1.0, 1.0)):
        pictures.append(made(camera_sprite, camera, field))
    small = camera_sprite(bpy.context.evaluated_depsgraph_get(), camera, (1.0, 1.0), True, 97)
    # Rows are turned over as a whole in the end.
    return pictures, sprite_group(store_sprite("Bokeh of Camera", small))


def made(camera_sprite, camera, field):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return camera_sprite(depsgraph, camera, field, True, SIZE)


def through(scene, group, kind):
    nodes = Nodes(bpy, scene)
    points = np.zeros((LARGE[1], LARGE[0], 4), np.float32)
    points[..., 3] = 1.0
    points[80, (95, 225), :3] = 1600.0

    def build(tree):
        sprite = nodes.group(tree, group, {})
        if kind == "Convolve":
            node = tree.nodes.new("CompositorNodeConvolve")
            node.inputs["Kernel Data Type"].default_value = "Color"
            tree.links.new(sprite.outputs["Kernel"], node.inputs[3])
        else:
            node = tree.nodes.new(kind)
            node.inputs["Size"].default_value = 48
            tree.links.new(sprite.outputs["Bokeh"], node.inputs["Bokeh"])
        tree.links.new(nodes.image(tree, points), node.inputs["Image"])
        return node.outputs[0]

    return nodes.through(build)[..., 0]


if __name__ == "__main__":
    main()
