"""A shot captured frame by frame into files; frames that are there already are left."""

from pathlib import Path

import bpy

from ..files.frame_path import frame_path
from ..files.held_files import HeldFiles
from ..files.version import version
from .capture_files import is_captured, write_capture
from .frame_capture import FrameCapture


def software():
    """Return the names and versions of the software that captures."""
    return f"Aplanat {version()}, Blender {bpy.app.version_string}"


def capture_shot(scene, frames, settings, pattern, source, told):
    """Yield the renders of a shot that are needed, as `Step`, and write its files.

    Closing the generator ends the capture and leaves the scene as it was.

    Parameters
    ----------
    scene : bpy.types.Scene
    frames : sequence of int
    settings : CaptureSettings
    pattern : Path
        Of the files; # become the frame number.
    source : str
        What the scene is, see `CaptureSettings.digest`.
    told : callable
        Called with lines for the user.

    Yields
    ------
    frame : int
    step : Step
    share : float
        How much of the shot is done.

    Raises
    ------
    AplanatError
    """
    with HeldFiles() as held:
        for number, frame in enumerate(frames):
            path = frame_path(Path(pattern), frame)
            digest = settings.digest(frame, source, software())
            if is_captured(path, digest):
                told(f"frame {frame} is there already, whole and of these settings")
                continue
            with FrameCapture(scene, frame, settings, held.room("slices")) as capture:
                for line in capture.warnings:
                    told(line)
                steps = capture.steps()
                while True:
                    try:
                        step = next(steps)
                    except StopIteration as stop:
                        stack = stop.value
                        break
                    yield frame, step, (number + step.done / step.total) / len(frames)
                write_capture(path, stack, digest, software(), capture.words)
            for line in stack.report:
                told(line)
