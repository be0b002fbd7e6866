"""Evenly spaced nodes over the field of a picture."""

from dataclasses import dataclass

import numpy as np

# Nodes along the picture's longer side.
_COLUMNS = 49


@dataclass(frozen=True, eq=False)
class FieldGrid:
    """Nodes over a rectangle of the field.

    Parameters
    ----------
    low, high : ndarray of shape (2,)
        Corners, as tangents.
    columns, rows : int
    """

    low: np.ndarray
    high: np.ndarray
    columns: int
    rows: int

    @property
    def nodes(self):
        """Places, shape (rows * columns, 2)."""
        x = np.linspace(self.low[0], self.high[0], self.columns)
        y = np.linspace(self.low[1], self.high[1], self.rows)
        return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)

    def taps(self, places):
        """Return indices and weights of linear interpolation, shape (P, 4) each."""
        size = np.array([self.columns, self.rows])
        at = (places - self.low) / (self.high - self.low) * (size - 1)
        at = np.clip(at, 0.0, size - 1.0)
        cell = np.minimum(at.astype(int), size - 2)
        x, y = np.moveaxis(at - cell, -1, 0)
        first = cell[..., 1] * self.columns + cell[..., 0]
        index = np.stack([first, first + 1, first + self.columns, first + self.columns + 1], -1)
        weights = np.stack([(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y], -1)
        return index, weights

    def padded(self, nodes):
        """Return the grid with some more nodes on each side."""
        step = (self.high - self.low) / (self.columns - 1, self.rows - 1)
        low, high = self.low - nodes * step, self.high + nodes * step
        return FieldGrid(low, high, self.columns + 2 * nodes, self.rows + 2 * nodes)


def field_grid(low, high, margin=0.0):
    """Return a grid over a rectangle, wider by a share of its sides.

    Parameters
    ----------
    low, high : sequence of 2 float
    margin : float

    Returns
    -------
    FieldGrid
    """
    low, high = np.asarray(low, float), np.asarray(high, float)
    wider = margin * (high - low)
    low, high = low - wider, high + wider
    width, height = high - low
    short = max(int(np.ceil((_COLUMNS - 1) * min(width, height) / max(width, height))) + 1, 5)
    size = (_COLUMNS, short) if width >= height else (short, _COLUMNS)
    return FieldGrid(low, high, *size)
