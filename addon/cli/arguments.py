"""The arguments of the command line: parsing and checks; no Blender.

Every refusal is an `InputError` of one line.
"""

import argparse
import math
from pathlib import Path

from ..errors import InputError
from ..files.version import version
from ..settings.bokeh_settings import LIGHT
from ..settings.scene_part_settings import LENS
from ..settings.setting import settings_of
from .capture.capture_arguments import add_capture, check_capture
from .lens.lens_arguments import add_lens, check_lens
from .refocus.refocus_arguments import add_refocus, check_refocus
from .render.camera_arguments import add_aberrations, add_distortion
from .render.sampling_arguments import add_sampling, check_sampling
from .words.frame_values import (
    FRAMES_HELP,
    MAX_FRAME,
    check_frames,
    frame_number,
    frame_range,
)
from .words.option_values import (
    file_with_ending,
    further_words,
    joined_negatives,
    positive_number,
    whole_number,
    word_or_number,
)
from .words.parser import RESOLUTION, Parser, add_farm_options, add_output_options

ENDINGS = (".exr", ".png")

# argparse would take a negative number after these for an option.
_MAY_BE_NEGATIVE = {"--frames", "--level-bias", "--field-deg", "--planes-mm", "--rho"}


def parse(words, program="aplanat"):
    """Read the words of a command.

    Parameters
    ----------
    words : list of str
    program : str
        How the command is called, for messages.

    Returns
    -------
    argparse.Namespace
        With ``command``, ``render``, ``capture`` or ``lens``, and its options.

    Raises
    ------
    InputError
        If they do not make a command that this version knows.
    SystemExit
        After printing the help or the version.
    """
    if words and words[0] == "bench":
        raise InputError(
            f"{program} bench has its scenes and references in a checkout of the sources, from"
            " which this extension was built; call scripts/aplanat bench there"
        )
    words = further_words(words, "--options")
    arguments = _parser(program).parse_args(joined_negatives(words, _MAY_BE_NEGATIVE))
    if arguments.command is None:
        raise InputError(f"no command given (see `{program} --help`)")
    if arguments.command == "render":
        _check_render(arguments)
    elif arguments.command == "capture":
        check_capture(arguments)
    elif arguments.command == "refocus":
        check_refocus(arguments)
    elif arguments.command == "lens":
        check_lens(arguments)
    return arguments


def wants_json(words):
    """Whether `--json` is among the arguments, even if the rest is invalid."""
    return "--json" in words


def _check_render(arguments):
    check_sampling(arguments)
    check_frames(arguments.frames, arguments.output, arguments.frame_step)
    if len(set(arguments.output)) < len(arguments.output):
        raise InputError(f"-o {arguments.output[0]} is given twice; give two different names")


def _focus(text):
    try:
        distance = float(text)
    except ValueError:
        return text
    if not (math.isfinite(distance) and distance > 0.0):
        raise argparse.ArgumentTypeError(f"focus distance {text} must be greater than 0")
    return distance


def _parser(program):
    parser = Parser(
        prog=program,
        description="Aplanat renders Blender scenes through a camera lens.",
        epilog="A checkout of the sources has `scripts/aplanat bench` besides. Exit code: 0"
        " success, 2 unusable arguments or input, 1 failure.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"aplanat {version()}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", parser_class=Parser)
    _add_render(commands)
    add_capture(commands)
    add_refocus(commands)
    add_lens(commands, Parser)
    return parser


def _add_render(commands):
    parser = commands.add_parser(
        "render",
        help="render frames of a .blend file",
        description="Renders frames of a .blend file. What is not given is taken from the file;"
        " the file itself is never changed.",
        allow_abbrev=False,
    )
    parser.add_argument("scene", metavar="SCENE.blend", type=Path)
    add = parser.add_argument
    add(
        "-o",
        "--output",
        metavar="OUT",
        type=file_with_ending(*ENDINGS),
        action="append",
        default=[],
        help="picture file: .exr (multilayer, float, scene linear, all passes) or .png (as"
        " displayed); #### becomes the frame number; may be given twice. Default: the scene's own"
        " output path and format",
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
        help="of --frames A..B: render every Nth only; default: the scene's frame step",
    )
    add("--camera", metavar="NAME", help="camera object to render from")
    add("--resolution", metavar="WxH", type=RESOLUTION, help="in pixels, at 100 %%")
    add_sampling(parser)
    add("--no-bokeh", action="store_true", help="without separate highlights")
    add(
        "--highlights",
        metavar="auto|X",
        type=word_or_number(("auto",), *settings_of(LIGHT)["threshold"].limits),
        help="light brighter than X is a highlight; auto: what lens samples cannot draw",
    )
    add("--no-chromatic", action="store_true", help="without chromatic aberration")
    add(
        "--lens",
        metavar="ID|FILE",
        help="lens of the library, or a lens file; the camera's focal length stays",
    )
    add_distortion(parser)
    add(
        "--exposure",
        choices=settings_of(LENS)["exposure"].words,
        help="brightness of the corners with a real lens",
    )
    add_aberrations(parser)
    add("--breathing", action="store_true", help="focus breathing, if the camera has it not yet")
    add(
        "--fstop",
        metavar="X",
        type=positive_number(),
        help="f-number; turns depth of field on",
    )
    add(
        "--focus",
        metavar="DISTANCE|OBJECT",
        type=_focus,
        help="distance in m or object to focus on; turns depth of field on",
    )
    add(
        "--strict",
        action="store_true",
        help="take warnings for errors: exit code 2, and no file is written",
    )
    add("--stats", metavar="FILE", type=Path, help="write statistics as JSON")
    add_output_options(parser)
    add_farm_options(parser)
