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
        write_floats(scene.render, path)
        bpy.ops.render.render(write_still=True, scene=scene.name)
        with OpenEXR.File(str(path)) as file:
            return np.array(file.channels()["RGBA"].pixels, np.float32)


def write_floats(render, path, color_mode="RGBA"):
    """Set the output of renders to an EXR picture of 32 bits a channel.

    Parameters
    ----------
    render : bpy.types.RenderSettings
    path : Path or str
    color_mode : {'RGB', 'RGBA'}
    """
    render.filepath, render.use_file_extension = str(path), False
    settings = render.image_settings
    settings.media_type, settings.file_format = "IMAGE", "OPEN_EXR"
    settings.color_mode, settings.color_depth = color_mode, "32"


def use_cycles(scene, samples):
    """Render with Cycles on the CPU as a referee: direct light only, nothing smoothed or clamped.

    Parameters
    ----------
    scene : bpy.types.Scene
    samples : int
    """
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.max_bounces = 0
