"""Errors of a level of detail, and the blur that hides them, measured as the level is made.

A level's least-squares fit leaves errors whose mean over a few triangles is 0: a blur of diameter D
averages them over its area, and only the triangles that its rim cuts contribute. So an error e of
triangles with edges h shows as e (h / D)^1.5. A texture or an outline that is displaced by s shows
at its edges, as s / D of their contrast; displacements of different triangles are independent,
which leaves a factor of (h / D)^0.5. Squares of both add up over the levels, each with its own h.

References
----------
Garland and Heckbert, *Simplifying surfaces with color and texture using quadric error metrics*,
Visualization 1998: one error of place and attributes.
"""

from dataclasses import dataclass

import numpy as np

# Weight of an error of normals against one of colours: shading changes by less than the normal, and
# by a part of full light.
_SHADE_OF_NORMAL = 0.3
# Largest errors that do not show: of colours, and of displacements in diameters of the blur. Some
# times the standard deviation of a picture with 42 dB, as only a part of a picture has errors. On
# toys with colours of high contrast, levels then have 43.5 dB; with twice both values 40.8 dB, for
# a tenth less triangles.
_FAINT_COLOR = 0.015
_FAINT_MOVE = 0.02
# Weight of the displacement of an outline, which is seen on few pixels, against that of a texture.
_OUTLINE_SHARE = 0.25
# Edge of an equilateral triangle, in roots of its area.
_EDGE = 1.52


@dataclass(frozen=True)
class LevelErrors:
    """Errors of a level against full detail.

    Parameters
    ----------
    displacement : float
        Sum of s^2 h, in cubed units of the object; s: displacement of the surface and its texture,
        root mean square.
    color : float
        Sum of e^2 h^3; e: error of the vertex colours, scene linear, of the channel with the
        largest. Shading counts, too.
    """

    displacement: float = 0.0
    color: float = 0.0

    def __add__(self, other):
        """Return the accumulated errors of two successive levels."""
        return LevelErrors(self.displacement + other.displacement, self.color + other.color)

    @property
    def blur(self):
        """Diameter of the blur that hides the errors, in units of the object."""
        return self._hidden(self.color / _FAINT_COLOR**2 + self.displacement / _FAINT_MOVE**2)

    @property
    def blur_of_moves(self):
        """Diameter of the blur that hides the displacement alone, in units of the object."""
        return self._hidden(self.displacement / _FAINT_MOVE**2)

    @staticmethod
    def _hidden(volume):
        return float(np.cbrt(volume))


def edge_length(step):
    """Return about how long the edges of the new triangles are."""
    surface = float(step.surface.size.sum()) / 2.0
    return _EDGE * np.sqrt(surface / max(len(step.triangles), 1))


def moved_by_pairs(step):
    """Return the mean squared displacement of the surface by the merging of small parts."""
    if step.pairs is None:
        return 0.0
    return step.pair_moves / max(float(step.surface.size.sum()), 1e-300)


def is_coordinate(key):
    """Whether an attribute is a texture coordinate, and not a colour or a normal."""
    return key == "generated" or key.startswith("uv:")


class ErrorMeter:
    """Measures the errors of a level's attributes at the vertices of the level before.

    Each error is weighted with the edge length there: on flat parts edges are far longer than the
    mean.

    Parameters
    ----------
    step : Step
    positions : ndarray of shape (W, 3)
    """

    def __init__(self, step, positions):
        self._samples = samples = step.projection
        self._total = max(float(samples.area.sum()), 1e-300)
        # Round a vertex there is the area of two triangles.
        self._edge = _EDGE * np.sqrt(samples.mass / 2.0)[samples.owner]
        mesh = step.mesh
        self._surface, self._triangles = float(step.surface.size.sum()) / 2.0, mesh.triangles
        distance = sum(
            self._mean_square(x.astype(np.float64), y, 1)
            for x, y in zip(positions.T, mesh.positions.T, strict=True)
        )
        of_pairs = moved_by_pairs(step) * edge_length(step)
        self._displacement, self._color = max(_OUTLINE_SHARE * distance, of_pairs), 0.0

    def add(self, key, values, old):
        """Add the errors of an attribute.

        Parameters
        ----------
        key : str
        values : ndarray of shape (W, k)
        old : ndarray of shape (V, k)
        """
        power = 1 if is_coordinate(key) else 3
        square = [
            self._mean_square(x, y, power) for x, y in zip(values.T[:3], old.T[:3], strict=True)
        ]
        if power == 1:
            self._displacement += sum(square) * self._length_of_uv(old) ** 2
        elif key == "normal":
            self._color += _SHADE_OF_NORMAL**2 * sum(square)
        else:
            self._color = max(self._color, *square)

    def found(self):
        """Return the `LevelErrors` against the level before."""
        return LevelErrors(float(self._displacement), float(self._color))

    def _mean_square(self, values, old, power):
        """Return the mean squared error of one component, weighted by a power of the edges."""
        samples = self._samples
        old = old[samples.members].astype(np.float64)
        weight = samples.area * self._edge**power
        error = values[samples.owner] - old
        error[samples.moved] = samples.at(values) - old[samples.moved]
        return float((weight * np.square(error)).sum()) / self._total

    def _length_of_uv(self, uv):
        """Return the mean length of a unit of a texture coordinate on the surface."""
        solid = np.zeros((len(uv), 3))
        solid[:, : uv.shape[1]] = uv
        a, b, c = (solid[corner] for corner in self._triangles.T)
        covered = float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0
        # A mesh whose coordinates cover no area has one colour of its texture.
        return np.sqrt(self._surface / covered) if covered > 0.0 else 0.0
