"""The words of `aplanat bench` and what they may be."""

from pathlib import Path

from addon.cli.words.option_values import whole_number
from addon.cli.words.parser import RESOLUTION, Parser, add_output_options
from addon.errors import InputError
from addon.settings.scene_settings import MAX_SAMPLES

# Of `bench --bokeh`.
BOKEH_MEASURES = (
    *("pictures", "truth", "models", "culling", "visibility", "time", "peers", "pan"),
    *("scaling", "focus-pull", "lens", "discs"),
)


def parse(words, program="aplanat"):
    """Read the words of a bench.

    Parameters
    ----------
    words : list of str
        The first is ``bench``.
    program : str
        How the command is called, for messages.

    Returns
    -------
    argparse.Namespace
        With ``command``, ``bench``, and its options.

    Raises
    ------
    InputError
        If they make no bench.
    SystemExit
        After printing the help.
    """
    if words[:1] != ["bench"]:
        raise InputError(f"only `{program} bench` is measured here")
    arguments = _parser(program).parse_args(words[1:])
    _check(arguments)
    return arguments


def _check(arguments):
    for option in ("focus_pull", "peers"):
        if getattr(arguments, option) and (arguments.method != "adaptive" or arguments.lens):
            raise InputError(f"--{option.replace('_', '-')} belongs to --method adaptive")
    if arguments.chromatic and (arguments.method != "reference" or arguments.lens):
        raise InputError("--chromatic measures both methods; give neither --method nor --lens")
    if arguments.bokeh is not None and (arguments.method != "reference" or arguments.lens):
        raise InputError("--bokeh measures both methods; give neither --method nor --lens")


def _parser(program):
    parser = Parser(
        prog=f"{program} bench",
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
        type=RESOLUTION,
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
    add_output_options(parser)
    parser.set_defaults(command="bench")
    return parser
