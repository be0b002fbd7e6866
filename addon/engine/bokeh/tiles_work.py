"""Making the tiles of a lens a step at a time, or all at once."""


class TilesWork:
    """Tiles that are made in steps, and kept.

    Parameters
    ----------
    begin : callable
        Returns a generator that makes them, and returns what `whole` does.
    """

    def __init__(self, begin):
        self._begin = begin
        self._steps = self._result = None

    def step(self):
        """Take a step; return whether there are more."""
        if self._result is not None:
            return False
        # After an error it begins anew.
        self._steps = self._steps or self._begin()
        try:
            next(self._steps)
        except StopIteration as end:
            self._result, self._steps = end.value, None
            return False
        except Exception:
            self._steps = None
            raise
        return True

    def whole(self):
        """Take all steps that are left.

        Returns
        -------
        tiles : PupilTiles
        w_range : tuple of 2 float
            Of the first and last depth.
        soft : float
            c0 over the circle of confusion of infinity.
        """
        while self.step():
            pass
        return self._result
