"""The noise threshold: which tiles of a picture need more lens samples, and when it has enough.

The picture of `n` samples is compared with that of about half as many, `m`, tile by tile. If the
variance of the error falls as ``n^-p``, the variance of the difference is

    D = e(m) - e(n) = e(n) ((n / m)^p - 1),  so  e(n) = D / ((n / m)^p - 1):

the difference gives the error that is left. Independent random samples have ``p = 1``. Low
discrepancy samples, whose mean is better than that of as many independent ones, have up to
``p = 1.5`` at edges; so the power is not assumed but estimated, from how the differences fell from
one doubling to the next.

A tile is done when its error is at most the threshold, the picture when the mean of all tiles is.
Where the mean is far below the threshold after the first samples, as with a few lamps before a
plain wall, it says nothing about the tiles that matter: then the mean is taken over the tiles that
were above the threshold at first. (Not their maximum: a picture that is full of detail is only held
to a mean, too.)
"""

import numpy as np

# Side of a tile, px: wider than the window of the structural similarity (11 px).
TILE = 16
# Prior of the power `p`, between random and low-discrepancy samples, and its weight in observed
# doublings, each of which gives the power to within about a half.
_USUAL_POWER, _USUAL_WEIGHT = 1.25, 8.0
# Bounds of the power: that of random samples, and that of low-discrepancy samples at edges.
_LEAST_POWER, _MOST_POWER = 1.0, 1.5
# Factor of the threshold that is aimed at: a picture stops when its estimated error is small, which
# selects estimates that are too small by chance.
_AIM = 0.93
# Where the first estimate is at most this share of the threshold, only the tiles above the
# threshold decide when the picture is done.
_PLAIN_SHARE = 0.5
# Weight of the comparison with half of the samples; the rest is that of the one with more samples.
HALF_SHARE = 0.7
# Weight of a measurement; the rest is that of the error expected from the measurement before.
_NEW_SHARE = 0.7


