"""Picture files of a finished render: multilayer EXR and PNG.

The EXR is laid out as Blender's own: a part each pass, channels ``Layer.Pass.Letter``, float, so
that Blender and compositing programs read it as a multilayer picture. Rows go from top to bottom.
"""

import tempfile
from pathlib import Path

import bpy
import numpy as np

from ..errors import OutputError
from ..files.whole_file import whole_file
from .version import version

RENDER_RESULT = "Render Result"

# Passes whose values are colours of the scene; all others are data.
_COLOR_LETTERS = "RGBA"


def save_exr(path, layers, scene):
    """Write the layers of a render as a multilayer EXR.

    Parameters
    ----------
    path : Path
    layers : list of LayerPicture
    scene : bpy.types.Scene
        Where they were rendered; its composite is added if its compositor is in use.
    """
    import OpenEXR

    metadata = {}
    parts = []
    for layer in layers:
        metadata |= layer.metadata
    if uses_compositor(scene):
        parts.append(("Composite.Combined", _COLOR_LETTERS, composite_pixels(scene)))
    for layer in layers:
        for name, picture in layer.passes.items():
            pixels = on_canvas(picture.pixels, layer, scene.render.use_crop_to_border)
            parts.append((f"{layer.layer}.{name}", picture.channels, pixels[::-1]))
    file_parts = []
    for index, (name, letters, pixels) in enumerate(parts):
        header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
        is_color = letters == _COLOR_LETTERS
        header["colorInteropID"] = _working_space() if is_color else "data"
        if index == 0:
            header |= _file_metadata(scene) | metadata
        channels = {
            f"{name}.{letter}": np.ascontiguousarray(pixels[..., i], np.float32)
            for i, letter in enumerate(letters)
        }
        file_parts.append(OpenEXR.Part(header, channels, name))
    with whole_file(path) as place:
        try:
            OpenEXR.File(file_parts).write(place)
        except RuntimeError as error:
            raise OutputError(f"cannot write '{path}': {error}") from error


def save_png(path, scene):
    """Write the render result as displayed: view transform applied, 8 bits a channel."""
    settings = scene.render.image_settings
    settings.media_type = "IMAGE"
    settings.file_format = "PNG"
    settings.color_depth = "8"
    settings.color_mode = "RGBA" if scene.render.film_transparent else "RGB"
    settings.color_management = "FOLLOW_SCENE"
    save_as_set(path, scene)


def save_as_set(path, scene):
    """Write the render result in the format of the scene's output settings."""
    with whole_file(path) as place:
        try:
            bpy.data.images[RENDER_RESULT].save_render(place, scene=scene)
        except RuntimeError as error:
            raise OutputError(f"cannot write '{path}': {error}") from error
        if Path(place).stat().st_size == 0:
            raise OutputError(f"cannot write '{path}': Blender wrote nothing; is the disk full?")


def uses_compositor(scene):
    """Whether Blender puts the render result through the scene's compositing nodes."""
    return scene.render.use_compositing and scene.compositing_node_group is not None


def composite_pixels(scene):
    """Return the render result, scene linear, shape (height, width, 4), top row first."""
    import OpenEXR

    settings = scene.render.image_settings
    settings.media_type = "IMAGE"
    settings.file_format = "OPEN_EXR"
    settings.color_depth = "32"
    settings.color_mode = "RGBA"
    settings.color_management = "FOLLOW_SCENE"
    with tempfile.TemporaryDirectory(prefix="aplanat-") as folder:
        path = Path(folder) / "composite.exr"
        bpy.data.images[RENDER_RESULT].save_render(str(path), scene=scene)
        with OpenEXR.File(str(path)) as file:
            return np.array(file.channels()["RGBA"].pixels, np.float32)


def on_canvas(pixels, layer, cropped):
    """Place a pass in the whole picture, as Blender does unless the render is cropped.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, channels)
        Bottom row first.
    layer : LayerPicture
    cropped : bool

    Returns
    -------
    ndarray
        Zero outside the layer's region.
    """
    x, y, width, height = layer.region
    if cropped or (width, height) == tuple(layer.size):
        return pixels
    canvas = np.zeros((layer.size[1], layer.size[0], pixels.shape[2]), np.float32)
    canvas[y : y + height, x : x + width] = pixels
    return canvas


def _file_metadata(scene):
    return {
        # Tells Blender that the channels are its layers and passes.
        "BlenderMultiChannel": f"Blender V{bpy.app.version_string}",
        "Software": f"Aplanat {version()}, Blender {bpy.app.version_string}",
        "Scene": scene.name,
        "Camera": scene.camera.name,
        "Frame": f"{scene.frame_current:03d}",
    }


def _working_space():
    return bpy.data.colorspace.working_space_interop_id
