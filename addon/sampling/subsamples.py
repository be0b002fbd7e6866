"""Subsamples: the places on the lens that a lens sample stands for besides its own (methods 6).

The frame's whole sequence is longer than the number of lens samples that are drawn. Each of its
further places is a subsample of the nearest drawn sample, so that all places together are as evenly
spread as the sequence is, over whatever shape the iris has.

A progressive picture divides its samples into nested intervals, each as long as all before it: the
subsamples of an interval are shared out among its own samples, so that the lens is covered evenly
at the end of each.
"""

import numpy as np

# Samples of a progressive picture's first interval: with fewer, each would stand for so large a
# part of the lens that surfaces hidden from it would be missing.
FIRST_INTERVAL = 8


def intervals(samples, progressive):
    """Return the intervals of samples that share out subsamples.

    Parameters
    ----------
    samples : int
    progressive : bool

    Returns
    -------
    list of (int, int)
        First sample, and the one after the last.
    """
    ends = [samples]
    while progressive and ends[0] > FIRST_INTERVAL:
        ends.insert(0, max(FIRST_INTERVAL, (ends[0] + 1) // 2))
    return list(zip([0, *ends[:-1]], ends, strict=True))


def subsample_offsets(drawn, further, progressive=False):
    """Assign every subsample to the nearest lens sample that is drawn.

    Parameters
    ----------
    drawn : ndarray of shape (N, 2)
    further : ndarray of shape (N S, 2)
        Places on the lens of the subsamples, interval by interval.
    progressive : bool

    Returns
    -------
    offsets : ndarray of shape (N, K, 2)
        From each sample to its places, zero beyond their number.
    counts : ndarray of shape (N,)
        int; how many places each sample has.
    """
    nearest = np.empty(len(further), np.int64)
    each = len(further) // max(len(drawn), 1)
    for first, end in intervals(len(drawn), progressive):
        nearest[first * each : end * each] = first + _nearest(
            further[first * each : end * each], drawn[first:end]
        )
    counts = np.bincount(nearest, minlength=len(drawn))
    order = np.argsort(nearest, kind="stable")
    owner = nearest[order]
    rank = np.arange(len(further)) - np.searchsorted(owner, owner)
    offsets = np.zeros((len(drawn), int(counts.max(initial=0)), 2))
    offsets[owner, rank] = further[order] - drawn[owner]
    return offsets, counts


def _nearest(places, drawn):
    # In pieces: the whole table of distances of 4096 samples would take gigabytes.
    pieces = [
        np.square(places[start : start + 1024, None] - drawn[None]).sum(axis=2).argmin(axis=1)
        for start in range(0, len(places), 1024)
    ]
    return np.concatenate(pieces) if pieces else np.empty(0, np.int64)
