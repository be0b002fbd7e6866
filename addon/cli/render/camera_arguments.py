"""Options of the camera's lens that several commands have."""

import argparse

from ...settings.scene_part_settings import ABERRATIONS, DISTORTION
from ...settings.setting import settings_of, told
from ..words.option_values import number_between, word_or_number


def add_distortion(parser):
    """Add ``--distortion``.

    Parameters
    ----------
    parser : argparse.ArgumentParser
    """
    low, high = settings_of(DISTORTION)["distortion_k"].limits
    parser.add_argument(
        "--distortion",
        metavar="none|lens|K",
        type=word_or_number(("none", "lens"), low, high),
        help="none, that of the real lens, or K of the division model, negative for a barrel"
        f" ({low:g} to {high:g}); default: the camera's",
    )


def add_aberrations(parser):
    """Add ``--aberration``.

    Parameters
    ----------
    parser : argparse.ArgumentParser
    """
    names = ", ".join(told(name) for name in settings_of(ABERRATIONS))
    parser.add_argument(
        "--aberration",
        metavar="NAME=X",
        type=_strength,
        action="append",
        default=[],
        help="strength of an aberration of a camera without a real lens, for each that is not to be"
        f" the camera's: {names}",
    )


def _strength(text):
    """Return the name of a setting and its value."""
    word, _, value = text.partition("=")
    settings = {told(name): setting for name, setting in settings_of(ABERRATIONS).items()}
    if word not in settings:
        raise argparse.ArgumentTypeError(
            f"no aberration '{word}'; there are {', '.join(settings)}, as in spherical=2"
        )
    return settings[word].name, number_between(*settings[word].limits)(value)
