"""The words of `aplanat refocus`; no Blender."""

import argparse
from pathlib import Path

from ...errors import InputError
from ...settings.refocus_settings import REFOCUS
from ...settings.scene_settings import SCENE
from ...settings.setting import MOST_WHOLE, settings_of
from ..render.camera_arguments import add_distortion
from ..words.frame_values import FRAMES_HELP, check_frames, frame_range
from ..words.option_values import file_with_ending, positive_number, whole_number
from ..words.parser import add_farm_options, add_output_options

_SAMPLES = settings_of(REFOCUS)["samples"]
_SEED = settings_of(*SCENE)["seed"]
_MOST_BLADES = 32


def add_refocus(commands):
    """Add the command to a parser's subcommands."""
    parser = commands.add_parser(
        "refocus",
        help="see captured depth layers through another lens",
        description="Makes pictures of captured depth layers (`aplanat capture`) with another"
        " focus, f-number, lens or iris, without rendering again. What is not given is as it was"
        " captured, or as the camera of --scene has it in each frame.",
        allow_abbrev=False,
    )
    add = parser.add_argument
    add("layers", metavar="LAYERS_####.exr", type=Path, help="captured files")
    add(
        "-o",
        "--output",
        metavar="OUT_####",
        type=file_with_ending(".exr", ".png"),
        required=True,
        help="picture file: .exr (float, scene linear) or .png (as displayed); #### becomes the"
        " frame number",
    )
    add(
        "--frames",
        metavar="FRAMES",
        type=frame_range,
        help=f"{FRAMES_HELP}; default: every captured file that there is",
    )
    add(
        "--scene",
        metavar="SHOT.blend",
        type=Path,
        help="take focus (keyframes and focus object included), f-number, lens, iris, bokeh and"
        " chromatic aberration from its camera, frame by frame; place and framing stay the"
        " capture's",
    )
    add("--camera", metavar="NAME", help="camera object of --scene; default: the scene's")
    add("--focus", metavar="DISTANCE", type=positive_number(), help="in m along the optical axis")
    add("--fstop", metavar="X", type=positive_number(), help="f-number")
    add("--blades", metavar="N", type=_blades, help="of the iris; 0: round")
    add("--lens", metavar="ID|FILE", help="lens of the library, or a lens file")
    add_distortion(parser)
    add("--no-bokeh", action="store_true", help="without separate highlights")
    add("--no-chromatic", action="store_true", help="without chromatic aberration")
    add(
        "--samples",
        metavar="N",
        type=whole_number(*_SAMPLES.limits),
        default=_SAMPLES.default,
        help="lens samples (default %(default)s)",
    )
    add(
        "--seed",
        metavar="N",
        type=whole_number(_SEED.limits[0], MOST_WHOLE),
        default=_SEED.default,
        help="pattern of samples",
    )
    flat = parser.add_argument_group(
        "pictures with a depth pass",
        "Any EXR picture with a depth channel is taken as one layer; what is not given is guessed"
        " from names, metadata and values, and told.",
    )
    flat.add_argument("--depth-channel", metavar="NAME", help="channel of the depth")
    flat.add_argument("--color-layer", metavar="NAME", help="what stands before .R of the colours")
    flat.add_argument(
        "--ray-depth",
        action="store_true",
        default=None,
        help="depth is the distance from the lens, not the one along the optical axis",
    )
    flat.add_argument(
        "--depth-range",
        metavar="NEAR,FAR",
        type=_depth_range,
        help="depths in m that the values 0 and 1 stand for",
    )
    flat.add_argument(
        "--inverted-depth",
        action="store_true",
        default=None,
        help="1 is near; without --depth-range: values are one over the depth",
    )
    flat.add_argument("--depth-scale", metavar="X", type=positive_number(), help="metres in a unit")
    flat.add_argument("--focal-length", metavar="MM", type=positive_number())
    flat.add_argument("--sensor-width", metavar="MM", type=positive_number())
    add("--strict", action="store_true", help="take warnings for errors: exit code 2")
    add("--stats", metavar="FILE", type=Path, help="write statistics as JSON")
    add_output_options(parser)
    add_farm_options(parser)


def _blades(text):
    count = whole_number(0, _MOST_BLADES)(text)
    if count in (1, 2):
        raise argparse.ArgumentTypeError(
            f"{count} blades make no opening; use 0 (round) or 3 to {_MOST_BLADES}"
        )
    return count


def _depth_range(text):
    try:
        near, far = (float(word) for word in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not NEAR,FAR, such as 0.5,20") from None
    if not 0.0 <= near < far < float("inf"):
        raise argparse.ArgumentTypeError(f"{text}: NEAR must be at least 0, and FAR beyond it")
    return near, far


def check_refocus(arguments):
    """Refuse options that do not go together.

    Raises
    ------
    InputError
    """
    if arguments.frames is not None and "#" not in arguments.layers.name:
        raise InputError(
            f"--frames chooses among files with a frame number; '{arguments.layers}' has no #### in"
            " its name"
        )
    if arguments.camera is not None and arguments.scene is None:
        raise InputError(
            f"--camera {arguments.camera} is an object of a scene; name its file with --scene"
        )
    check_frames(arguments.frames, [arguments.output])
