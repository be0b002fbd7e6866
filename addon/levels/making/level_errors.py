"""How much blur hides what a level of detail changes, measured as it is fitted.

A level's least squares fit leaves errors without a mean over a few triangles: a blur of diameter D
spreads each over its area, and what is left is the share of the triangles that its rim cuts. So an
error e of triangles with edges h shows as e (h / D)^1.5. A texture or an outline that has moved
by s shows where it has edges, as s / D of their contrast; moves of different triangles are
independent, which leaves a factor of (h / D)^0.5. Squares of both add up over the levels, each with
its own h.

References
----------
Garland and Heckbert, *Simplifying surfaces with color and texture using quadric error metrics*,
Visualization 1998: one error of place and attributes.
"""

from dataclasses import dataclass

import numpy as np

# An error of normals by this much counts as one of colours: shading changes by less than its
# normal, and by a part of full light.
_SHADE_OF_NORMAL = 0.3
# What does not show: an error of colours, and a move in diameters of the blur. Some times the
# deviation that a picture of 42 dB has, as only a part of a picture errs. On toys with colours of
# high contrast, levels then cost 43.5 dB; twice both values 40.8 dB, for a tenth less triangles.
_FAINT_COLOR = 0.015
_FAINT_MOVE = 0.02
# A texture is seen everywhere, an outline on some pixels: what it moves counts this much.
_OUTLINE_SHARE = 0.25
# Edge of an equilateral triangle, in roots of its area.
_EDGE = 1.52


@dataclass(frozen=True)
class LevelErrors:
    """Of a level against full detail.

    Parameters
    ----------
    displacement : float
        Sum of s^2 h, in cubed units of the object; s is the distance between where a piece of the
        surface with its texture was and where it is, in the mean square.
    color : float
        Sum of e^2 h^3; e is that of vertex colours, scene linear, of the channel that errs most.
        Shading counts, too.
    """

    displacement: float = 0.0
    color: float = 0.0

    def __add__(self, other):
        """Return the errors of two levels, one after the other."""
        return LevelErrors(self.displacement + other.displacement, self.color + other.color)

    @property
    def blur(self):
        """Diameter of the blur that hides the errors, in units of the object."""
        return self._hidden(self.color / _FAINT_COLOR**2 + self.displacement / _FAINT_MOVE**2)

    @property
    def blur_of_moves(self):
        """The same of the displacement alone."""
        return self._hidden(self.displacement / _FAINT_MOVE**2)

    @staticmethod
    def _hidden(volume):
        return float(np.cbrt(volume))


def edge_length(step):
    """Return about how long the edges of the new triangles are."""
    surface = float(step.surface.size.sum()) / 2.0
    return _EDGE * np.sqrt(surface / max(len(step.triangles), 1))


def moved_by_pairs(step):
    """Return the mean squared move of the surface by parts that became one."""
    if step.pairs is None:
        return 0.0
    return step.pair_moves / max(float(step.surface.size.sum()), 1e-300)


class ErrorMeter:
    """Measures the values of a level at the vertices of the level before.

    Each error counts with the edges of the triangles where it is: on flat parts of a body those are
    far longer than in the mean.

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
        """Count an attribute.

        Parameters
        ----------
        key : str
        values : ndarray of shape (W, k)
        old : ndarray of shape (V, k)
        """
        power = 1 if key.startswith("uv:") else 3
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
        """Return the mean of one component's squared errors, times a power of the edges there."""
        samples = self._samples
        old = old[samples.members].astype(np.float64)
        weight = samples.area * self._edge**power
        error = values[samples.owner] - old
        error[samples.moved] = samples.at(values) - old[samples.moved]
        return float((weight * np.square(error)).sum()) / self._total

    def _length_of_uv(self, uv):
        """Return how long a unit of the texture is on the surface, in the mean."""
        a, b, c = (uv[corner].astype(np.float64) for corner in self._triangles.T)
        (x, y), (z, w) = (b - a).T, (c - a).T
        covered = float(np.abs(x * w - y * z).sum()) / 2.0
        # A texture that covers nothing is one colour.
        return np.sqrt(self._surface / covered) if covered > 0.0 else 0.0
