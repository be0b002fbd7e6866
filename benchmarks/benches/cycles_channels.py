"""Cycles as a referee of axial colour: a picture composed of renders with a focus of their own."""

import hashlib
import tempfile
from pathlib import Path

import bpy
import numpy as np

from ..referees.picture_metrics import read_picture
from ..referees.shared_scenes import BUILT_FOLDER
from .scenes import save_picture


def channels_of_cycles(scene, name, focus_distances, samples, folder=BUILT_FOLDER):
    """Render a scene's red, green and blue with Cycles, each with a focus distance of its own.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its camera has depth of field; it is left with Cycles as its engine.
    name : str
        Of the scene, for the file that keeps the picture.
    focus_distances : sequence of 3 float
        In m.
    samples : int
        A pixel.
    folder : Path
        Where pictures are kept: each is rendered once.

    Returns
    -------
    ndarray of shape (height, width, 3)
        Scene linear, top row first.
    """
    width, height = scene.render.resolution_x, scene.render.resolution_y
    dof = scene.camera.data.dof
    told = (name, focus_distances, samples, width, height, dof.aperture_fstop)
    key = hashlib.sha256(repr(told).encode()).hexdigest()[:12]
    kept = folder / f"cycles_{name}_{key}.exr"
    if kept.is_file():
        return read_picture(kept)
    _use_cycles(scene, samples)
    dof.focus_object = None
    channels = {}
    for channel, distance in enumerate(focus_distances):
        dof.focus_distance = distance
        channels[channel] = _render(scene)[..., channel]
    picture = np.stack([channels[channel] for channel in range(3)], axis=-1)
    folder.mkdir(parents=True, exist_ok=True)
    save_picture(kept, picture)
    return picture


def _use_cycles(scene, samples):
    scene.render.engine = "CYCLES"
    scene.render.film_transparent = False
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.max_bounces = 0
    cycles.transparent_max_bounces = 8


def _render(scene):
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "picture.exr"
        scene.render.filepath = str(path)
        scene.render.use_file_extension = False
        settings = scene.render.image_settings
        settings.media_type = "IMAGE"
        settings.file_format, settings.color_mode = "OPEN_EXR", "RGBA"
        settings.color_depth = "32"
        bpy.ops.render.render(write_still=True, scene=scene.name)
        return _rgb(path)


def _rgb(path):
    import OpenEXR

    with OpenEXR.File(str(path)) as file:
        return np.array(file.channels()["RGBA"].pixels[..., :3], np.float64)
