"""Rays on their way through a lens: structure of arrays, changed in place.

Positions are in mm from the vertex of the surface at hand. Directions are optical: unit vector
times index of the medium, so that refraction adds a multiple of the surface normal, and nothing
else. Work is done in chunks that stay in the cache, with scratch arrays, so that no step of the
trace allocates.
"""

import numpy as np

# Rows of the buffer, by attribute. Pairs lie together, so that one call serves both.
POSITION, DIRECTION = ("x", "y", "z"), ("l", "m", "n")
ROWS = (*POSITION, *DIRECTION, "cosine", "square", "slant", "a", "b", "c")
KEPT = ROWS[:9]


class Bundle:
    """Positions, directions and scratch of a chunk of rays.

    Parameters
    ----------
    origins, directions : ndarray of shape (N, 3)
        From which a chunk is copied; directions are unit vectors.
    index : float
        Of the medium that the rays are in.

    Attributes
    ----------
    x, y, z : ndarray of shape (N,)
        Positions, mm.
    l, m, n : ndarray of shape (N,)
        Direction cosines times index.
    xy, lm : ndarray of shape (2, N)
        The same x, y and l, m.
    cosine, square : ndarray of shape (N,)
        Index times cosine between ray and surface normal after a surface was met, negative for
        rays towards -z; and its square.
    slant : ndarray of shape (N,)
        z of the unit normal after a sphere was met.
    a, b : ndarray of shape (N,)
        Scratch.
    bc : ndarray of shape (2, N)
        Scratch, of which b is the first row.
    rows : ndarray of int or None
        Indices of these rays in the chunk; None while all of it is being traced.
    """

    __slots__ = ("_buffer", "bc", "index", "lm", "rows", "xy", *ROWS)

    def __init__(self, origins, directions, index=1.0):
        self._buffer = np.empty((len(ROWS), len(origins)))
        self.load(origins, directions, index)

    @property
    def count(self):
        """Number of rays that are being traced."""
        return len(self.x)

    def load(self, origins, directions, index=1.0):
        """Take another chunk of rays, at most as many as the first."""
        self.rows = None
        self.index = index
        self._resize(len(origins))
        for axis, (position, direction) in enumerate(zip(POSITION, DIRECTION, strict=True)):
            getattr(self, position)[:] = origins[:, axis]
            np.multiply(directions[:, axis], index, out=getattr(self, direction))

    def keep(self, chosen):
        """Keep some of the rays.

        Parameters
        ----------
        chosen : ndarray of bool, shape (N,)
        """
        at = np.flatnonzero(chosen)
        kept = [getattr(self, name)[at] for name in KEPT]
        self.rows = at if self.rows is None else self.rows[at]
        self._resize(len(at))
        for name, values in zip(KEPT, kept, strict=True):
            getattr(self, name)[:] = values

    def state(self, places):
        """Return positions in mm and unit directions of some rays.

        Parameters
        ----------
        places : ndarray of int, shape (K,)

        Returns
        -------
        positions, directions : ndarray of shape (K, 3)
        """
        block = self._buffer[: len(POSITION) + len(DIRECTION), places].T
        return block[:, :3], block[:, 3:] / self.index

    def park(self, places):
        """Put rays that have ended on the axis, where they meet every surface without error.

        Parameters
        ----------
        places : ndarray of int
        """
        self.xy[:, places] = 0.0
        self.lm[:, places] = 0.0
        self.n[places] = np.copysign(self.index, self.n[places])
        self.cosine[places] = self.n[places]
        self.square[places] = self.index * self.index
        self.slant[places] = 1.0

    def approach(self):
        """Move every ray to the point of its line that is nearest to the vertex.

        That also works for rays along the vertex plane, and avoids the rounding errors of a far
        origin in all further steps.
        """
        self.sideways(self.a)
        self.a += np.multiply(self.z, self.n, out=self.b)
        self.a *= -1.0 / (self.index * self.index)
        self.advance(self.a)

    def advance(self, distance):
        """Move every ray along its direction, by mm over index."""
        self.xy += np.multiply(distance, self.lm, out=self.bc)
        self.z += np.multiply(distance, self.n, out=self.b)

    def sideways(self, out):
        """Put x l + y m into `out`."""
        np.multiply(self.xy, self.lm, out=self.bc)
        np.add(self.b, self.c, out=out)

    def radius_squared(self):
        """Return x^2 + y^2, in scratch `a`."""
        np.multiply(self.xy, self.xy, out=self.bc)
        return np.add(self.b, self.c, out=self.a)

    def _resize(self, count):
        for row, name in enumerate(ROWS):
            setattr(self, name, self._buffer[row, :count])
        self.xy, self.lm = self._buffer[0:2, :count], self._buffer[3:5, :count]
        self.bc = self._buffer[-2:, :count]
