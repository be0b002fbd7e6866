"""Blender's output settings for the picture files of a render.

All picture files are Blender's own: multilayer EXR with every pass, float, or PNG as displayed. So
they hold what Blender holds (its compositor, stereoscopic views, borders, grease pencil), laid out
as programs expect of Blender.
"""

import bpy

from ...errors import UnfinishedFileError
from ...files.whole_picture import is_whole_picture

RENDER_RESULT = "Render Result"


def set_exr(scene, views_format):
    """Set the output to multilayer EXR: float, scene linear, all passes, a part each.

    Parameters
    ----------
    scene : bpy.types.Scene
    views_format : {'INDIVIDUAL', 'STEREO_3D', 'MULTIVIEW'}
        As the scene has it, of Blender's image settings.
    """
    settings = scene.render.image_settings
    settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_mode = "RGBA"
    settings.color_depth = "32"
    settings.exr_codec = "ZIP"
    settings.use_exr_interleave = False
    settings.use_preview = False
    settings.color_management = "FOLLOW_SCENE"
    # Blender writes no multilayer file that shows both eyes in one picture: both go into one file.
    settings.views_format = "INDIVIDUAL" if views_format == "INDIVIDUAL" else "MULTIVIEW"
    _leave_out_times(scene)


def set_png(scene, views_format):
    """Set the output to PNG: as displayed, 8 bits a channel, alpha if the film is transparent.

    Parameters
    ----------
    scene : bpy.types.Scene
    views_format : str
        As `set_exr` takes it.
    """
    settings = scene.render.image_settings
    settings.media_type = "IMAGE"
    settings.file_format = "PNG"
    settings.color_depth = "8"
    settings.color_mode = "RGBA" if scene.render.film_transparent else "RGB"
    settings.color_management = "FOLLOW_SCENE"
    # A PNG holds one picture: one of each view, or both eyes side by side or in colours.
    settings.views_format = "STEREO_3D" if views_format == "STEREO_3D" else "INDIVIDUAL"
    _leave_out_times(scene)


def _leave_out_times(scene):
    """Leave dates and times out of files, so that the same picture makes the same file."""
    render = scene.render
    # Unless they are to be seen in the picture.
    if not render.use_stamp:
        render.use_stamp_date = render.use_stamp_render_time = render.use_stamp_memory = False


def save_render_result(path, scene):
    """Write the render result once more, in the format of the scene's output settings.

    Parameters
    ----------
    path : Path
    scene : bpy.types.Scene

    Raises
    ------
    UnfinishedFileError
        If Blender does not write it.
    """
    try:
        bpy.data.images[RENDER_RESULT].save_render(str(path), scene=scene)
    except RuntimeError as error:
        raise UnfinishedFileError(f"cannot write '{path}': {error}") from error
    if not is_whole_picture(path):
        raise UnfinishedFileError(
            f"cannot write '{path}': Blender wrote no whole file; is the disk full?"
        )


def uses_compositor(scene):
    """Whether Blender puts the render result through the scene's compositing nodes."""
    return scene.render.use_compositing and scene.compositing_node_group is not None
