"""The arguments of `aplanat lens`; no Blender."""

import argparse
from pathlib import Path

from ...errors import InputError
from ..words.option_values import (
    file_with_ending,
    number_between,
    number_list,
    pixel_size,
    positive_number,
    whole_number,
)

PLOT_ENDINGS = (".png", ".svg", ".pdf")
# Range of wavelengths, nm: from the absorption of ordinary glass to the end of dispersion formulas.
WAVELENGTHS_NM = (200.0, 5000.0)
# The fan of the axial point unless told otherwise.
DEFAULT_RHO = tuple(place / 20.0 for place in range(21))
DEFAULT_GRID = 401
# Largest counts: beyond, output would be unreadable or take minutes.
_MAX_COUNT = 10001
_MAX_GRID = 4001


def add_lens(commands, parser_class):
    """Add the command `lens` to the others.

    Parameters
    ----------
    commands : argparse sub-parsers
    parser_class : type
        Of the parsers of its own commands.
    """
    lens = commands.add_parser(
        "lens",
        help="look into real lenses, and make tables, drawings and lens files of them",
        description="Looks into real lenses. LENS is the name of a lens of the library (`aplanat"
        " lens list`) or a lens file.",
        allow_abbrev=False,
    )
    # Where no word of its own follows, these are asked for.
    lens.set_defaults(json=False, verbose=False)
    words = lens.add_subparsers(
        dest="lens_command", metavar="COMMAND", parser_class=parser_class, required=True
    )
    _add_list(words)
    _add_info(words)
    _add_trace(words)
    _add_bake(words)
    _add_plot(words)
    _add_import(words)


def check_lens(arguments):
    """Refuse options of `lens` that do not go together.

    Parameters
    ----------
    arguments : argparse.Namespace

    Raises
    ------
    InputError
    """
    if arguments.lens_command == "plot" and (arguments.lens is None) == (arguments.compare is None):
        raise InputError("name one lens, or two with --compare A B")
    if arguments.lens_command != "trace":
        return
    if arguments.field_deg is None:
        unfit, kind = ("grid",), "--field-deg"
    else:
        unfit, kind = ("rho", "planes_mm"), "--object-to-first-vertex-mm"
    for name in unfit:
        if getattr(arguments, name) is not None:
            raise InputError(f"--{name.replace('_', '-')} belongs to {kind}; leave one of them out")


