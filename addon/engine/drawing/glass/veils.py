"""The order of what surfaces do to the picture of what is behind them."""

from ....passes.surface.draw import by_level


class Veils:
    """Draws over a picture of what is behind them: they filter it, or add light to it.

    Parameters
    ----------
    draws : list of passes.surface.draw.Draw
        Of `passes.surface.surface.build_veils`.

    Attributes
    ----------
    draws : list of Draw
    by_level : dict of (int, int) to list of Draw
    """

    def __init__(self, draws):
        self.draws = draws
        self.by_level = by_level(draws)

    def aim(self, centers, view):
        """Prepare a frame.

        Parameters
        ----------
        centers : ndarray of shape (I, 3)
            Of the rows of the table that is drawn, in world space.
        view : ndarray of shape (4, 4)
        """
        self._depths = -(centers @ view[2, :3] + view[2, 3])

    def in_order(self, listed):
        """Return draws in the order in which they are drawn, those behind others first.

        What is added is filtered by what is in front of it only; where all draws do the same, no
        order is needed.
        """
        if len({draw.part for draw in listed}) < 2:
            return listed
        rows = ((draw, slice(draw.first, draw.first + draw.count)) for draw in listed)
        depths = {id(draw): self._depths[there].mean() for draw, there in rows}
        return sorted(listed, key=lambda draw: -depths[id(draw)])
