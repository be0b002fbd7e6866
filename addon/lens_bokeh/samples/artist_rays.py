"""An artist's lens for lens samples: its formulas over the field, as sums of `disc_terms`."""

from dataclasses import dataclass

import numpy as np

from ..tables.artist_lens import ArtistLens
from .disc_terms import disc_orders, disc_terms
from .landing import spread_places

# The nearest point is so many times as near as the focus; nearer ones go on as they went.
_NEAREST = 4.0
# Fields so many times as far out as the picture's corner move as those there.
_FARTHEST = 4.0
_DEGREE = 3
_PLACES = 32
_ORDERS = disc_orders(_DEGREE)


@dataclass(frozen=True)
class ArtistRays:
    """Rays of an artist's lens for `sample_tables`; what `LensRays` is for a traced one.

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
    """

    lens: ArtistLens
    opening: float
    corner: float
    aperture_radius: float
    focus_vergence: float

    stretch = 1.0
    of_revolution = True
    last_seen = np.inf
    parts_colors, colors = False, None
    loses_light = False
    most_light = 1.0

    @property
    def orders(self):
        """Of the `disc_terms`."""
        return _ORDERS

    @property
    def largest_vergence(self):
        """1/m."""
        return _NEAREST * self.focus_vergence

    @property
    def farthest(self):
        """The farthest field that is looked at, as a tangent."""
        return _FARTHEST * self.corner

    def places_shown(self, fields):
        """Return where fields are shown in focus; as of `LensRays`."""
        return fields

    def moves(self, nodes):
        """Lay out the aberrations over places of the field; as of `LensRays`."""
        size = np.hypot(*nodes.T)
        away = nodes / np.maximum(size, 1e-30)[:, None]
        away[size == 0.0] = (0.0, 1.0)
        across = np.stack([away[:, 1], -away[:, 0]], axis=-1)
        places = spread_places(_PLACES)
        solve = np.linalg.pinv(disc_terms(self.orders, places).reshape(_PLACES, -1))
        frames = np.stack([across, away], axis=1)
        local = np.einsum("pc,nfc->fnp", places, frames)
        shares = (size / self.corner)[:, None]
        moved, squeeze = self.lens.moves(shares, local, self.opening)
        moved = moved * (self.corner / self.aperture_radius)
        # The thin lens' own shear, away from the axis: q (Vf - V).
        less = np.stack([np.zeros_like(local[1]), -squeeze * local[1]])
        parts = moved + less * self.focus_vergence, less * -self.largest_vergence
        found = np.zeros((len(solve), len(nodes), 4, 2))
        for power, part in enumerate(parts):
            found[:, :, power] = np.einsum("tp,fnp,nfc->tnc", solve, part, frames, optimize=True)
        return found, np.zeros((len(nodes), 4, 2))

    def light_and_rims(self, nodes):
        """Lay out the light, which is even, and no rims; as of `LensRays`."""
        found = np.zeros((1, 2 * len(self.orders), len(nodes)))
        found[0, 0] = 1.0
        return found
