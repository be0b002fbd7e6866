"""Options of the camera's lens that several commands have."""

from ...settings.scene_part_settings import DISTORTION
from ...settings.setting import settings_of
from ..words.option_values import word_or_number


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