class TileControl:
    """Decides tile by tile whether sampling goes on.

    Parameters
    ----------
    target : float
        Error of the picture, 1 - SSIM.
    width, height : int
        Of the picture, px.
    least, most : int
        Samples below which no tile stops, and at which all do.

    Attributes
    ----------
    active : ndarray of shape (rows, columns)
        bool; tiles that the next samples are drawn for. Rows from the bottom.
    errors : ndarray of shape (rows, columns) or None
        Estimated error of each tile; None until two pictures could be compared.
    done : bool
    """

    def __init__(self, target, width, height, least, most):
        self.target = target
        self._least, self._most = least, most
        across, up = (
            np.minimum(TILE, size - TILE * np.arange(-(-size // TILE))) for size in (width, height)
        )
        self._share = np.outer(up, across) / (width * height)
        self.active = np.ones(self._share.shape, bool)
        self.errors = None
        self.done = False
        # The tiles whose mean error decides.
        self._judged = self._share
        self._changes = {}
        self._ratios = []
        self._samples = 0

    @property
    def shape(self):
        """Rows and columns of tiles."""
        return self._share.shape

    @property
    def power(self):
        """The power by which the error's variance falls with the samples."""
        count = len(self._ratios)
        power = (sum(self._ratios) + _USUAL_WEIGHT * _USUAL_POWER) / (count + _USUAL_WEIGHT)
        return min(max(power, _LEAST_POWER), _MOST_POWER)

    @property
    def error(self):
        """Estimated error of the picture, or None."""
        return None if self.errors is None else self.mean(self.errors)

    @property
    def left(self):
        """Number of tiles whose error is above the threshold; None if it is not known."""
        return None if self.errors is None else int((self.errors > self.target).sum())

    def mean(self, values):
        """Return the mean of a value of each tile over the pixels of the picture."""
        return float((values * self._share).sum())

    def rest(self, samples, before):
        """Return the variance of the error of `samples` over that of the change since `before`."""
        return 1.0 / ((samples / before) ** self.power - 1.0)

    def observe(self, samples, before, changes):
        """Update the estimate of the power by which the error falls.

        Parameters
        ----------
        samples, before : int
            Of the two pictures that were compared.
        changes : ndarray of shape (rows, columns)
            Variance of their difference; see `passes.picture_error`.
        """
        if samples != 2 * before:
            return
        earlier = self._changes.get(before)
        self._changes[samples] = changes
        if earlier is not None:
            weight = self._share * self.active
            was, now = (weight * earlier).sum(), (weight * changes).sum()
            if was > 0.0 and now > 0.0:
                self._ratios.append(float(np.log2(was / now)))

    def decide(self, samples, errors, following):
        """Choose the tiles for which sampling goes on.

        Parameters
        ----------
        samples : int
            Drawn so far for the active tiles.
        errors : ndarray of shape (rows, columns)
            Measured errors; those of inactive tiles are ignored.
        following : int
            Number of samples at the next decision.
        """
        measured = smoothed(errors)
        if self.errors is None:
            self.errors = measured
            if self.error <= _PLAIN_SHARE * self.target:
                self._judge(self.errors > self.target)
        else:
            expected = self.errors * (self._samples / samples) ** self.power
            self.errors = np.where(
                self.active, _NEW_SHARE * measured + (1.0 - _NEW_SHARE) * expected, self.errors
            )
        self._samples = samples
        good = (self.errors * self._judged).sum() <= _AIM * self.target
        if samples >= self._most or (samples >= self._least and good):
            self.active = np.zeros_like(self.active)
            self.done = True
        elif samples >= self._least:
            self._narrow((samples / following) ** self.power)

    def stop(self):
        """End sampling whatever the error is."""
        self.active = np.zeros_like(self.active)
        self.done = True

    def _judge(self, tiles):
        """Set the tiles whose mean error decides when the picture is done."""
        share = self._share * tiles
        self._judged = share / max(share.sum(), 1e-30)

    def _narrow(self, factor):
        """Stop the tiles below the threshold, as far as the picture still reaches it."""
        wanted = self.active & (self.errors > self.target)
        wanted = self._enough_to_finish(factor, wanted)
        # Neighbours go on with a tile: no step of the noise shows where it ends.
        self.active = self.active & grown(wanted)

    def _enough_to_finish(self, factor, wanted):
        aim = _AIM * self.target

        def error_with(chosen):
            return float((np.where(chosen, factor, 1.0) * self.errors * self._judged).sum())

        if error_with(wanted) <= aim or error_with(self.active) > aim:
            return wanted
        # So many more tiles, the worst first, that the picture is at the threshold at the next
        # look: a few tiles sampled for long cost more than many sampled for a little.
        rest = np.flatnonzero(self.active & ~wanted)
        order = rest[np.argsort(-self.errors.ravel()[rest], kind="stable")]
        gained = np.cumsum((1.0 - factor) * (self.errors * self._judged).ravel()[order])
        count = int(np.searchsorted(gained, error_with(wanted) - aim)) + 1
        chosen = wanted.copy()
        chosen.ravel()[order[:count]] = True
        return chosen


def smoothed(errors):
    """Return the mean of each tile and its neighbours, weighted 1 2 1 in rows and columns.

    A tile has a dozen windows: too few to estimate its own error well.
    """
    padded = np.pad(errors, 1, mode="edge")
    rows = 0.25 * (padded[:-2] + padded[2:]) + 0.5 * padded[1:-1]
    return 0.25 * (rows[:, :-2] + rows[:, 2:]) + 0.5 * rows[:, 1:-1]


def grown(tiles):
    """Return the chosen tiles dilated by one tile."""
    padded = np.pad(tiles, 1)
    rows = padded[:-2] | padded[1:-1] | padded[2:]
    return rows[:, :-2] | rows[:, 1:-1] | rows[:, 2:]


def runs(tiles):
    """Return the chosen tiles as rectangles of one row each.

    Parameters
    ----------
    tiles : ndarray of shape (rows, columns)
        bool.

    Returns
    -------
    ndarray of shape (R, 4)
        int; first column, row, column after the last, row + 1.
    """
    edges = np.diff(np.pad(tiles.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    row, first = np.nonzero(edges == 1)
    _, end = np.nonzero(edges == -1)
    return np.column_stack([first, row, end, row + 1])
