"""Frames as options name them, and the checks that all commands share; no Blender."""

import argparse
import contextlib
import re
from dataclasses import dataclass

from ...errors import AplanatError, InputError
from ...files.frame_path import frame_path
from .option_values import whole_number

# Bound of Blender's own property.
MAX_FRAME = 1048574

frame_number = whole_number(-MAX_FRAME, MAX_FRAME)

_PART = re.compile(r"(-?\d+)(?:(?:\.\.|-)(-?\d+)(?::(\d+))?)?")
FRAMES_HELP = (
    "first and last frame, such as 1..24; or exactly the frames of a list as render farms write it,"
    " such as 1-5,8,10-20:2"
)


@dataclass(frozen=True)
class Frames:
    """The frames of a range, which is walked in steps, or those of a list.

    Parameters
    ----------
    first, last : int
    listed : tuple of int or None
        In order, each once; None for a range.
    """

    first: int
    last: int
    listed: tuple[int, ...] | None = None

    def numbers(self, step=1):
        """Return the frames.

        Parameters
        ----------
        step : int
            Of a range; a list has its own.

        Returns
        -------
        sequence of int
        """
        if self.listed is not None:
            return self.listed
        return range(self.first, self.last + 1, step)


def frame_range(text):
    """Read FIRST..LAST, or a list such as ``1-5,8,10-20:2``, as `Frames`."""
    if match := re.fullmatch(r"(-?\d+)\.\.(-?\d+)", text):
        return Frames(*_ordered(text, match[1], match[2]))
    frames = set()
    for part in text.split(","):
        match = _PART.fullmatch(part.strip())
        if not match:
            raise argparse.ArgumentTypeError(
                f"'{text}' is not FIRST..LAST, such as 1..24, nor a list, such as 1-5,8,10-20:2"
            )
        first, last = _ordered(text, match[1], match[2] or match[1])
        frames.update(range(first, last + 1, whole_number(1, MAX_FRAME)(match[3] or "1")))
    listed = tuple(sorted(frames))
    return Frames(listed[0], listed[-1], listed)


def check_frames(frames, patterns, step=None):
    """Refuse frames that do not fit the other words.

    Parameters
    ----------
    frames : Frames or None
    patterns : list of Path
        Names of the files to be written.
    step : int, optional
        Of `--frame-step`.

    Raises
    ------
    InputError
    """
    if step is not None and frames is None:
        raise InputError("--frame-step belongs to --frames; give the first and the last frame, too")
    if step is not None and frames.listed is not None:
        raise InputError(
            "--frame-step belongs to --frames FIRST..LAST; a list of frames has steps of its own,"
            " such as 1-24:2"
        )
    for path in patterns:
        if frames is not None and frames.first != frames.last and "#" not in path.name:
            raise InputError(
                f"-o {path}: several frames need #### in the file's name for the frame number"
            )


def first_file(path, arguments):
    """Return the file that is checked before all else: the first frame's, if that is known."""
    first = arguments.frames.first if arguments.frames else arguments.frame
    return path if first is None else frame_path(path, first)


def frame_numbers(scene, arguments):
    """Return the frames of `--frame` or `--frames`; without them, the scene's current one.

    Parameters
    ----------
    scene : bpy.types.Scene
    arguments : argparse.Namespace

    Returns
    -------
    sequence of int
    """
    if arguments.frames:
        return arguments.frames.numbers(arguments.frame_step or scene.frame_step)
    return (scene.frame_current if arguments.frame is None else arguments.frame,)


@contextlib.contextmanager
def telling_frame(frame, count):
    """In the `with` block, errors say in which frame they happened, if there are several.

    Parameters
    ----------
    frame, count : int
        The frame, and how many there are.
    """
    try:
        yield
    except AplanatError as error:
        said = f"frame {frame}: "
        if count > 1 and not str(error).startswith(said):
            error.args = (f"{said}{error}", *error.args[1:])
        raise


def _ordered(text, first, last):
    first, last = frame_number(first), frame_number(last)
    if first > last:
        raise argparse.ArgumentTypeError(f"{text}: the first frame comes after the last")
    return first, last
