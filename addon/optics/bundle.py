"""Rays on their way through a lens: structure of arrays, changed in place.

Positions are in mm from the vertex of the surface at hand. Work is done in chunks that stay in the
cache, with two scratch arrays, so that no step of the trace allocates.
"""

import numpy as np


class Bundle:
    """Positions, unit directions and scratch of a chunk of rays.

    Parameters
    ----------
    origins, directions : ndarray of shape (N, 3)
        From which a chunk is copied; N at most what the bundle was made for.

    Attributes
    ----------
    x, y, z : ndarray of shape (N,)
        Positions, mm.
    l, m, n : ndarray of shape (N,)
        Direction cosines.
    cosine : ndarray of shape (N,)
        Between ray and surface normal after a surface was met; negative for rays towards -z.
    slant : ndarray of shape (N,)
        z of the unit normal after a sphere was met.
    a, b : ndarray of shape (N,)
        Scratch.
    rows : ndarray of int or None
        Which rays of the chunk these are; None while all are on their way.
    """

    NAMES = ("x", "y", "z", "l", "m", "n")
    SCRATCH = ("cosine", "slant", "a", "b")
    __slots__ = ("_buffers", "rows", *NAMES, *SCRATCH)

    def __init__(self, origins, directions):
        self._buffers = np.empty((len(self.NAMES) + len(self.SCRATCH), len(origins)))
        self.load(origins, directions)

    @property
    def count(self):
        """How many rays are on their way."""
        return len(self.x)

    def load(self, origins, directions):
        """Take a chunk of rays."""
        self.rows = None
        self._resize(len(origins))
        for axis, (position, direction) in enumerate(zip("xyz", "lmn", strict=True)):
            getattr(self, position)[:] = origins[:, axis]
            getattr(self, direction)[:] = directions[:, axis]

    def keep(self, chosen):
        """Go on with some of the rays.

        Parameters
        ----------
        chosen : ndarray of bool, shape (N,)
        """
        at = np.flatnonzero(chosen)
        kept = [getattr(self, name)[at] for name in (*self.NAMES, "cosine", "slant")]
        self.rows = at if self.rows is None else self.rows[at]
        self._resize(len(at))
        for name, values in zip((*self.NAMES, "cosine", "slant"), kept, strict=True):
            getattr(self, name)[:] = values

    def approach(self):
        """Move every ray to the point of its line that is nearest to the vertex.

        This needs no division, so it also serves rays along the vertex plane, and takes the
        rounding of a far origin out of all that follows.
        """
        x, y, z, l, m, n, a, b = self.x, self.y, self.z, self.l, self.m, self.n, self.a, self.b  # noqa: E741
        np.multiply(x, l, out=a)
        a += np.multiply(y, m, out=b)
        a += np.multiply(z, n, out=b)
        np.negative(a, out=a)
        self.advance(a)

    def advance(self, distance):
        """Move every ray along its direction; overwrites scratch `b`."""
        b = self.b
        self.x += np.multiply(distance, self.l, out=b)
        self.y += np.multiply(distance, self.m, out=b)
        self.z += np.multiply(distance, self.n, out=b)

    def radius_squared(self):
        """Return x^2 + y^2, in scratch `a`."""
        np.multiply(self.x, self.x, out=self.a)
        self.a += np.multiply(self.y, self.y, out=self.b)
        return self.a

    def _resize(self, count):
        for name, buffer in zip((*self.NAMES, *self.SCRATCH), self._buffers, strict=True):
            setattr(self, name, buffer[:count])
