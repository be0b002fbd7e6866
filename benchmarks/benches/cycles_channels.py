"""Cycles as a referee of axial colour: a picture composed of renders with a focus of their own."""

import hashlib

import numpy as np

from ..referees.picture_metrics import read_picture
from ..referees.shared_scenes import BUILT_FOLDER
from ..scenes.pictures import render_picture, use_cycles
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
    use_cycles(scene, samples)
    scene.render.film_transparent, scene.cycles.transparent_max_bounces = False, 8
    dof.focus_object = None
    channels = {}
    for channel, distance in enumerate(focus_distances):
        dof.focus_distance = distance
        channels[channel] = render_picture(scene)[..., :3].astype(np.float64)[..., channel]
    picture = np.stack([channels[channel] for channel in range(3)], axis=-1)
    folder.mkdir(parents=True, exist_ok=True)
    save_picture(kept, picture)
    return picture
