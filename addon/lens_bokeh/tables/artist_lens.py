"""An artist's lens: aberrations by their strengths, without a prescription.

It is a thin lens whose rays miss by what Seidel's five sums make of them, without distortion, and
by a swirl. With the place q in the iris (in its radii), its part q_r away from the axis and q_t
around it, the share t of the field at the picture's corner, and the iris R over that of f/2,

    spherical      S R^3 |q|^2 q
    coma           C R^2 t (3 q_r^2 + q_t^2, 2 q_r q_t)
    astigmatism    A R t^2 (q_r, -q_t)
    curvature      F R t^2 q

are added to where a thin lens shows a point, in hundredths of the distance from the axis to the
corner: with a strength of 1, at f/2, a ray of the iris' rim lands that far away. Stopping down
makes them smaller, each with its own power, as of real lenses. The swirl makes what is out of focus
narrower towards the axis: by ``W t^2`` of its width, at most `MOST_SWIRL`. Light is not lost.
"""

from dataclasses import dataclass

import numpy as np

# Of the distance from the axis to the corner, at a strength of 1 and f/2.
UNIT = 0.01
_REFERENCE_F_NUMBER = 2.0
MOST_SWIRL = 0.85


@dataclass(frozen=True)
class ArtistLens:
    """Strengths of aberrations.

    Parameters
    ----------
    spherical : float
        Positive: rays through the rim of the iris are in focus nearer to the camera.
    coma : float
        Positive: tails point away from the middle of the picture.
    astigmatism : float
        Positive: what lies towards the corners is in focus nearer along the direction away from
        the middle, and farther around it.
    field_curvature : float
        Positive: the corners are in focus nearer to the camera.
    swirl : float
        0 to 1.
    """

    spherical: float = 0.0
    coma: float = 0.0
    astigmatism: float = 0.0
    field_curvature: float = 0.0
    swirl: float = 0.0

    @property
    def is_plain(self):
        """Whether it is a thin lens."""
        return not any(
            (self.spherical, self.coma, self.astigmatism, self.field_curvature, self.swirl)
        )

    def moves(self, share, place, opening):
        """Where rays land beside a thin lens', for a point above the axis.

        Parameters
        ----------
        share : float or ndarray, broadcast to place[0]
            t of the point.
        place : ndarray of shape (2, ...)
            In the iris, in its radii: across, and away from the axis.
        opening : float
            R.

        Returns
        -------
        moves : ndarray of shape (2, ...)
            Across and away, over the distance from the axis to the corner.
        squeeze : as share
            Share by which what the thin lens moves away from the axis is less.
        """
        across, away = place
        square = across**2 + away**2
        spherical = UNIT * self.spherical * opening**3 * square
        coma = UNIT * self.coma * opening**2 * share
        field = UNIT * opening * share**2
        found = (
            across * (spherical + field * (self.field_curvature - self.astigmatism))
            + coma * 2.0 * away * across,
            away * (spherical + field * (self.field_curvature + self.astigmatism))
            + coma * (3.0 * away**2 + across**2),
        )
        return np.stack(found), np.minimum(self.swirl * share**2, MOST_SWIRL)


def opening_at(f_number):
    """Return the iris at an f-number over that at f/2."""
    return _REFERENCE_F_NUMBER / f_number
