"""The rounds of a picture whose number of lens samples is found while it is drawn.

Round after round doubles the samples: 0 to 8, 8 to 16, 16 to 32, ... Each shares out its further
places on the lens among its own samples (see `sampling.subsamples`), so that the part of the lens
that a sample stands for is the smaller the later the round. The picture is looked at when a round
ends and halfway through it: after 16, 24, 32, 48, 64, ... samples.

Nothing of a round depends on how many follow: the samples of a picture that stops early are the
first ones of a picture that goes on.
"""

from .subsamples import FIRST_INTERVAL

# Halton elements from here on are the further places: no drawn sample has them.
FURTHER_PLACES = 1 << 17
# Of samples, the first picture that can be compared with an earlier one, in first intervals.
_FIRST_LOOK = 2


def round_ends(samples, unit=1):
    """Return where the rounds end that a number of samples takes.

    Parameters
    ----------
    samples : int
        At least 1; the last round may be longer.
    unit : int
        Samples that share a place on the lens.

    Returns
    -------
    list of int
        Rising; the last is at least `samples`, and the second round is always whole.
    """
    ends = [FIRST_INTERVAL * unit, _FIRST_LOOK * FIRST_INTERVAL * unit]
    while ends[-1] < samples:
        ends.append(2 * ends[-1])
    return ends


def first_look(unit=1):
    """Return after how many samples the error can be told for the first time."""
    return _FIRST_LOOK * FIRST_INTERVAL * unit


def looks(most, unit=1):
    """Return after how many samples the picture is looked at.

    Parameters
    ----------
    most : int
        Samples after which it stops anyway.
    unit : int

    Returns
    -------
    list of int
        Rising, the last is `most`. Each but the last has half of it among the earlier, or is one of
        the first two, which are only kept for comparisons.
    """
    start = FIRST_INTERVAL * unit
    found = []
    while start < most:
        found += [start, start + start // 2]
        start *= 2
    return [look for look in found if look < most] + [most]
