"""Directions of a world, chosen by its light (**ours**).

A texel of the world's image is drawn in proportion to its light and solid angle; what a direction
stands for is the texel's light over the density of directions there.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

# Share of the directions that are spread evenly whatever the light: colours of little luminance and
# the interpolation between texels have light where the texels' luminance has none.
_EVEN = 0.05
# Rows and columns of the table of normals.
NORMALS = 32


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
        """Probability of each texel."""
        light = np.abs(self.pixels).mean(axis=2) * self._solid_angles
        total = light.sum()
        even = self._solid_angles / (4.0 * np.pi)
        return _EVEN * even + (1.0 - _EVEN) * light / total if total > 0.0 else even

    @property
    def irradiance(self):
        """Mean of the channels of the light that a surface gets from half of the sky, W/m^2."""
        return float((np.abs(self.pixels).mean(axis=2) * self._solid_angles).sum() / 4.0)

    def directions(self, u):
        """Return directions and what they stand for.

        Parameters
        ----------
        u : ndarray of shape (N, 2)
            From 0 to 1.

        Returns
        -------
        directions : ndarray of shape (N, 3)
            In world space, unit length, towards the sky.
        light : ndarray of shape (N, 3)
            Radiance over the density of directions.
        """
        height, width = self.pixels.shape[:2]
        rows = self._shares.sum(axis=1)
        row, y = _draw(np.cumsum(rows)[None], u[:, 1])
        column, x = _draw(np.cumsum(self._shares, axis=1)[row], u[:, 0])
        sines = np.sin((np.stack([row, row + 1]) / height - 0.5) * np.pi)
        z = sines[0] + (sines[1] - sines[0]) * y
        around = (0.5 - (column + x) / width) * 2.0 * np.pi
        across = np.sqrt(np.maximum(1.0 - z * z, 0.0))
        local = np.column_stack([across * np.cos(around), across * np.sin(around), z])
        density = (self._shares / self._solid_angles)[row, column]
        return local @ self.rotation, self.pixels[row, column] / density[:, None]

    @cached_property
    def _diffuse(self):
        """Light of a white Lambertian surface of each normal of the table, shape (n, n, 3)."""
        height, width = self.pixels.shape[:2]
        z = np.sin(((np.arange(height) + 0.5) / height - 0.5) * np.pi)[:, None]
        around = (0.5 - (np.arange(width) + 0.5) / width) * 2.0 * np.pi
        across = np.sqrt(1.0 - z * z)
        local = np.stack(
            np.broadcast_arrays(across * np.cos(around), across * np.sin(around), z), axis=-1
        )
        towards = local.reshape(-1, 3) @ self.rotation
        light = (self.pixels * self._solid_angles[..., None]).reshape(-1, 3)
        found = np.maximum(table_normals().reshape(-1, 3) @ towards.T, 0.0) @ light / np.pi
        return found.reshape(NORMALS, NORMALS, 3)

    def corrections(self, directions, light):
        """Return what a set of directions must be multiplied with to give the light of all.

        Parameters
        ----------
        directions, light : ndarray of shape (N, 3)
            As of `directions`.

        Returns
        -------
        ndarray of shape (n, n)
            By normal, `table_normals`: the light of a white surface under the whole sky over that
            under these directions, by luminance.
        """
        cosines = np.maximum(table_normals() @ directions.T, 0.0)
        found = (cosines @ light).mean(axis=2) / (np.pi * len(directions))
        whole = self._diffuse.mean(axis=2)
        ratio = np.divide(whole, found, out=np.ones_like(whole), where=np.abs(found) > 1e-12)
        return np.clip(ratio, 0.0, 4.0)


def _draw(sums, u):
    """Return the step of cumulated probabilities in which each number falls, and where in it."""
    wanted = u * sums[:, -1]
    step = np.minimum((sums <= wanted[:, None]).sum(axis=1), sums.shape[1] - 1)
    rows = np.arange(len(u)) if len(sums) > 1 else np.zeros(len(u), int)
    high = sums[rows, step]
    low = np.where(step > 0, sums[rows, np.maximum(step - 1, 0)], 0.0)
    return step, np.clip((wanted - low) / np.maximum(high - low, 1e-30), 0.0, 1.0)


def table_normals():
    """Return the normals of the table, shape (n, n, 3): an octahedral map, nodes at its edges."""
    place = np.linspace(-1.0, 1.0, NORMALS)
    x, y = np.meshgrid(place, place)
    z = 1.0 - np.abs(x) - np.abs(y)
    below = z < 0.0
    turned_x = np.where(x >= 0.0, 1.0, -1.0) * (1.0 - np.abs(y))
    turned_y = np.where(y >= 0.0, 1.0, -1.0) * (1.0 - np.abs(x))
    normals = np.stack([np.where(below, turned_x, x), np.where(below, turned_y, y), z], axis=-1)
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)
