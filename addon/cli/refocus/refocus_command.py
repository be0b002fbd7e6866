"""`aplanat refocus`: files of depth layers to pictures."""

import time

import bpy

from ...device.context import device_name, ensure_context
from ...engine.refocus.pictures import save_picture
from ...engine.refocus.refocusing import refocus
from ...engine.refocus.settings import RefocusSettings, lens_of
from ...errors import InputError, StrictError
from ...files.frame_path import frame_path
from ...files.version import version
from ...files.whole_file import check_writable, removed_on_signals
from ...layers.captured_files import captured_files, load_captured
from ...layers.flat_input import FlatOptions
from ...sampling.iris import Iris
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
    files = captured_files(arguments.layers, arguments.frames and arguments.frames.numbers())
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


def _refocus_frame(frame, file, arguments, console, warnings):
    begun = time.perf_counter()
    stack = load_captured(file, _flat(arguments))
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
    save_picture(output, picture, stack, bpy.context.scene)
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
