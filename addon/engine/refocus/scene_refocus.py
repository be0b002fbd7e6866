"""What a scene says of its refocused picture: file, camera, focus, f-number."""

import re
from dataclasses import replace
from pathlib import Path

import bpy

from ...errors import CameraError, InputError
from ...files.frame_path import frame_path
from ...layers.flat_input import FlatOptions
from ...lens_bokeh.openings.shapes import iris_of
from ...scene.camera.camera import evaluated_camera
from ...scene.camera.lens_record import recorded_opening
from .camera_settings import camera_settings
from .settings import RefocusSettings


def refocus_camera(scene):
    """Return the camera whose lens a scene's captured picture is seen through.

    Parameters
    ----------
    scene : bpy.types.Scene

    Returns
    -------
    bpy.types.Object or None
        The one that is set, else the scene's.
    """
    chosen = scene.aplanat.refocus.camera
    return chosen if chosen is not None else scene.camera


def layers_path(scene, frame=None):
    """Return the captured file of a frame.

    Parameters
    ----------
    scene : bpy.types.Scene
    frame : int, optional
        Default: the present one.

    Returns
    -------
    Path

    Raises
    ------
    InputError
        If the scene names none.
    """
    text = scene.aplanat.refocus.path
    if not text:
        raise InputError("no depth layers are open; open a captured file")
    if text.startswith("//") and not bpy.data.filepath:
        raise InputError(f"'{text}' lies beside the .blend file, which is not saved yet")
    return frame_path(Path(bpy.path.abspath(text)), scene.frame_current if frame is None else frame)


def as_sequence(path):
    """Return the name of the sequence that a file is part of, if there are other files of it.

    Parameters
    ----------
    path : Path

    Returns
    -------
    Path
        With # for each digit of the frame number; the same path if it is alone.
    """
    runs = list(re.finditer(r"\d+", path.stem))
    if not runs or not path.parent.is_dir():
        return path
    first, last = runs[-1].span()
    # A number may be longer than others of its sequence, never shorter.
    pattern = re.compile(
        rf"{re.escape(path.stem[:first])}\d{{{last - first},}}{re.escape(path.stem[last:])}"
    )
    others = (
        other
        for other in path.parent.iterdir()
        if other != path and other.suffix == path.suffix and pattern.fullmatch(other.stem)
    )
    if next(others, None) is None:
        return path
    hashes = "#" * (last - first)
    return path.with_name(path.stem[:first] + hashes + path.stem[last:] + path.suffix)


def flat_options(scene):
    """Return a scene's options for a picture with a depth pass.

    Parameters
    ----------
    scene : bpy.types.Scene

    Returns
    -------
    FlatOptions
        With focal length and sensor of the camera, if its lens is used.
    """
    own = scene.aplanat.refocus
    numbers = {}
    if own.depth_values == "SCALED":
        numbers["depth_scale"] = own.depth_scale
    elif own.depth_values == "NORMALISED":
        numbers["depth_range"] = (own.depth_near, max(own.depth_far, own.depth_near * 1.000001))
    camera = refocus_camera(scene)
    if own.use_camera_lens and camera is not None and camera.data.type == "PERSP":
        numbers["focal_length_mm"] = camera.data.lens
        numbers["sensor_width_mm"] = camera.data.sensor_width
    return FlatOptions(
        depth_channel=own.depth_channel or None,
        color_layer=own.color_layer or None,
        ray=own.use_ray_depth or None,
        inverted=own.use_inverted_depth or None,
        **numbers,
    )


def read_refocus(scene, depsgraph, stack, sources):
    """Read how a captured picture is seen.

    Parameters
    ----------
    scene : bpy.types.Scene
    depsgraph : bpy.types.Depsgraph
        Of the frame.
    stack : LayerStack
    sources : CameraSources
        Of the session.

    Returns
    -------
    settings : RefocusSettings
    problems : tuple of str
        Warnings about settings that cannot be met, one line each.
    """
    own = scene.aplanat.refocus
    settings, problems = RefocusSettings(), ()
    chosen = refocus_camera(scene)
    asks = own.use_camera_lens or "CAMERA" in (own.focus_from, own.fstop_from)
    if asks and chosen is None:
        problems = ("there is no camera: lens and iris are those of the capture",)
    elif asks:
        try:
            camera = evaluated_camera(depsgraph, chosen)
            settings, problems = camera_settings(stack, depsgraph, camera, sources)
        except CameraError as error:
            problems = (str(error),)
    if not own.use_camera_lens:
        settings = RefocusSettings(settings.focus_distance, settings.f_stop, _iris(stack.camera))
    if own.focus_from == "OWN":
        settings = replace(settings, focus_distance=own.focus_distance)
    if own.fstop_from == "OWN":
        settings = replace(settings, f_stop=own.fstop)
    return replace(settings, samples=own.samples), (*_foreign_colors(stack), *problems)


def _iris(captured):
    opening = recorded_opening(captured.lens_settings, captured.blades, captured.blade_rotation)
    found = iris_of(opening, captured.blade_rotation, captured.aperture_ratio)
    # Round, or of straight blades: that is what `lens_of` takes.
    return found if found.opening is not None else None


def _foreign_colors(stack):
    """Return a warning if a capture's colours are not those that Blender works in."""
    space = bpy.data.colorspace.working_space
    if stack.color_space in ("", space):
        return ()
    return (
        f"the capture's colours are in {stack.color_space}, and Blender works in {space}: they are"
        " taken as they stand; set Blender's working space to that of the capture",
    )
