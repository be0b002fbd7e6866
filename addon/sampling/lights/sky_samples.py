"""Directions of a world, chosen by its light (**ours**).

Every other direction is that of a texel of the world's image, drawn in proportion to its light
and solid angle; the others are spread evenly, so that surfaces that face away from the brightest
part of the sky are lit by some, too. What a direction stands for is the texel's light over the
density of directions there.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

# Share of the directions that are spread evenly.
_EVEN = 0.5


@dataclass(frozen=True, eq=False)
class Sky:
    """The light of a world.

    Parameters
    ----------
    pixels : ndarray of shape (height, width, 3)
        Equirectangular, Blender's mapping, first row at the bottom.
    rotation : ndarray of shape (3, 3)
        From world directions to the image's.
    """

    pixels: np.ndarray
    rotation: np.ndarray

    @cached_property
    def _solid_angles(self):
        height, width = self.pixels.shape[:2]
        edges = np.sin((np.arange(height + 1) / height - 0.5) * np.pi)
        return np.repeat(np.diff(edges)[:, None] * (2.0 * np.pi / width), width, axis=1)

    @cached_property
    def _shares(self):
        """Probability of each texel where directions follow the light."""
        light = np.abs(self.pixels).mean(axis=2) * self._solid_angles
        total = light.sum()
        return light / total if total > 0.0 else self._solid_angles / (4.0 * np.pi)

    @property
    def irradiance(self):
        """Mean of the channels of the light that a surface gets from half of the sky, W/m^2."""
        return float((np.abs(self.pixels).mean(axis=2) * self._solid_angles).sum() / 4.0)

    def directions(self, u, follows):
        """Return directions and what they stand for.

        Parameters
        ----------
        u : ndarray of shape (N, 2)
            From 0 to 1.
        follows : bool
            They follow the light; else they are spread evenly.

        Returns
        -------
        directions : ndarray of shape (N, 3)
            In world space, unit length, towards the sky.
        light : ndarray of shape (N, 3)
            Radiance over the density of directions of both kinds.
        """
        height, width = self.pixels.shape[:2]
        if follows:
            rows = self._shares.sum(axis=1)
            row, y = _draw(np.cumsum(rows)[None], u[:, 1])
            column, x = _draw(np.cumsum(self._shares, axis=1)[row], u[:, 0])
            sines = np.sin((np.stack([row, row + 1]) / height - 0.5) * np.pi)
            z = sines[0] + (sines[1] - sines[0]) * y
            x = column + x
        else:
            z = 2.0 * u[:, 1] - 1.0
            x = width * u[:, 0]
            row = ((np.arcsin(z) / np.pi + 0.5) * height).astype(int).clip(0, height - 1)
            column = x.astype(int).clip(0, width - 1)
        around = (0.5 - x / width) * 2.0 * np.pi
        across = np.sqrt(np.maximum(1.0 - z * z, 0.0))
        local = np.column_stack([across * np.cos(around), across * np.sin(around), z])
        density = (self._shares / self._solid_angles)[row, column]
        density = _EVEN / (4.0 * np.pi) + (1.0 - _EVEN) * density
        return local @ self.rotation, self.pixels[row, column] / density[:, None]


def _draw(sums, u):
    """Return the step of cumulated probabilities in which each number falls, and where in it."""
    wanted = u * sums[:, -1]
    step = np.minimum((sums <= wanted[:, None]).sum(axis=1), sums.shape[1] - 1)
    rows = np.arange(len(u)) if len(sums) > 1 else np.zeros(len(u), int)
    high = sums[rows, step]
    low = np.where(step > 0, sums[rows, np.maximum(step - 1, 0)], 0.0)
    return step, np.clip((wanted - low) / np.maximum(high - low, 1e-30), 0.0, 1.0)
