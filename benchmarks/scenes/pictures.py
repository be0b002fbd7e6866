"""Pictures of scenes in this process' Blender."""

import tempfile
from pathlib import Path

import numpy as np


def render_picture(scene):
    """Render a scene as its final render and return it: (height, width, 4), top row first."""
    import bpy
    import OpenEXR

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.exr"
        scene.render.filepath = str(path)
        scene.render.use_file_extension = False
        settings = scene.render.image_settings
        settings.media_type = "IMAGE"
        settings.file_format = "OPEN_EXR"
        settings.color_mode = "RGBA"
        settings.color_depth = "32"
        bpy.ops.render.render(write_still=True, scene=scene.name)
        with OpenEXR.File(str(path)) as file:
            return np.array(file.channels()["RGBA"].pixels, np.float32)
