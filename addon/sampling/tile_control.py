"""Where a picture needs more lens samples, and when it has enough (methods 1, 6).

The picture of `n` samples is compared with that of about half as many, `m`, tile by tile. If the
variance of the error falls as ``n^-p``, the variance of the difference is

    D = e(m) - e(n) = e(n) ((n / m)^p - 1),  so  e(n) = D / ((n / m)^p - 1):

the difference tells the error that is left. Samples drawn at random have ``p = 1``. Evenly spread
ones, whose mean is better than that of as many independent ones, have up to ``p = 1.5`` at edges;
so the power is not assumed but found, from how the differences themselves fell from one doubling
to the next.

A tile is done when its error is at most the number that was asked for, the picture when the mean of
all tiles is. Of a picture whose first samples are far better than that, such as a few lamps before
a plain wall, the mean tells nothing about the places that matter: there the mean is that of the
tiles that were not good enough at first. (Not the worst of them: what is asked of a picture full
of things is no more.)
"""

import numpy as np

# Side of a tile, px: wider than the window of the structural similarity (11 px).
TILE = 16
# Between random and even samples, see above; counts as much as so many observed doublings, each of
# which tells the power to within about a half.
_USUAL_POWER, _USUAL_WEIGHT = 1.25, 8.0
# Nothing falls slower than with random samples, nor faster than with even ones.
_LEAST_POWER, _MOST_POWER = 1.0, 1.5
# Aims below the number: a picture is stopped when its error looks small, which is more often by
# chance than not.
_AIM = 0.93
# Of a picture that the fewest samples bring to this share of the number, only the tiles that are
# above it then are judged.
_PLAIN_SHARE = 0.5
# Of a comparison with half the samples; the rest is that of one with more of them.
HALF_SHARE = 0.7
# Of what a look measures; the rest is what the one before let expect.
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
        # What the mean that decides is taken over.
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
        """Number of tiles whose error is above the number; None if it is not known."""
        return None if self.errors is None else int((self.errors > self.target).sum())

    def mean(self, values):
        """Return the mean of a value of each tile over the pixels of the picture."""
        return float((values * self._share).sum())

    def rest(self, samples, before):
        """Return variance of the error of `samples` over that of its change since `before`."""
        return 1.0 / ((samples / before) ** self.power - 1.0)

    def observe(self, samples, before, changes):
        """Learn how fast the error falls.

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
        """Choose the tiles that go on.

        Parameters
        ----------
        samples : int
            Drawn so far for the active tiles.
        errors : ndarray of shape (rows, columns)
            Measured; those of tiles that are not active do not count.
        following : int
            Samples at which it is decided again.
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
        """Let only some tiles decide when the picture is done."""
        share = self._share * tiles
        self._judged = share / max(share.sum(), 1e-30)

    def _narrow(self, factor):
        """Stop the tiles that are good enough, as far as the picture comes to its number so."""
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
        # As many more tiles, the worst first, as bring the picture to its number at the next look:
        # a few tiles that go on for long cost more than many that go on for a little.
        rest = np.flatnonzero(self.active & ~wanted)
        order = rest[np.argsort(-self.errors.ravel()[rest], kind="stable")]
        gained = np.cumsum((1.0 - factor) * (self.errors * self._judged).ravel()[order])
        count = int(np.searchsorted(gained, error_with(wanted) - aim)) + 1
        chosen = wanted.copy()
        chosen.ravel()[order[:count]] = True
        return chosen


def smoothed(errors):
    """Return the mean of each tile and its neighbours, weighted 1 2 1 in rows and columns.

    A tile has a dozen windows: too few to tell its own error well.
    """
    padded = np.pad(errors, 1, mode="edge")
    rows = 0.25 * (padded[:-2] + padded[2:]) + 0.5 * padded[1:-1]
    return 0.25 * (rows[:, :-2] + rows[:, 2:]) + 0.5 * rows[:, 1:-1]


def grown(tiles):
    """Return which tiles are chosen or touch one that is."""
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
