"""Types of option values for `argparse`, each refusing in one sentence."""

import argparse
import math
import re
import shlex
from pathlib import Path

from ...errors import InputError


def whole_number(low, high):
    """Return a reader of whole numbers in a range."""

    def read(text):
        try:
            value = int(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"'{text}' is not a whole number") from None
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{value} is not between {low} and {high}")
        return value

    return read


def positive_number(high=math.inf):
    """Return a reader of numbers greater than 0."""

    def read(text):
        value = _number(text)
        if not (math.isfinite(value) and 0.0 < value <= high):
            bound = "" if high == math.inf else f" and at most {high:g}"
            raise argparse.ArgumentTypeError(f"{text} must be greater than 0{bound}")
        return value

    return read


def number_between(low, high, unit=""):
    """Return a reader of numbers in a range, both ends included."""

    def read(text):
        value = _number(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text} is not between {low:g} and {high:g}{unit}")
        return value

    return read


def word_or_number(words, low, high):
    """Return a reader of one of some words, or of a number in a range, both ends included."""

    def read(text):
        if text.lower() in words:
            return text.lower()
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(
                f"'{text}' is not {', '.join(words)} or a number between {low:g} and {high:g}"
            )
        return value

    return read


def number_list(low, high, count):
    """Return a reader of numbers with commas between; ``a,b,..,z`` goes from a to z in steps.

    Parameters
    ----------
    low, high : float
        Bounds of each number.
    count : int
        How many there may be.
    """
    bounded = number_between(low, high)

    def read(text):
        words = [word.strip() for word in text.split(",")]
        if ".." in words:
            values = _progression(text, words, bounded, count)
        else:
            values = [bounded(word) for word in words]
        if len(values) > count:
            raise argparse.ArgumentTypeError(f"{len(values)} numbers; at most {count} are allowed")
        return tuple(values)

    return read


def file_with_ending(*endings):
    """Return a reader of file names with one of some endings, dots included."""

    def read(text):
        path = Path(text)
        if path.suffix.lower() not in endings:
            *others, last = endings
            wanted = f"{', '.join(others)} or {last}" if others else last
            raise argparse.ArgumentTypeError(f"'{text}' must end in {wanted}")
        return path

    return read


def pixel_size(low, high):
    """Return a reader of WIDTHxHEIGHT."""

    def read(text):
        match = re.fullmatch(r"(\d{1,9})[xX](\d{1,9})", text)
        if not match:
            raise argparse.ArgumentTypeError(f"'{text}' is not WIDTHxHEIGHT, such as 1920x1080")
        size = int(match[1]), int(match[2])
        if not all(low <= side <= high for side in size):
            raise argparse.ArgumentTypeError(
                f"{text}: each side must be between {low} and {high} pixels"
            )
        return size

    return read


def joined_negatives(words, options):
    """Join options with a following word that starts with a minus and a digit.

    argparse would take ``-5..5`` or ``-2,3`` for an option.

    Parameters
    ----------
    words : list of str
    options : set of str

    Returns
    -------
    list of str
    """
    joined = []
    for word in words:
        if joined and joined[-1] in options and re.match(r"-[\d.]", word):
            joined[-1] = f"{joined[-1]}={word}"
        else:
            joined.append(word)
    return joined


def further_words(words, option):
    """Put the words that an option brings in one word in its place.

    Parameters
    ----------
    words : list of str
    option : str
        Such as ``--options``, before a word with words in it, quoted as in a shell.

    Returns
    -------
    list of str

    Raises
    ------
    InputError
        If a quote is not closed.
    """
    split, waiting = [], iter(words)
    for word in waiting:
        name, equals, text = word.partition("=")
        text = text if equals else (next(waiting, None) if name == option else None)
        if name != option or text is None:
            split.append(word)
            continue
        try:
            split += shlex.split(text)
        except ValueError as error:
            raise InputError(f"{option} {text}: {str(error).lower()}; close it") from error
    return split


def _number(text):
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number") from None


def _progression(text, words, bounded, count):
    if len(words) != 4 or words[2] != "..":
        raise argparse.ArgumentTypeError(
            f"'{text}': write FIRST,SECOND,..,LAST for numbers in equal steps"
        )
    first, second, last = (bounded(words[i]) for i in (0, 1, 3))
    step = second - first
    steps = (last - first) / step if step else -1.0
    # What is written with few digits need not divide without a remainder.
    if steps < 0.0 or not math.isclose(steps, round(steps), abs_tol=1e-6):
        raise argparse.ArgumentTypeError(
            f"'{text}': steps of {step:g} do not lead from {first:g} to {last:g}"
        )
    if steps >= count:
        raise argparse.ArgumentTypeError(f"{round(steps) + 1} numbers; at most {count} are allowed")
    places = range(round(steps) + 1)
    return [first + (last - first) * place / (max(len(places) - 1, 1)) for place in places]
