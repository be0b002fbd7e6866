"""`aplanat capture`: frames of a .blend file to files of depth layers."""

import time
from pathlib import Path

import bpy

from ...capture.capture_files import is_captured, source_digest, write_capture
from ...capture.frame_capture import FrameCapture, render_now
from ...capture.scene_limits import missing_images
from ...capture.settings import ENGINES, CaptureSettings
from ...capture.shot_capture import software
from ...device.context import ensure_context
from ...engine.shared_resources import listen
from ...errors import InputError, RenderCancelledError, StrictError
from ...files.frame_path import frame_path
from ...files.held_files import HeldFiles
from ...files.version import version
from ...files.whole_file import check_writable, removed_on_signals
from ...scene.unsupported import missing_files, missing_links
from ..render import statistics
from ..render.render_command import Warnings
from ..render.scene_setup import load_scene
from ..words.frame_values import first_file, frame_numbers, telling_frame
from ..words.json_file import write_json
from ..words.parser import make_folders


def capture(arguments, console):
    """Carry out `aplanat capture`.

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
        If a frame is not captured.
    """
    start = time.perf_counter()
    with removed_on_signals():
        make_folders(arguments, [arguments.output])
        check_writable(first_file(arguments.output, arguments))
        if arguments.stats:
            check_writable(arguments.stats)
        scene = load_scene(arguments.scene)
        settings = _settings(scene, arguments)
        if settings.engine == "APLANAT":
            ensure_context()
        warnings = Warnings(console, arguments.strict)
        warnings.add([*missing_links(), *missing_files(), *missing_images()])
        source = source_digest(arguments.scene)
        program = software()
        frames = []
        with HeldFiles() as held:
            numbers = frame_numbers(scene, arguments)
            for frame in numbers:
                with telling_frame(frame, len(numbers)):
                    path = frame_path(arguments.output, frame)
                    half = " half" if arguments.half else ""
                    digest = settings.digest(frame, source, program + half)
                    if is_captured(path, digest):
                        console.say(f"frame {frame}: {path} is there, whole and of these settings")
                        frames.append({"frame": frame, "file": str(path), "kept": True})
                        continue
                    begun = time.perf_counter()
                    stack, words, renders = _capture_frame(
                        scene, frame, settings, held.room("slices"), console, warnings
                    )
                    write_capture(path, stack, digest, program, words, arguments.half)
                    seconds = round(time.perf_counter() - begun, 6)
                    console.say(f"frame {frame}: {path} ({seconds:.1f} s)")
                    frames.append(_told(frame, path, stack, renders, seconds))
        summary = _summary(arguments, settings, frames, warnings.lines)
        summary["seconds"] = round(time.perf_counter() - start, 6)
        if arguments.stats:
            write_json(arguments.stats, summary)
    return summary


def _settings(scene, arguments):
    own = scene.aplanat.capture
    engine = arguments.engine or scene.render.engine
    if engine not in ENGINES:
        raise InputError(
            f"scene '{scene.name}' renders with {engine}, which makes no depth layers; choose one"
            f" with --engine: {', '.join(ENGINES)}"
        )
    overscan = own.overscan if arguments.overscan is None else arguments.overscan
    return CaptureSettings(
        engine=engine,
        layers=arguments.layers or own.layers,
        # As exact as it is said: Blender keeps it in single precision.
        overscan=round(overscan, 6),
        resolution=arguments.resolution,
    )


def _capture_frame(scene, frame, settings, folder, console, warnings):
    renders = []
    with FrameCapture(scene, frame, settings, Path(folder)) as capture_:
        warnings.add(capture_.warnings)
        steps = capture_.steps()
        while True:
            try:
                step = next(steps)
            except StopIteration as stop:
                for line in stop.value.report:
                    console.say(f"frame {frame}: note: {line}")
                return stop.value, capture_.words, renders
            console.progress(f"frame {frame}: {step.text} ({step.done + 1} of {step.total})")
            begun = time.perf_counter()
            _render(step, warnings)
            renders.append({"what": step.text, "seconds": round(time.perf_counter() - begun, 6)})


def _render(step, warnings):
    with listen(strict=warnings.strict) as heard:
        try:
            render_now(step)
        except InputError:
            # Our engine says more than Blender, which tells that it said something.
            if heard.error is None:
                raise
    if isinstance(heard.error, StrictError):
        warnings.add(heard.error.warnings)
    if heard.error is not None:
        raise heard.error
    if heard.cancelled:
        raise RenderCancelledError("the capture was stopped")
    warnings.add(heard.report)


def _told(frame, path, stack, renders, seconds):
    return {
        "frame": frame,
        "file": str(path),
        "kept": False,
        "layers": len(stack.layers),
        "cuts_m": [layer.near for layer in stack.layers[1:]],
        "renders": renders,
        "report": list(stack.report),
        "seconds": {
            "render": round(sum(render["seconds"] for render in renders), 6),
            "total": seconds,
        },
    }


def _summary(arguments, settings, frames, warnings):
    return {
        "command": "capture",
        "scene": str(arguments.scene),
        "files": [frame["file"] for frame in frames],
        "warnings": warnings,
        "aplanat": version(),
        "blender": bpy.app.version_string,
        "peak_memory_bytes": statistics.peak_memory(),
        "settings": {
            "engine": settings.engine,
            "layers": settings.layers,
            "overscan": settings.overscan,
            "resolution": settings.resolution and list(settings.resolution),
            "half": arguments.half,
        },
        "frames": frames,
    }
