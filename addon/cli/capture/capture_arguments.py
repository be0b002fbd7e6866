"""The words of `aplanat capture`; no Blender."""

from pathlib import Path

from ...capture.settings import ENGINES, MOST_LAYERS, MOST_OVERSCAN
from ..words.frame_values import (
    FRAMES_HELP,
    MAX_FRAME,
    check_frames,
    frame_number,
    frame_range,
)
from ..words.option_values import file_with_ending, number_between, whole_number
from ..words.parser import RESOLUTION, add_farm_options, add_output_options


def add_capture(commands):
    """Add the command to a parser's subcommands."""
    parser = commands.add_parser(
        "capture",
        help="render a shot as depth layers, to be refocused later",
        description="Renders frames of a .blend file as depth layers, what is hidden included: one"
        " EXR file a frame. What is not given is taken from the file; the file itself is never"
        " changed. Frames that are there already, whole and of the same settings, are left.",
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("scene", metavar="SCENE.blend", type=Path)
    add(
        "-o",
        "--output",
        metavar="LAYERS_####.exr",
        type=file_with_ending(".exr"),
        required=True,
        help="file of layers; #### becomes the frame number",
    )
    add("--engine", choices=ENGINES, help="renderer; default: the scene's")
    add(
        "--layers",
        metavar="K",
        type=whole_number(1, MOST_LAYERS),
        help="depth layers, besides the world's; default: the scene's",
    )
    frames = parser.add_mutually_exclusive_group()
    frames.add_argument(
        "--frame", metavar="N", type=frame_number, help="default: the file's current one"
    )
    frames.add_argument("--frames", metavar="FRAMES", type=frame_range, help=FRAMES_HELP)
    add(
        "--frame-step",
        metavar="N",
        type=whole_number(1, MAX_FRAME),
        help="of --frames A..B: every Nth only; default: the scene's frame step",
    )
    add("--resolution", metavar="WxH", type=RESOLUTION, help="in pixels, without the overscan")
    add(
        "--overscan",
        metavar="SHARE",
        type=number_between(0.0, MOST_OVERSCAN),
        help="share of the picture's width and height that is rendered on each side besides, for"
        " what a blurred edge needs; default: the scene's",
    )
    add("--half", action="store_true", help="colours in half precision: smaller files")
    add(
        "--strict",
        action="store_true",
        help="take warnings for errors: exit code 2, and no file is written",
    )
    add("--stats", metavar="FILE", type=Path, help="write statistics as JSON")
    add_output_options(parser)
    add_farm_options(parser)


def check_capture(arguments):
    """Refuse options that do not go together.

    Raises
    ------
    InputError
    """
    check_frames(arguments.frames, [arguments.output], arguments.frame_step)
