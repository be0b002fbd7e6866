"""Pictures of irises for tests."""

import numpy as np


def heart(size=64):
    """Return a heart, upright, row 0 at the bottom, shape (size, size)."""
    y, x = (np.mgrid[:size, :size] + 0.5) * (2.6 / size) - 1.3
    y += 0.1
    return ((x * x + y * y - 1.0) ** 3 <= x * x * y**3).astype(float)
