"""The parser of every command: refusals as `InputError`, and the options that all share."""

import argparse

from ...errors import InputError
from .option_values import pixel_size

# Bounds of Blender's own properties.
MIN_SIDE, MAX_SIDE = 4, 65536
# The type of an option that takes WxH.
RESOLUTION = pixel_size(MIN_SIDE, MAX_SIDE)


class Parser(argparse.ArgumentParser):
    """A parser that raises `InputError` of one line where `argparse` would end the process."""

    def error(self, message):
        """Raise `InputError`."""
        raise InputError(f"{message} (see `{self.prog} --help`)")


def add_output_options(parser):
    """Add ``--json`` and ``--verbose``."""
    parser.add_argument("--json", action="store_true", help="print one JSON object on stdout")
    parser.add_argument(
        "--verbose", action="store_true", help="show Blender's own messages on stderr"
    )
