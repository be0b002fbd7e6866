"""The rounds of a picture whose number of lens samples is found while it is drawn.

Each round doubles the samples: 0 to 8, 8 to 16, 16 to 32, ... Each has subsamples of its own,
shared out among its own samples (see `sampling.subsamples`), so that the part of the lens that a
sample stands for is the smaller the later the round. The error of the picture is measured at the
end of a round and halfway through it: after 16, 24, 32, 48, 64, ... samples.

No round depends on how many follow: the samples of a picture that stops early are the first
samples of one that goes on.
"""

from .subsamples import FIRST_INTERVAL

# Halton elements from here on are subsamples: no drawn lens sample has them.
FURTHER_PLACES = 1 << 17
# Samples of the first picture that can be compared with an earlier one, in intervals of the first
# round.
_FIRST_LOOK = 2


def first_look(unit=1):
    """Return after how many samples the error can be estimated for the first time."""
    return _FIRST_LOOK * FIRST_INTERVAL * unit


def looks(most, unit=1):
    """Return the numbers of samples after which the error of the picture is measured.

    Parameters
    ----------
    most : int
        Samples after which sampling stops in any case.
    unit : int

    Returns
    -------
    list of int
        Rising, the last is `most`. For each but the first two and the last, half of it is among
        them, too; the first two are only kept for comparisons.
    """
    start = FIRST_INTERVAL * unit
    found = []
    while start < most:
        found += [start, start + start // 2]
        start *= 2
    return [look for look in found if look < most] + [most]
