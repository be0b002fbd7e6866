"""`aplanat refocus`: files of depth layers to pictures."""

import re
import time
from pathlib import Path

import bpy
import numpy as np

from ...device.context import device_name, ensure_context
from ...engine.refocus.refocusing import refocus
from ...engine.refocus.settings import RefocusSettings, lens_of
from ...errors import InputError, StrictError, UnfinishedFileError
from ...files.frame_path import frame_path
from ...files.version import version
from ...files.whole_file import check_writable, removed_on_signals, whole_file
from ...layers.flat_input import FlatOptions, load_flat
from ...layers.layer_file import is_layer_file, load_layers
from ...sampling.iris import Iris
from ..render.pictures import set_png
from ..render.statistics import peak_memory
from ..words.frame_values import telling_frame
from ..words.json_file import write_json
from ..words.parser import make_folders


def refocus_files(arguments, console):
    """Carry out `aplanat refocus`.

    Parameters
    ----------
    arguments : argparse.Namespace
    console : Console

    Returns
    -------
    dict
        What `--json` prints.

    Raises
    ------
    AplanatError
        If a picture is not made.
    """
    start = time.perf_counter()
    files = captured_files(arguments.layers, arguments.frames)
    if len(files) > 1 and "#" not in arguments.output.name:
        raise InputError(
            f"-o {arguments.output}: {len(files)} frames need #### in the file's name for the frame"
            " number"
        )
    with removed_on_signals():
        make_folders(arguments, [arguments.output])
        for path in filter(None, (frame_path(arguments.output, min(files)), arguments.stats)):
            check_writable(path)
        ensure_context()
        frames, warnings = [], []
        for frame, file in sorted(files.items()):
            with telling_frame(frame, len(files)):
                frames.append(_refocus_frame(frame, file, arguments, console, warnings))
        summary = {
            "command": "refocus",
            "files": [told["file"] for told in frames],
            "warnings": warnings,
            "aplanat": version(),
            "blender": bpy.app.version_string,
            "device": device_name(),
            "peak_memory_bytes": peak_memory(),
            "frames": frames,
            "seconds": round(time.perf_counter() - start, 6),
        }
        if arguments.stats:
            write_json(arguments.stats, summary)
    return summary


def captured_files(path, frames):
    """Find the captured files that a name stands for.

    Parameters
    ----------
    path : Path
        Its last run of # stands for a frame number.
    frames : Frames or None
        None: all that there are.

    Returns
    -------
    dict of int to Path
        By frame; a file without a number is frame 0.

    Raises
    ------
    InputError
        If there are none, or one is missing.
    """
    if "#" not in path.name:
        if not path.is_file():
            raise InputError(f"captured file '{path}' does not exist")
        return {0: path}
    if frames is not None:
        found = {frame: frame_path(path, frame) for frame in frames.numbers()}
        missing = [frame for frame, file in found.items() if not file.is_file()]
        if missing:
            raise InputError(
                f"captured file '{found[missing[0]]}' does not exist"
                + (f" ({len(missing)} of {len(found)} frames are missing)" * (len(missing) > 1))
            )
        return found
    first, last = list(re.finditer("#+", path.name))[-1].span()
    pattern = re.compile(
        re.escape(path.name[:first]) + r"(-?\d+)" + re.escape(path.name[last:]), re.IGNORECASE
    )
    names = sorted(path.parent.iterdir()) if path.parent.is_dir() else []
    matches = [(pattern.fullmatch(file.name), file) for file in names]
    found = {int(match[1]): file for match, file in matches if match and file.is_file()}
    if not found:
        raise InputError(f"no captured file is called '{path}', whatever its number")
    return found


def _refocus_frame(frame, file, arguments, console, warnings):
    begun = time.perf_counter()
    stack = load_layers(file) if is_layer_file(file) else load_flat(file, _flat(arguments))
    new = [line for line in stack.report if line not in warnings]
    if new and arguments.strict:
        raise StrictError(new)
    for line in new:
        console.say(f"warning: {line}")
    warnings.extend(new)
    settings = _settings(stack, arguments)
    lens_of(stack, settings)

    def go_on(share):
        console.progress(f"frame {frame}: {share:.0%} of {settings.samples} lens samples")
        return True

    picture = refocus(stack, settings, go_on)
    output = frame_path(arguments.output, frame)
    if output.suffix.lower() == ".png":
        save_png(output, picture)
    else:
        save_exr(output, picture, stack)
    seconds = round(time.perf_counter() - begun, 6)
    console.say(f"frame {frame}: {output} ({seconds:.1f} s)")
    lens = lens_of(stack, settings)
    return {
        "frame": frame,
        "layers_file": str(file),
        "file": str(output),
        "layers": len(stack.layers),
        "lens_samples": settings.samples,
        "focus_distance_m": lens.focus_distance,
        "fstop": stack.camera.f_stop if settings.f_stop is None else settings.f_stop,
        "seconds": seconds,
    }


def _flat(arguments):
    return FlatOptions(
        depth_channel=arguments.depth_channel,
        color_layer=arguments.color_layer,
        ray=arguments.ray_depth,
        depth_range=arguments.depth_range,
        inverted=arguments.inverted_depth,
        depth_scale=arguments.depth_scale,
        focal_length_mm=arguments.focal_length,
        sensor_width_mm=arguments.sensor_width,
    )


def _settings(stack, arguments):
    iris = None
    if arguments.blades is not None:
        camera = stack.camera
        iris = Iris(arguments.blades, camera.blade_rotation, camera.aperture_ratio)
    return RefocusSettings(
        focus_distance=arguments.focus,
        f_stop=arguments.fstop,
        iris=iris,
        samples=arguments.samples,
        seed=arguments.seed,
    )


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
                f"cannot write '{path}': {' '.join(str(error).split())}; is the disk full?"
            ) from error


def save_png(path, picture):
    """Write a picture as PNG, with the view transform of Blender's own default scene.

    Parameters
    ----------
    path : Path
    picture : ndarray of shape (height, width, 4)
        Premultiplied, scene linear, bottom row first.
    """
    height, width = picture.shape[:2]
    scene = bpy.context.scene
    scene.render.film_transparent = bool((picture[..., 3] < 0.999).any())
    set_png(scene, "INDIVIDUAL")
    image = bpy.data.images.new("refocused", width, height, alpha=True, float_buffer=True)
    try:
        image.alpha_mode = "PREMUL"
        image.pixels.foreach_set(np.ascontiguousarray(picture, np.float32).ravel())
        with whole_file(path) as place:
            image.save_render(str(place), scene=scene)
            if not Path(place).stat().st_size:
                raise UnfinishedFileError(f"cannot write '{path}'; is the disk full?")
    finally:
        bpy.data.images.remove(image)
