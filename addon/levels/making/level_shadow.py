"""The shadow of a mesh: how much of a picture it covers, whichever way it is seen.

A blur spreads the light of a surface but does not change its sum. What a level of detail covers
less than the full mesh, such as wires that have grown thinner or holes that have closed, is light
that is missing, or too much, at any blur. It is counted in rasters along a few directions.
"""

import numpy as np

# Largest relative changes of what a level covers, and with it of its light: of all views together,
# and on average of a view.
_MOST_CHANGE = 0.01
_MOST_CHANGE_OF_VIEWS = 0.03
# Views: spread over half a sphere, none along an axis, where meshes have much in one plane.
_VIEWS = 6
# Texels along the longest diagonal: the area of bodies is counted to 0.1 %, of thin wires to 0.3 %.
_TEXELS = 128
# Most texels of the boxes around triangles that are looked at for one view; a raster with more is
# coarser.
_MOST_TESTS = 1 << 21
_LEAST_TEXELS = 16
# Tests at once, to bound memory.
_AT_ONCE = 1 << 18


def covering(mesh, levels):
    """Return how many levels of a mesh cover as much as it does.

    Parameters
    ----------
    mesh : MeshSnapshot
        At full detail.
    levels : sequence of MeshSnapshot
        From level 1 up.

    Returns
    -------
    int
        Those up to the first that does not.
    """
    shadow = Shadow(mesh)
    for number, level in enumerate(levels):
        overall, of_views = shadow.changes(level)
        if overall > _MOST_CHANGE or of_views > _MOST_CHANGE_OF_VIEWS:
            return number
    return len(levels)


class Shadow:
    """Measures how much less, or more, levels of a mesh cover.

    Parameters
    ----------
    mesh : MeshSnapshot
        At full detail.
    """

    def __init__(self, mesh):
        used = mesh.positions[mesh.triangles.ravel()] if len(mesh.triangles) else np.zeros((1, 3))
        low, high = used.min(axis=0).astype(np.float64), used.max(axis=0).astype(np.float64)
        self._middle = (low + high) / 2.0
        self._reach = max(float(np.linalg.norm(high - low)), 1e-300)
        self._planes = [_plane(number) for number in range(_VIEWS)]
        self._texels = [self._affordable(mesh, plane) for plane in self._planes]
        self._covered = self._shadows(mesh)

    def changes(self, level):
        """Return by how much a level covers more or less than the mesh, relative to that.

        Parameters
        ----------
        level : MeshSnapshot

        Returns
        -------
        overall, each : float
            Change of the sum over all views, and mean change of a view, both without sign: what
            many loose parts cover varies from view to view as they become fewer.
        """
        changes = self._shadows(level) - self._covered
        whole = max(float(self._covered.sum()), 1e-300)
        return abs(float(changes.sum())) / whole, float(np.abs(changes).sum()) / whole

    def _shadows(self, mesh):
        """Return the share of each view's raster that a mesh covers, shape (views,)."""
        return np.array(
            [
                _covered(self._seen(mesh, plane, texels), texels)
                for plane, texels in zip(self._planes, self._texels, strict=True)
            ]
        )

    def _seen(self, mesh, plane, texels):
        """Return the corners of triangles in a raster: x of each corner, then y of each."""
        places = (mesh.positions.astype(np.float64) - self._middle) @ plane
        places = places * (texels / self._reach) + 0.5 * texels
        return [[axis[corner] for corner in mesh.triangles.T] for axis in places.T.copy()]

    def _affordable(self, mesh, plane):
        boxes = [_between(axis) for axis in self._seen(mesh, plane, _TEXELS)]
        tests = float(np.prod([size for _, size in boxes], axis=0, dtype=np.float64).sum())
        finest = int(_TEXELS * np.sqrt(min(1.0, _MOST_TESTS / max(tests, 1.0))))
        return max(finest, _LEAST_TEXELS)


def _plane(number):
    """Return two vectors across a direction, shape (3, 2): a Fibonacci spiral of half a sphere."""
    z = (number + 0.5) / _VIEWS
    around = number * np.pi * (3.0 - np.sqrt(5.0)) + 0.7
    flat = np.sqrt(1.0 - z**2)
    axis = np.array([flat * np.cos(around), flat * np.sin(around), z])
    across = np.cross(axis, (0.3, 0.9, 0.2))
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(axis, across)], axis=1)


def _between(axis):
    """Return the first texel whose middle lies between the corners along an axis, and how many."""
    a, b, c = axis
    low = np.ceil(np.minimum(np.minimum(a, b), c) - 0.5)
    high = np.floor(np.maximum(np.maximum(a, b), c) - 0.5)
    return low.astype(np.int64), np.maximum(high - low + 1.0, 0.0).astype(np.int64)


def _covered(corners, texels):
    """Return the share of a raster that triangles cover, given in texels."""
    (left, width), (below, height) = (_between(axis) for axis in corners)
    count = width * height
    some = np.flatnonzero(count)
    left, width, below, count = left[some], width[some], below[some], count[some]
    across, up = ([corner[some] for corner in axis] for axis in corners)
    shadow = np.zeros(texels * texels, bool)
    ends = np.cumsum(count)
    first = 0
    while first < len(count):
        before = ends[first] - count[first]
        last = max(int(np.searchsorted(ends, before + _AT_ONCE, "right")), first + 1)
        part = slice(first, last)
        of = np.repeat(np.arange(first, last), count[part])
        k = np.arange(len(of)) - np.repeat(ends[part] - count[part] - before, count[part])
        x, y = left[of] + k % width[of], below[of] + k // width[of]
        turns = [
            (across[j][of] - across[i][of]) * (y + 0.5 - up[i][of])
            - (up[j][of] - up[i][of]) * (x + 0.5 - across[i][of])
            for i, j in ((0, 1), (1, 2), (2, 0))
        ]
        inside = (np.minimum.reduce(turns) >= 0.0) | (np.maximum.reduce(turns) <= 0.0)
        inside &= (x >= 0) & (x < texels) & (y >= 0) & (y < texels)
        shadow[y[inside] * texels + x[inside]] = True
        first = last
    return float(shadow.mean())
