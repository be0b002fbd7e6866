"""Readers of frame numbers for `argparse`."""

import argparse
import re

from .option_values import whole_number

# Bound of Blender's own property.
MAX_FRAME = 1048574

frame_number = whole_number(-MAX_FRAME, MAX_FRAME)


def frame_range(text):
    """Read FIRST..LAST as two numbers."""
    match = re.fullmatch(r"(-?\d+)\.\.(-?\d+)", text)
    if not match:
        raise argparse.ArgumentTypeError(f"'{text}' is not FIRST..LAST, such as 1..24")
    first, last = frame_number(match[1]), frame_number(match[2])
    if first > last:
        raise argparse.ArgumentTypeError(f"{text}: the first frame comes after the last")
    return first, last