def _command(words, name, help_text, description=None):
    parser = words.add_parser(
        name, help=help_text, description=description or f"{help_text}.", allow_abbrev=False
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout")
    parser.add_argument("--verbose", action="store_true", help="show libraries' own messages")
    return parser


def _add_list(words):
    _command(words, "list", "Lists the lenses of the library")


def _add_info(words):
    parser = _command(words, "info", "Tells what a lens is: source, first-order values, warnings")
    _add_lens_word(parser)
    _add_setting(parser)


def _add_trace(words):
    parser = _command(
        words,
        "trace",
        "Traces rays: a fan from a point on the axis, or a beam from infinity",
    )
    _add_lens_word(parser)
    kind = parser.add_mutually_exclusive_group(required=True)
    kind.add_argument(
        "--object-to-first-vertex-mm",
        metavar="Z",
        type=positive_number(1e12),
        help="a fan of rays from the axial point that far in front of surface 1",
    )
    kind.add_argument(
        "--field-deg",
        metavar="A",
        type=number_between(-89.999, 89.999, " degrees"),
        help="a beam from infinity at this angle to the axis: what of it gets through",
    )
    parser.add_argument(
        "--rho",
        metavar="R,..",
        type=number_list(-100.0, 100.0, _MAX_COUNT),
        help="heights of the fan's rays in the entrance pupil, in units of its radius, such as"
        " 0,0.5,1 or 0,0.05,..,1 (the default)",
    )
    parser.add_argument(
        "--planes-mm",
        metavar="P,..",
        type=number_list(-1e9, 1e9, _MAX_COUNT),
        help="planes behind the last vertex where heights are told; default: the paraxial image -5"
        " %%, -1 %%, 0, +1 %% of the focal length, and the focus of infinity",
    )
    parser.add_argument(
        "--grid",
        metavar="N",
        type=whole_number(3, _MAX_GRID),
        help=f"rays of the beam along each side (default {DEFAULT_GRID})",
    )
    _add_setting(parser)


def _add_bake(words):
    parser = _command(
        words, "bake", "Writes the bokeh tables that the renderer reads, as an EXR file"
    )
    _add_lens_word(parser)
    parser.add_argument(
        "-o", "--output", metavar="LUT.exr", type=file_with_ending(".exr"), required=True
    )
    _add_colour(parser)
    _add_zoom(parser)


def _add_plot(words):
    parser = _command(
        words,
        "plot",
        "Draws a data sheet of a lens, or two lenses side by side",
        "Draws a data sheet: section, spots, aberrations, distortion, vignetting, bokeh; or what"
        " tells two lenses apart: section, bokeh over field and distance, sharpness, vignetting.",
    )
    parser.add_argument(
        "lens", metavar="LENS", nargs="?", help="name in the library, or a lens file"
    )
    parser.add_argument(
        "--compare",
        metavar=("A", "B"),
        nargs=2,
        help="two lenses in place of LENS, side by side, each wide open; --zoom is for those of"
        " them that have the position",
    )
    parser.add_argument(
        "-o", "--output", metavar="OUT", type=file_with_ending(*PLOT_ENDINGS), required=True
    )
    parser.add_argument(
        "--size",
        metavar="WxH",
        type=pixel_size(640, 8192),
        default=(1600, 1200),
        help="of a .png, in pixels (default 1600x1200)",
    )
    _add_colour(parser)
    _add_zoom(parser)


def _add_import(words):
    parser = _command(words, "import", "Makes a lens file of a lens in a foreign format")
    parser.add_argument("file", metavar="FILE", type=Path)
    parser.add_argument(
        "-o", "--output", metavar="OUT.toml", type=file_with_ending(".toml"), required=True
    )
    answers = parser.add_argument_group("where the file leaves it open")
    answers.add_argument(
        "--thickness",
        choices=("before", "after"),
        help="pbrt: a row's thickness is the gap before or after its surface",
    )
    answers.add_argument(
        "--stop", metavar="N", type=whole_number(1, 1000), help="surface or row that is the stop"
    )
    answers.add_argument(
        "--radii",
        choices=("radius", "curvature"),
        help="CODE V: what the first number of a surface is",
    )
    answers.add_argument(
        "--f-number", metavar="X", type=positive_number(1e6), help="wide open, if not in the file"
    )
    answers.add_argument(
        "--half-field",
        metavar="DEG",
        type=number_between(0.001, 89.999, " degrees"),
        help="from the axis to the corner, if not in the file",
    )
    answers.add_argument(
        "--glass",
        metavar="NAME=ND,VD|GLASS",
        type=_glass,
        action="append",
        default=[],
        help="a glass that the catalogue does not have, by index and Abbe number or as a glass that"
        " it has; may be repeated",
    )


def _glass(text):
    # Only an import needs what this takes along.
    from ...lens_io.importers import glass_option

    try:
        return glass_option(text)
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _add_lens_word(parser):
    parser.add_argument("lens", metavar="LENS", help="name in the library, or a lens file")


def _add_setting(parser):
    parser.add_argument(
        "--wavelength",
        metavar="NM",
        type=number_between(*WAVELENGTHS_NM, " nm"),
        help="in nm (default 587.5618, the d line)",
    )
    _add_zoom(parser)


def _add_zoom(parser):
    parser.add_argument(
        "--zoom", metavar="LABEL", help="zoom position (default: the shortest focal length)"
    )


def _add_colour(parser):
    kind = parser.add_mutually_exclusive_group()
    kind.add_argument(
        "--chromatic",
        dest="chromatic",
        action="store_true",
        help="in colour, from 25 wavelengths (default)",
    )
    kind.add_argument(
        "--achromatic",
        dest="chromatic",
        action="store_false",
        help="one wavelength, the d line: quicker",
    )
    parser.set_defaults(chromatic=True)
