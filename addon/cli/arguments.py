"""The words of the command line and what they may be; no Blender.

Every refusal is an `InputError` of one line.
"""

import argparse
import math
import re
from pathlib import Path

from ..errors import InputError
from .lens.lens_arguments import add_lens, check_lens
from .render.sampling_arguments import MAX_SAMPLES, add_sampling, check_sampling
from .words.option_values import (
    file_with_ending,
    joined_negatives,
    pixel_size,
    positive_number,
    whole_number,
)
from .words.version import version

# Bounds of Blender's own properties.
MIN_SIDE, MAX_SIDE = 4, 65536
MAX_FRAME = 1048574

ENDINGS = (".exr", ".png")

# argparse would take a negative number after these for an option.
_MAY_BE_NEGATIVE = {"--frames", "--level-bias", "--field-deg", "--planes-mm", "--rho"}

# Of `bench --bokeh`.
BOKEH_MEASURES = (
    *("pictures", "truth", "models", "culling", "visibility", "time", "peers", "pan"),
    *("scaling", "focus-pull", "lens"),
)

_LATER = {
    "capture": "depth layers",
    "refocus": "depth layers",
    "--method layered": "depth layers",
    "--layers": "depth layers",
}


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise InputError(f"{message} (see `{self.prog} --help`)")


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
        With ``command``, ``render`` or ``bench``, and its options.

    Raises
    ------
    InputError
        If they do not make a command that this version knows.
    SystemExit
        After printing the help or the version.
    """
    if words and words[0] in _LATER:
        raise _not_yet(f"{program} {words[0]}", words[0])
    arguments = _parser(program).parse_args(joined_negatives(words, _MAY_BE_NEGATIVE))
    if arguments.command is None:
        raise InputError(f"no command given (see `{program} --help`)")
    if arguments.command == "render":
        _check_render(arguments)
    elif arguments.command == "bench":
        _check_bench(arguments)
    elif arguments.command == "lens":
        check_lens(arguments)
    return arguments


def wants_json(words):
    """Whether `--json` was asked for, even if the rest makes no command."""
    return "--json" in words


def _not_yet(what, key):
    return InputError(f"{what} is not in version {version()}; it comes later, with {_LATER[key]}")


def _check_render(arguments):
    if arguments.method == "layered":
        key = f"--method {arguments.method}"
        raise _not_yet(key, key)
    if arguments.layers is not None:
        raise _not_yet("--layers", "--layers")
    check_sampling(arguments)
    if arguments.frame_step is not None and arguments.frames is None:
        raise InputError("--frame-step belongs to --frames; give the first and the last frame, too")
    several = arguments.frames is not None and arguments.frames[0] != arguments.frames[1]
    for path in arguments.output:
        if several and "#" not in path.name:
            raise InputError(
                f"-o {path}: several frames need #### in the file's name for the frame number"
            )
    if len(set(arguments.output)) < len(arguments.output):
        raise InputError(f"-o {arguments.output[0]} is given twice; give two different names")


def _check_bench(arguments):
    for option in ("focus_pull", "peers"):
        if getattr(arguments, option) and (arguments.method != "adaptive" or arguments.lens):
            raise InputError(f"--{option.replace('_', '-')} belongs to --method adaptive")
    if arguments.chromatic and (arguments.method != "reference" or arguments.lens):
        raise InputError("--chromatic measures both methods; give neither --method nor --lens")
    if arguments.bokeh is not None and (arguments.method != "reference" or arguments.lens):
        raise InputError("--bokeh measures both methods; give neither --method nor --lens")


_frame = whole_number(-MAX_FRAME, MAX_FRAME)
_resolution = pixel_size(MIN_SIDE, MAX_SIDE)


def _frame_range(text):
    match = re.fullmatch(r"(-?\d+)\.\.(-?\d+)", text)
    if not match:
        raise argparse.ArgumentTypeError(f"'{text}' is not FIRST..LAST, such as 1..24")
    first, last = _frame(match[1]), _frame(match[2])
    if first > last:
        raise argparse.ArgumentTypeError(f"{text}: the first frame comes after the last")
    return first, last


def _focus(text):
    try:
        distance = float(text)
    except ValueError:
        return text
    if not (math.isfinite(distance) and distance > 0.0):
        raise argparse.ArgumentTypeError(f"focus distance {text} must be greater than 0")
    return distance


def _parser(program):
    parser = _Parser(
        prog=program,
        description="Aplanat renders Blender scenes through a camera lens.",
        epilog="Exit code: 0 success, 2 unusable arguments or input, 1 failure.",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"aplanat {version()}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", parser_class=_Parser)
    _add_render(commands)
    _add_bench(commands)
    add_lens(commands, _Parser)
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
    frames.add_argument("--frame", metavar="N", type=_frame, help="default: the file's current one")
    frames.add_argument("--frames", metavar="A..B", type=_frame_range, help="first and last frame")
    add(
        "--frame-step",
        metavar="N",
        type=whole_number(1, MAX_FRAME),
        help="of --frames: render every Nth only; default: the scene's frame step",
    )
    add("--camera", metavar="NAME", help="camera object to render from")
    add("--resolution", metavar="WxH", type=_resolution, help="in pixels, at 100 %%")
    add("--method", choices=("reference", "adaptive", "layered"), help="default: the scene's")
    add("--layers", metavar="K", type=whole_number(1, 64), help=argparse.SUPPRESS)
    add_sampling(parser)
    add("--no-bokeh", action="store_true", help="without separate highlights")
    add("--no-chromatic", action="store_true", help="without chromatic aberration")
    add(
        "--lens",
        metavar="ID|FILE",
        help="lens of the library, or a lens file; the camera's focal length stays",
    )
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
    _add_output_options(parser)


def _add_bench(commands):
    parser = commands.add_parser(
        "bench",
        help="measure cost and quality",
        description="Renders scenes with and without depth of field and compares the cost of a"
        " lens sample with that of a pinhole pass, and the pictures with references. With --method"
        " adaptive: compares work, time and quality of the adaptive method with plain accumulation."
        " With --lens: traces lenses, and compares their bokeh profiles with a direct trace.",
        allow_abbrev=False,
    )
    add = parser.add_argument
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--lens",
        metavar="ID|FILE",
        action="append",
        default=[],
        help="measure tracer and bokeh profile of a lens instead; may be repeated",
    )
    what.add_argument(
        "--scene",
        metavar="FILE|NAME",
        action="append",
        default=[],
        help=".blend file, or the name of a shared test scene (default: toys); may be repeated",
    )
    add("-o", "--output", metavar="FILE", type=Path, help="write the result as JSON")
    add(
        "--method",
        choices=("reference", "adaptive"),
        default="reference",
        help="what is measured (default reference)",
    )
    also = parser.add_mutually_exclusive_group()
    also.add_argument(
        "--focus-pull",
        action="store_true",
        help="adaptive method: measure flicker in a focus pull instead",
    )
    also.add_argument(
        "--peers",
        action="store_true",
        help="adaptive method: compare with EEVEE and Cycles at equal quality instead; takes long",
    )
    also.add_argument(
        "--chromatic",
        action="store_true",
        help="measure chromatic aberration instead: against its model and Cycles, noise, cost",
    )
    also.add_argument(
        "--bokeh",
        nargs="*",
        metavar="MEASURE",
        choices=BOKEH_MEASURES,
        help="measure highlights instead: " + ", ".join(BOKEH_MEASURES) + " (default: all of"
        " them, which takes hours)",
    )
    add(
        "--samples",
        metavar="N",
        type=whole_number(1, MAX_SAMPLES),
        help="lens samples of the reference method (default 512; 2048 for christmas_tree)",
    )
    add(
        "--resolution",
        metavar="WxH",
        type=_resolution,
        help="default 480x270; 1024x576 with --method adaptive, 320x180 with --chromatic",
    )
    add(
        "--reference",
        metavar="FILE.exr",
        type=Path,
        help="picture to compare a single scene with; shared scenes know theirs",
    )
    add("--look", choices=("flat", "lit"), default="flat", help="of shared scenes (default flat)")
    add("--pictures", metavar="FOLDER", type=Path, help="also write the pictures, as .exr")
    _add_output_options(parser)


def _add_output_options(parser):
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout")
    parser.add_argument(
        "--verbose", action="store_true", help="show Blender's own messages on stderr"
    )
