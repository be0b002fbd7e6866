"""Refocused pictures as files: EXR and PNG, whole or not at all."""

from contextlib import contextmanager

import bpy
import numpy as np

from ...errors import UnfinishedFileError
from ...files.version import version
from ...files.whole_file import reason_of, whole_file
from ...files.whole_picture import is_whole_picture


def save_picture(path, picture, stack, scene):
    """Write a picture in the format that its file's ending asks for.

    Parameters
    ----------
    path : Path
        Ends in .exr (float, scene linear) or .png (as displayed).
    picture : ndarray of shape (height, width, 4)
        Premultiplied, scene linear, bottom row first.
    stack : LayerStack
        That it was made of.
    scene : bpy.types.Scene
        Whose view transform a PNG gets.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    if path.suffix.lower() == ".png":
        save_png(path, picture, scene)
    else:
        save_exr(path, picture, stack)


def save_exr(path, picture, stack):
    """Write a picture as EXR: float RGBA, scene linear; whole or not at all.

    Parameters
    ----------
    path : Path
    picture : ndarray of shape (height, width, 4)
        Premultiplied, bottom row first.
    stack : LayerStack
        That it was made of.
    """
    import OpenEXR

    header = {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "pixelAspectRatio": 1.0 / stack.pixel_aspect,
        "Software": f"Aplanat {version()}",
    }
    pixels = np.ascontiguousarray(picture[::-1], np.float32)
    with whole_file(path) as place:
        try:
            OpenEXR.File(header, {"RGBA": pixels}).write(place)
        except RuntimeError as error:
            raise UnfinishedFileError(
                f"cannot write '{path}': {reason_of(error)}; is the disk full?"
            ) from error


def save_png(path, picture, scene):
    """Write a picture as PNG, as a scene displays it; whole or not at all.

    Parameters
    ----------
    path : Path
    picture : ndarray of shape (height, width, 4)
        Premultiplied, scene linear, bottom row first.
    scene : bpy.types.Scene
        Whose view transform is applied; it stays as it is.
    """
    height, width = picture.shape[:2]
    transparent = bool((picture[..., 3] < 0.999).any())
    image = bpy.data.images.new("refocused", width, height, alpha=True, float_buffer=True)
    try:
        image.alpha_mode = "PREMUL"
        image.pixels.foreach_set(np.ascontiguousarray(picture, np.float32).ravel())
        with whole_file(path) as place, _as_png(scene, transparent) as displayed:
            try:
                image.save_render(str(place), scene=displayed)
            except RuntimeError as error:
                raise UnfinishedFileError(f"cannot write '{path}': {error}".strip()) from error
            if not is_whole_picture(place):
                raise UnfinishedFileError(
                    f"cannot write '{path}' to its end; is the disk full? Nothing of it is left"
                )
    finally:
        bpy.data.images.remove(image)


@contextmanager
def _as_png(scene, transparent):
    """Give a copy of a scene whose output is a PNG, 8 bits a channel, for a `with` block."""
    # Settings of the view, curves included, come along.
    copy = scene.copy()
    try:
        settings = copy.render.image_settings
        settings.media_type = "IMAGE"
        settings.file_format = "PNG"
        settings.color_depth = "8"
        settings.color_mode = "RGBA" if transparent else "RGB"
        settings.color_management = "FOLLOW_SCENE"
        settings.views_format = "INDIVIDUAL"
        yield copy
    finally:
        bpy.data.scenes.remove(copy)
