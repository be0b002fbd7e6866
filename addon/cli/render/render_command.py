"""`aplanat render`: frames of a .blend file to picture files.

The render goes through Blender's own render operator, because only a render engine is given the
scene as it renders (subdivision for rendering, objects hidden in renders, simplify).
"""

import time

import bpy

from ...device.context import ensure_context, max_texture_size
from ...engine.report import without_count
from ...engine.shared_resources import listen, resources
from ...errors import AplanatError, DeviceLimitError, InputError, RenderCancelledError, StrictError
from ...files.whole_file import check_writable, removed_on_signals
from ..words.frame_values import first_file, frame_numbers, telling_frame
from ..words.json_file import write_json
from ..words.parser import make_folders
from . import statistics
from .frame_files import FrameFiles
from .scene_setup import apply_frame, apply_options, find_lens, load_scene


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
    with removed_on_signals(), resources().open_session() as session:
        _check_outputs(arguments)
        scene = load_scene(arguments.scene)
        apply_options(scene, arguments)
        lens_id = find_lens(arguments.lens)
        ensure_context()
        _check_device(scene)
        warnings = Warnings(console, arguments.strict)
        _leave_out(scene, warnings)
        frames = []
        with FrameFiles(scene, arguments.output, keeps_back=arguments.strict) as files:
            numbers = frame_numbers(scene, arguments)
            for frame in numbers:
                with telling_frame(frame, len(numbers)):
                    apply_frame(scene, frame, arguments, lens_id)
                    if not files.begin(frame):
                        console.say(f"frame {frame}: left as it is; the scene's Overwrite is off")
                        continue
                    frames.append(
                        _render_frame(scene, frame, arguments, console, warnings, files, session)
                    )
            files.publish_all()
        if arguments.strict:
            _tell_files(frames, console)
        summary = _summary(arguments, frames, warnings.lines)
        if arguments.stats:
            write_json(arguments.stats, summary)
    return summary


class Warnings:
    """The warnings of a command: each printed once, or an error if it is strict.

    Parameters
    ----------
    console : Console
    strict : bool

    Attributes
    ----------
    lines : list of str
    """

    def __init__(self, console, strict=False):
        self.lines = []
        self._told = set()
        self.strict = strict
        self._console = console

    def add(self, lines):
        """Print the lines that are new.

        Raises
        ------
        StrictError
            If there are any and the command is strict.
        """
        for line in lines:
            if without_count(line) not in self._told:
                self._told.add(without_count(line))
                self.lines.append(line)
                self._console.say(f"warning: {line}")
        if self.strict and self.lines:
            raise StrictError(self.lines)


def heard_render(keep_pictures=False, progress=None, strict=False, frame=None, session=None):
    """Render a frame of the current scene and return its outcome.

    Parameters
    ----------
    keep_pictures : bool
    progress : callable, optional
    strict : bool
        See `RenderOutcome`.
    frame : int, optional
        Rendered as an animation of one: Blender writes the scene's output, and File Output nodes
        number their files, as with ``blender -b -a`` and ``-f``. By default the current frame, as a
        still.
    session : RenderSession, optional
        Of the command that renders more than this; default: one for this render.

    Returns
    -------
    RenderOutcome

    Raises
    ------
    AplanatError
        If there is no picture.
    """
    how = {} if frame is None else {"animation": True, "frame_start": frame, "frame_end": frame}
    with listen(keep_pictures, progress, strict, session) as heard:
        try:
            bpy.ops.render.render(**how)
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
    make_folders(arguments, arguments.output)
    for path in arguments.output:
        check_writable(first_file(path, arguments))
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


def _leave_out(scene, warnings):
    editor, render = scene.sequence_editor, scene.render
    if render.use_sequencer and editor and editor.strips:
        render.use_sequencer = False
        what = "the video sequencer is left out; the 3D scene is rendered"
        warnings.add([f"scene '{scene.name}': {what}"])


def _render_frame(scene, frame, arguments, console, warnings, files, session):
    start = time.perf_counter()
    settings = statistics.settings_in_force(scene, session.sources, arguments)

    def run():
        try:
            heard = heard_render(
                progress=lambda _share, text: console.progress(f"frame {frame}: {text}"),
                strict=arguments.strict,
                frame=frame,
                session=session,
            )
        except StrictError as error:
            warnings.add(error.warnings)
            raise
        warnings.add(heard.report)
        return heard

    renders = files.render(frame, run)
    with renders[-1].statistics.timed("write"):
        written, problems = files.end()
    warnings.add(problems)
    work = statistics.total_work([statistics.work(heard.statistics) for heard in renders])
    work["seconds"]["total"] = round(time.perf_counter() - start, 6)
    done = {
        "frame": frame,
        "files": [str(path) for path in written],
        **work,
        "settings": settings,
    }
    if not arguments.strict:
        _tell_files([done], console)
    return done


def _tell_files(frames, console):
    for done in frames:
        for path in done["files"]:
            console.say(f"frame {done['frame']}: {path} ({done['seconds']['total']:.1f} s)")


def _summary(arguments, frames, warnings):
    other = {"frame", "files", "settings"}
    work = [{key: value for key, value in frame.items() if key not in other} for frame in frames]
    return {
        "command": "render",
        "scene": str(arguments.scene),
        # Several frames may write the same file.
        "files": list(dict.fromkeys(path for frame in frames for path in frame["files"])),
        "warnings": warnings,
        **statistics.machine(),
        **statistics.total_work(work),
        "settings": frames[0]["settings"] if frames else None,
        "frames": frames,
    }
