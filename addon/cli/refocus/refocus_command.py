"""`aplanat refocus`: files of depth layers to pictures."""

import time

import bpy

from ...device.context import device_name, ensure_context
from ...engine.refocus.pictures import save_picture
from ...engine.refocus.refocusing import Refocusing
from ...engine.refocus.settings import f_stop_of, lens_of
from ...engine.shared_resources import resources
from ...errors import InputError
from ...files.frame_path import frame_path
from ...files.version import version
from ...files.whole_file import check_writable, removed_on_signals
from ...layers.captured_files import captured_files, check_apart, load_captured
from ...layers.flat_input import FlatOptions
from ...layers.layer_file import is_layer_file
from ..render.render_command import Warnings
from ..render.statistics import peak_memory
from ..words.frame_values import telling_frame
from ..words.json_file import write_json
from ..words.parser import make_folders
from .lens_source import LensSource

# Lens samples between two looks at whether there is something to tell.
_STRETCH = 4


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
    with removed_on_signals(), resources().open_session() as session:
        make_folders(arguments, [arguments.output])
        outputs = [frame_path(arguments.output, frame) for frame in sorted(files)]
        check_apart(files.values(), [*outputs, *filter(None, [arguments.stats])])
        for path in filter(None, (outputs[0], arguments.stats)):
            check_writable(path)
        lens = LensSource(arguments, session.sources)
        ensure_context()
        frames, warnings = [], Warnings(console, arguments.strict)
        for frame, file in sorted(files.items()):
            with telling_frame(frame, len(files)):
                frames.append(
                    _refocus_frame(frame, file, arguments, console, warnings, lens, session)
                )
        summary = {
            "command": "refocus",
            "files": [told["file"] for told in frames],
            "warnings": warnings.lines,
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


def _refocus_frame(frame, file, arguments, console, warnings, lens, session):
    begun = time.perf_counter()
    stack = load_captured(file, _flat(arguments))
    if "#" not in arguments.layers.name:
        frame = stack.frame
    # What is refused is one line, without the warnings.
    settings, problems = lens.settings(stack, frame)
    if is_layer_file(file):
        # What the capture could not know was told by it, and cannot be mended here.
        for line in stack.report:
            console.say(f"note: {line}")
        warnings.add(problems)
    else:
        warnings.add([*stack.report, *problems])
    seen = lens_of(stack, settings)
    refocusing = Refocusing(stack, settings, session.look_textures)
    try:
        if settings.bokeh is not None:
            # The first sample waits for them; large discs take a while.
            console.progress(f"frame {frame}: finding highlights and drawing their discs")
        while refocusing.advance(_STRETCH):
            share = refocusing.samples_done / settings.samples
            console.progress(f"frame {frame}: {share:.0%} of {settings.samples} lens samples")
        warnings.add(refocusing.report)
        picture, highlights = refocusing.read(), refocusing.highlights
    finally:
        refocusing.release()
    output = frame_path(arguments.output, frame)
    save_picture(output, picture, stack, bpy.context.scene)
    seconds = round(time.perf_counter() - begun, 6)
    console.say(f"frame {frame}: {output} ({seconds:.1f} s)")
    return {
        "frame": frame,
        "layers_file": str(file),
        "file": str(output),
        "layers": len(stack.layers),
        "lens_samples": settings.samples,
        "focus_distance_m": seen.focus_distance,
        "fstop": f_stop_of(stack, settings),
        "lens": settings.real_lens and settings.real_lens.id,
        "bokeh": settings.bokeh is not None,
        "chromatic": settings.chromatic is not None,
        "highlights": highlights.found if highlights else 0,
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
        f_stop=arguments.fstop,
        focus_distance=arguments.focus,
    )
