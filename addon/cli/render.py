"""`aplanat render`: frames of a .blend file to picture files.

The render goes through Blender's own render operator, because only a render engine is given the
scene as it renders (subdivision for rendering, objects hidden in renders, simplify).
"""

import re
import time
from importlib.util import find_spec
from pathlib import Path

import bpy

from ..device.context import ensure_context, max_texture_size
from ..engine import outcome
from ..errors import AplanatError, DeviceLimitError, InputError, RenderCancelledError
from ..files.whole_file import check_writable, removed_on_signals
from . import pictures, statistics
from .json_file import write_json
from .scene_setup import apply_frame, apply_options, load_scene


class RenderFailedError(AplanatError):
    """Blender ended a render without a picture and without a reason."""


def render(arguments, console):
    """Carry out `aplanat render`.

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
        If there is no picture.
    """
    with removed_on_signals():
        _check_outputs(arguments)
        scene = load_scene(arguments.scene)
        apply_options(scene, arguments)
        ensure_context()
        _check_device(scene)
        warnings = _leave_out(scene, console)
        if not arguments.output:
            _check_scene_output(scene)
        frames = []
        for frame in _frame_numbers(scene, arguments):
            if not arguments.output and _is_kept(scene, frame):
                console.say(f"frame {frame}: left as it is; the scene's Overwrite is off")
                continue
            frames.append(_render_frame(scene, frame, arguments, console, warnings))
        summary = _summary(arguments, frames, warnings)
        if arguments.stats:
            write_json(arguments.stats, summary)
    return summary


def frame_path(path, frame):
    """Put a frame number into the last run of # of a file name.

    Parameters
    ----------
    path : Path
    frame : int

    Returns
    -------
    Path
        The same path if its name has no #.
    """
    runs = list(re.finditer("#+", path.name))
    if not runs:
        return path
    first, last = runs[-1].span()
    digits = f"{'-' if frame < 0 else ''}{abs(frame):0{last - first}d}"
    return path.with_name(path.name[:first] + digits + path.name[last:])


def heard_render(keep_pictures=False, progress=None):
    """Render the current frame of the current scene and return what became of it.

    Parameters
    ----------
    keep_pictures : bool
    progress : callable, optional
        See `outcome.listen`.

    Returns
    -------
    RenderOutcome

    Raises
    ------
    AplanatError
        If there is no picture.
    """
    with outcome.listen(keep_pictures, progress) as heard:
        try:
            bpy.ops.render.render()
        except RuntimeError as error:
            if heard.error is None:
                reason = str(error).strip().splitlines()[0].removeprefix("Error: ")
                raise InputError(f"Blender does not render this scene: {reason}") from error
    if heard.error is not None:
        raise heard.error
    if heard.cancelled:
        raise RenderCancelledError("the render was stopped")
    if heard.statistics.lens_samples == 0:
        raise RenderFailedError("the render engine failed; its own messages follow")
    return heard


def _check_outputs(arguments):
    frame = arguments.frames[0] if arguments.frames else arguments.frame or 0
    for path in arguments.output:
        check_writable(frame_path(path, frame))
        if path.suffix.lower() == ".exr" and find_spec("OpenEXR") is None:
            raise InputError(
                f"-o {path}: the OpenEXR package is missing; install Aplanat from its extension zip"
            )
    if arguments.stats:
        check_writable(arguments.stats)


def _check_device(scene):
    render = scene.render
    width = render.resolution_x * render.resolution_percentage // 100
    height = render.resolution_y * render.resolution_percentage // 100
    limit = max_texture_size()
    if max(width, height) > limit and not render.use_border:
        raise DeviceLimitError(
            f"{limit} pixels a side",
            f"a picture of {width} x {height} pixels was asked for (choose a smaller resolution)",
        )


def _check_scene_output(scene):
    if scene.render.is_movie_format:
        raise InputError(
            f"scene '{scene.name}' is set to write a movie; name picture files with -o, such as"
            " -o frame_####.png"
        )
    folder = _scene_path(scene, scene.frame_current).parent
    try:
        # As Blender does for the scene's own output path.
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"output folder '{folder}' of scene '{scene.name}' cannot be made"
            f" ({error.strerror}); name a file with -o"
        ) from error
    check_writable(folder / "frame")


def _leave_out(scene, console):
    left_out = []
    editor, render = scene.sequence_editor, scene.render
    if render.use_sequencer and editor and editor.strips:
        render.use_sequencer = False
        left_out.append("the video sequencer is left out; the 3D scene is rendered")
    if render.use_multiview:
        render.use_multiview = False
        left_out.append("stereoscopy is left out; one picture is rendered")
    lines = [f"scene '{scene.name}': {line}" for line in left_out]
    for line in lines:
        console.say(f"warning: {line}")
    return lines


def _frame_numbers(scene, arguments):
    if arguments.frames:
        first, last = arguments.frames
        return range(first, last + 1)
    frame = scene.frame_current if arguments.frame is None else arguments.frame
    return range(frame, frame + 1)


def _render_frame(scene, frame, arguments, console, warnings):
    start = time.perf_counter()
    apply_frame(scene, frame, arguments)
    settings = statistics.settings_in_force(scene, arguments)
    needs_layers = any(path.suffix.lower() == ".exr" for path in arguments.output)
    heard = heard_render(
        needs_layers, lambda _share, text: console.progress(f"frame {frame}: {text}")
    )
    for line in heard.report:
        if line not in warnings:
            warnings.append(line)
            console.say(f"warning: {line}")
    with heard.statistics.timed("write"):
        files = _write(scene, frame, arguments, heard)
    work = statistics.work(heard.statistics)
    work["seconds"]["total"] = round(time.perf_counter() - start, 6)
    for path in files:
        console.say(f"frame {frame}: {path} ({work['seconds']['total']:.1f} s)")
    return {
        "frame": frame,
        "files": [str(path) for path in files],
        **work,
        "settings": settings,
    }


def _scene_path(scene, frame):
    return Path(bpy.path.abspath(scene.render.frame_path(frame=frame)))


def _is_kept(scene, frame):
    return not scene.render.use_overwrite and _scene_path(scene, frame).exists()


def _write(scene, frame, arguments, heard):
    if not arguments.output:
        path = _scene_path(scene, frame)
        path.parent.mkdir(parents=True, exist_ok=True)
        pictures.save_as_set(path, scene)
        return [path]
    files = []
    layers = [layer for layer in heard.layers if layer.scene == scene.name]
    for pattern in arguments.output:
        path = frame_path(pattern, frame)
        if path.suffix.lower() == ".exr":
            pictures.save_exr(path, layers, scene)
        else:
            pictures.save_png(path, scene)
        files.append(path)
    return files


def _summary(arguments, frames, warnings):
    other = {"frame", "files", "settings"}
    work = [{key: value for key, value in frame.items() if key not in other} for frame in frames]
    return {
        "command": "render",
        "scene": str(arguments.scene),
        "files": [path for frame in frames for path in frame["files"]],
        "warnings": warnings,
        **statistics.machine(),
        **statistics.total_work(work),
        "settings": frames[0]["settings"] if frames else None,
        "frames": frames,
    }
