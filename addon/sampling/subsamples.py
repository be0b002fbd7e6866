"""The places on the lens that a lens sample stands for besides its own (methods 6).

The frame's whole sequence is longer than the number of samples that are drawn. Each further place
belongs to the drawn sample nearest to it, so that all places together are as evenly spread as the
sequence is, over whatever shape the iris has.
"""

import numpy as np


def subsample_offsets(drawn, further):
    """Give every further place to the nearest sample that is drawn.

    Parameters
    ----------
    drawn : ndarray of shape (N, 2)
    further : ndarray of shape (M, 2)

    Returns
    -------
    offsets : ndarray of shape (N, K, 2)
        From each sample to its places, zero beyond their number.
    counts : ndarray of shape (N,)
        int; how many places each sample has.
    """
    nearest = np.empty(len(further), np.int64)
    # In pieces: the table of distances of 4096 samples and their subsamples would take gigabytes.
    for start in range(0, len(further), 1024):
        piece = further[start : start + 1024]
        distance = np.square(piece[:, None] - drawn[None]).sum(axis=2)
        nearest[start : start + 1024] = distance.argmin(axis=1)
    counts = np.bincount(nearest, minlength=len(drawn))
    order = np.argsort(nearest, kind="stable")
    owner = nearest[order]
    rank = np.arange(len(further)) - np.searchsorted(owner, owner)
    offsets = np.zeros((len(drawn), int(counts.max(initial=0)), 2))
    offsets[owner, rank] = further[order] - drawn[owner]
    return offsets, counts
