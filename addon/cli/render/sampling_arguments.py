"""The sampling options of `aplanat render`, as in Sampling, Level of Detail and Light."""

import argparse

from ...errors import InputError
from ...settings.scene_settings import SCENE
from ...settings.setting import MOST_WHOLE, settings_of
from ..words.option_values import number_between, positive_number, whole_number

# Bound of Blender's own property.
MAX_FILTER_PX = 500.0

_SETTINGS = settings_of(*SCENE)
# Options that set a setting as it is, by their names in the namespace.
_OF_SETTING = {
    "samples": "render_samples",
    "subsamples": "subsamples",
    "target_error": "render_error",
    "min_samples": "render_min_samples",
    "max_samples": "render_max_samples",
    "time_limit": "render_time_limit",
    "level_bias": "level_bias",
    "min_triangles": "least_triangles",
    "seed": "seed",
    "layers": "layers",
    "view_dependent": "use_view_dependence",
}
# Options of the adaptive method only, by their names in the namespace.
_ADAPTIVE = (
    *("subsamples", "target_error", "min_samples", "max_samples", "level_bias", "no_levels"),
    *("min_triangles", "sharing_cells"),
)
_LAYERED = ("layers", "layer_source", "view_dependent")
# Options that need a noise threshold, and options that need a fixed number of samples.
_AUTOMATIC = ("target_error", "min_samples", "max_samples")
_FIXED = ("samples", "subsamples")


def bounds(option):
    """Return the least and the largest value of the setting that an option sets."""
    return _SETTINGS[_OF_SETTING[option]].limits


def add_sampling(parser):
    """Add the options.

    Parameters
    ----------
    parser : argparse.ArgumentParser
    """
    add = parser.add_argument
    add("--method", choices=_SETTINGS["method"].words, help="default: the scene's")
    samples = whole_number(*bounds("samples"))
    add(
        "--target-error",
        metavar="X",
        type=number_between(*bounds("target_error")),
        help="adaptive method: noise threshold; samples are drawn, where they are needed, until the"
        " picture differs from a perfect one by no more than this (1 - SSIM; 0.02 draft, 0.01"
        " clean)",
    )
    add("--min-samples", metavar="N", type=samples, help="with a noise threshold: at least so many")
    add("--max-samples", metavar="N", type=samples, help="with a noise threshold: at most so many")
    add(
        "--time-limit",
        metavar="SECONDS",
        type=positive_number(),
        help="stop sampling a view layer after so long; the noise then depends on the machine",
    )
    add("--samples", metavar="N", type=samples, help="lens samples, instead of a noise threshold")
    add(
        "--subsamples",
        metavar="S",
        type=whole_number(*bounds("subsamples")),
        help="adaptive method without a noise threshold: places on the lens that a sample stands"
        " for besides its own",
    )
    add(
        "--sharing-cells",
        metavar="N",
        type=whole_number(0, _SETTINGS["sharing_cells"].limits[1]),
        help="adaptive method: places along a pixel that are told apart when samples share"
        " drawings of what is in focus; 0 shares none",
    )
    add(
        "--level-bias",
        metavar="X",
        type=number_between(*bounds("level_bias")),
        help="adaptive method: levels of detail by which blurred objects are drawn finer",
    )
    add("--no-levels", action="store_true", help="adaptive method: everything in full detail")
    add(
        "--min-triangles",
        metavar="N",
        type=whole_number(*bounds("min_triangles")),
        help="adaptive method: no level of detail has fewer",
    )
    add(
        "--shadows",
        action=argparse.BooleanOptionalAction,
        help="objects shadow one another, or nothing hides the light of lamps and sky",
    )
    add(
        "--layers",
        metavar="K",
        type=whole_number(*bounds("layers")),
        help="layered method: depth layers; default: the scene's",
    )
    add(
        "--layer-source",
        choices=_SETTINGS["layer_source"].words,
        help="layered method: a layer is a slice of depth, or what lies behind the layer before",
    )
    add(
        "--view-dependent",
        action="store_const",
        const=True,
        help="layered method: reflections depend on the place on the lens that they are seen from",
    )
    add(
        "--seed",
        metavar="N",
        type=whole_number(bounds("seed")[0], MOST_WHOLE),
        help="pattern of samples",
    )
    add("--filter", choices=_SETTINGS["pixel_filter"].words, help="pixel filter")
    add(
        "--filter-size",
        metavar="PX",
        type=positive_number(MAX_FILTER_PX),
        help="width of the pixel filter, in pixels",
    )


def check_sampling(arguments):
    """Refuse options that exclude each other.

    Parameters
    ----------
    arguments : argparse.Namespace

    Raises
    ------
    InputError
    """
    if arguments.method == "reference":
        for name in _given(arguments, _ADAPTIVE):
            raise InputError(
                f"{name} belongs to --method adaptive; the reference method has none: it draws"
                " everything in full detail, --samples times"
            )
    if arguments.method == "layered":
        for name in _given(arguments, _ADAPTIVE):
            raise InputError(
                f"{name} belongs to --method adaptive; the layered method casts --samples rays a"
                " pixel through --layers drawings in full detail"
            )
    if arguments.method not in (None, "layered"):
        for name in _given(arguments, _LAYERED):
            raise InputError(f"{name} belongs to --method layered, not to {arguments.method}")
    automatic, fixed = _given(arguments, _AUTOMATIC), _given(arguments, _FIXED)
    if automatic and fixed:
        raise InputError(
            f"{automatic[0]} and {fixed[0]} exclude each other: give a noise threshold, or a number"
            " of samples"
        )
    least, most = arguments.min_samples, arguments.max_samples
    if least is not None and most is not None and least > most:
        raise InputError(f"--min-samples {least} is more than --max-samples {most}")
    if arguments.no_levels and (
        arguments.level_bias is not None or arguments.min_triangles is not None
    ):
        raise InputError("--no-levels leaves nothing for --level-bias and --min-triangles to do")


def _given(arguments, names):
    return [
        "--" + name.replace("_", "-")
        for name in names
        if getattr(arguments, name) not in (None, False)
    ]


def apply_sampling(settings, render, arguments):
    """Apply the options to a scene's settings.

    Parameters
    ----------
    settings : AplanatSceneSettings
    render : bpy.types.RenderSettings
    arguments : argparse.Namespace
    """
    if arguments.method:
        settings.method = _SETTINGS["method"].identifier(arguments.method)
    if _given(arguments, _FIXED):
        settings.use_target_error = False
    if _given(arguments, _AUTOMATIC):
        settings.use_target_error = True
    for option, name in _OF_SETTING.items():
        value = getattr(arguments, option)
        if value is not None:
            setattr(settings, name, value)
    if arguments.no_levels:
        settings.use_levels = False
    elif arguments.level_bias is not None or arguments.min_triangles is not None:
        settings.use_levels = True
    if arguments.shadows is not None:
        settings.use_shadows = arguments.shadows
    if arguments.sharing_cells is not None:
        settings.use_sharing = arguments.sharing_cells > 0
        settings.sharing_cells = max(arguments.sharing_cells, 1)
    if arguments.layer_source:
        settings.layer_source = _SETTINGS["layer_source"].identifier(arguments.layer_source)
    if arguments.filter:
        settings.pixel_filter = _SETTINGS["pixel_filter"].identifier(arguments.filter)
    if arguments.filter_size:
        render.filter_size = arguments.filter_size
