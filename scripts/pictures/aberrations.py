"""Draws docs/images/lens/aberrations.jpg: lamps through each aberration of an artist's lens.

.venv/bin/python scripts/pictures/aberrations.py
"""

import sys
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPO))

import bpy  # noqa: E402  (after the path is set)
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

import addon  # noqa: E402
from benchmarks.scenes.pictures import render_picture  # noqa: E402

CASES = (
    {},
    {"spherical": 0.7},
    {"coma": 1.5},
    {"astigmatism": 2.0},
    {"field_curvature": 2.0},
    {"swirl": 0.7},
)
SIZE = (270, 180)
# Lamps: where they stand in the picture, tangents, and their depths, m.
_COLUMNS = (-0.16, 0.0, 0.16)
_ROWS = ((0.095, 8.0), (0.03, 8.0), (-0.035, 0.85), (-0.1, 0.85))


def lamp(x, y, depth):
    """Put a small bright ball in front of the camera."""
    bpy.ops.mesh.primitive_ico_sphere_add(
        subdivisions=2, radius=0.002 * depth, location=(x * depth, y * depth, -depth)
    )
    material = bpy.data.materials.new("lamp")
    tree = material.node_tree
    tree.nodes.clear()
    glow = tree.nodes.new("ShaderNodeEmission")
    glow.inputs["Color"].default_value = (1.0, 0.8, 0.55, 1.0)
    glow.inputs["Strength"].default_value = 400.0
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(glow.outputs["Emission"], output.inputs["Surface"])
    bpy.context.object.data.materials.append(material)


def main():
    """Draw the picture."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon.register()
    scene = bpy.context.scene
    scene.render.engine = "APLANAT"
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    data = bpy.data.cameras.new("camera")
    scene.camera = bpy.data.objects.new("camera", data)
    scene.collection.objects.link(scene.camera)
    data.lens, data.dof.use_dof = 85.0, True
    data.dof.aperture_fstop, data.dof.focus_distance = 1.4, 1.2
    for x in _COLUMNS:
        for y, depth in _ROWS:
            lamp(x, y, depth)
    pictures = []
    for case in CASES:
        for name in ("spherical", "coma", "astigmatism", "field_curvature", "swirl"):
            setattr(data.aplanat, name, case.get(name, 0.0))
        light = np.clip(render_picture(scene)[..., :3] * 0.25, 0.0, 1.0)
        pictures.append(np.pad(light ** (1.0 / 2.2), ((2, 2), (2, 2), (0, 0)), constant_values=0.2))
    rows = [np.hstack(pictures[:3]), np.hstack(pictures[3:])]
    sheet = (np.vstack(rows) * 255.0).round().astype(np.uint8)
    Image.fromarray(sheet).save(REPO / "docs" / "images" / "lens" / "aberrations.jpg", quality=90)


if __name__ == "__main__":
    main()
