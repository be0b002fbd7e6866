"""The parser of every command: refusals as `InputError`, and the options that all share."""

import argparse

from ...errors import InputError, OutputError
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


def add_farm_options(parser):
    """Add what templates of render farms need: ``--make-folders`` and ``--options``.

    `option_values.further_words` puts the words of the latter in its place.
    """
    parser.add_argument(
        "--make-folders", action="store_true", help="make the folder of -o if there is none"
    )
    parser.add_argument(
        "--options",
        metavar="WORDS",
        help="further options in one word, with quotes as a shell has them: for farms, whose"
        " templates have a fixed number of words",
    )


def make_folders(arguments, paths):
    """Make the folders of files, if ``--make-folders`` is given.

    Raises
    ------
    OutputError
    """
    for path in paths if arguments.make_folders else ():
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            reason = error.strerror or error
            raise OutputError(f"cannot make folder '{path.parent}': {reason}") from error
