"""Beams of an artist's lens, for tiles of its discs: as `PupilBeams`, without tracing.

Lengths are tangents; the middle of the iris lands where a pinhole has the point.
"""

import numpy as np

from ..tables.artist_lens import ArtistLens
from .pupil_beams import FIELDS
from .tile_drawing import RAYS, HalfGrid


class ArtistBeams:
    """Beams of an artist's lens over field and vergence.

    Parameters
    ----------
    lens : ArtistLens
    opening : float
        See `tables.artist_lens.opening_at`.
    corner : float
        Tangent of the field at the picture's corner.
    aperture_radius : float
        m.
    focus_vergence : float
        1/m.
    largest_tangent : float
        Of the field that is wanted.
    """

    def __init__(
        self, lens: ArtistLens, opening, corner, aperture_radius, focus_vergence, largest_tangent
    ):
        self.tangents = np.linspace(0.0, largest_tangent, FIELDS)
        self._lens, self._opening, self._corner = lens, opening, corner
        self._radius, self._focus = aperture_radius, focus_vergence
        axis = ((np.arange(RAYS) + 0.5) / RAYS * 2.0 - 1.0).astype(np.float32)
        self._y, self._x = np.meshgrid(axis, axis[RAYS // 2 :], indexing="ij")
        self._weight = np.ones_like(self._x)

    @property
    def softness(self):
        """Largest of the patterns in focus: half its width, a tangent."""
        grids = (self.grids(field, [self._focus], 0.0)[0][0] for field in range(FIELDS))
        return max(max(grid.bounds()[1:]) for grid in grids)

    def distorted(self, _shift, _vergence):
        """Return what bends straight lines, as `PupilBeams` does: nothing."""
        return None

    def grids(self, field, vergences, _shift, _distorted=None):
        """Return the rays of a field's beams, and where those through the middle land.

        Parameters
        ----------
        field : int
        vergences : sequence of float
            1/m.

        Returns
        -------
        grids : list of HalfGrid
        centers : ndarray of shape (V,)
        """
        share = float(self.tangents[field]) / self._corner
        place = np.stack([self._x, self._y])
        moves, squeeze = self._lens.moves(share, place, self._opening)
        grids = []
        for vergence in vergences:
            thin = self._radius * (self._focus - float(vergence))
            x = self._x * thin + moves[0] * self._corner
            y = self._y * (thin * (1.0 - squeeze)) + moves[1] * self._corner
            # As of a traced lens, whose stop is seen from the sensor.
            grids.append(HalfGrid(x, y, -self._x, -self._y, (), self._weight))
        return grids, np.zeros(len(grids))
