"""Squares of a picture with the disc of one lamp, against two pictures of a reference.

A square is just large enough for all that is brighter than a hundredth of the reference's maximum
in either picture, and two pixels more on each side. The peak of the PSNR is the reference's
maximum. ``psnr_db`` brings both squares to the same light first, ``psnr_raw_db`` leaves that out,
and ``energy`` tells the light over that of the reference.
"""

import math

import numpy as np

_LEAST, _BORDER = 0.01, 2


def compare_lamp(ours, references):
    """Compare the picture of a lamp with the mean of two references.

    Parameters
    ----------
    ours : ndarray of shape (n, n)
    references : sequence of 2 ndarray of shape (n, n)
        Of different seeds: their difference tells how much noise the mean has.

    Returns
    -------
    likeness : dict of str to float
        As the module says; the square's width and height are ``window``, and ``noise_db`` is the
        PSNR that the reference's own noise would have.
    pictures : tuple of 2 ndarray
        Ours and the mean.
    """
    mean = sum(references) / len(references)
    # Their difference has twice the noise of their mean.
    noise = _compare(*references)["psnr_raw_db"] + 20.0 * math.log10(2.0)
    return {**_compare(ours, mean), "noise_db": noise}, (ours, mean)


def save_sheets(study, name, pictures, kinds):
    """Save the pictures of lamps side by side, a file for each of both kinds.

    Parameters
    ----------
    study : object
        With ``save``, as that of `bench_bokeh`.
    name : str
        What the files' names begin with.
    pictures : list of tuple of 2 ndarray
        As of `compare_lamp`.
    kinds : tuple of 2 str
        What the files' names end with.
    """
    for number, kind in enumerate(kinds):
        study.save(f"{name}_{kind}", _sheet(pictures, number))


def _compare(ours, theirs):
    """Return what the module tells of two pictures, and the size of their square."""
    peak = theirs.max()
    seen = np.maximum(ours, theirs) > _LEAST * peak
    rows, columns = (np.flatnonzero(seen.any(axis=axis)) for axis in (1, 0))
    window = tuple(
        slice(max(part[0] - _BORDER, 0), part[-1] + _BORDER + 1) for part in (rows, columns)
    )
    ours, theirs = ours[window].astype(float), theirs[window].astype(float)
    energy = ours.sum() / theirs.sum()

    def psnr(test):
        return float(-10.0 * np.log10(np.mean(((test - theirs) / peak) ** 2) + 1e-30))

    return {
        "psnr_db": psnr(ours / energy),
        "psnr_raw_db": psnr(ours),
        "energy": float(energy),
        "window": [theirs.shape[1], theirs.shape[0]],
    }


def _sheet(pictures, number, columns=3):
    """Lay out one of each pair, with the light of the reference, whose brightest pixel is 1."""
    shown = [
        pair[number] * (pair[1].sum() / pair[number].sum() / pair[1].max()) for pair in pictures
    ]
    rows = [np.hstack(shown[i : i + columns]) for i in range(0, len(shown), columns)]
    return np.repeat(np.vstack(rows)[..., None], 3, axis=-1).astype(np.float32)
