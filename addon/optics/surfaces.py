"""Shape of a lens surface, and where rays meet it.

With `u = x^2 + y^2` (for a cylinder the square of the one coordinate along which it curves),
`sag = c u / (1 + sqrt(1 - (1 + k) c^2 u)) + sum a_n u^(n/2)`; mm from the vertex, +z to the sensor.

A ray meets the sphere or conic `c (u + (1 + k) z^2) - 2 z = 0` where it crosses the sheet of the
vertex, `1 - (1 + k) c z > 0`; of two such points the one that its direction along z chooses: the
nearer to the vertex plane on a sphere. A ray may start behind the surface: its whole line counts.
An asphere is found by Newton's method from there. Rays that find no point are told by a mask.
"""

import math

import numpy as np

from .bundle import DIRECTION, POSITION

# Largest coordinate of a hit, mm: farther away a ray misses the surface, and squares never
# overflow.
FAR = 1.0e9
# Newton's method: the last step along the ray, mm, and how many steps before a ray is given up.
# It converges quadratically, so the position is far better than the last step.
LAST_STEP = 1.0e-12
MOST_STEPS = 40
# Rays less inclined to the axis than this cosine may be moved to the vertex plane first, which is
# quicker than to go to the point nearest to the vertex.
STEEPEST = 0.05


def sag(surface, x, y):
    """Height of a surface over its vertex plane.

    Parameters
    ----------
    surface : Surface
    x, y : ndarray of shape (...)
        mm.

    Returns
    -------
    ndarray of shape (...)
        mm. Beyond the reach of the conic the height of its equator goes on; not finite where the
        polynomial overflows, which a valid lens does not inside its rim.
    """
    with np.errstate(all="ignore"):
        u = _curving_squared(surface, np.asarray(x, dtype=float), np.asarray(y, dtype=float))
        return _sag(_coefficients(surface), u)[0]


def normal(surface, x, y):
    """Return the unit normal of a surface, towards +z.

    Parameters
    ----------
    surface : Surface
    x, y : ndarray of shape (...)
        mm.

    Returns
    -------
    ndarray of shape (..., 3)
    """
    x, y = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(y, dtype=float))
    with np.errstate(all="ignore"):
        return np.stack(_normal(surface, _coefficients(surface), x, y), axis=-1)


def within_reach(points):
    """Replace NaN by 0, and clamp coordinates to the largest one."""
    return np.clip(np.nan_to_num(points, nan=0.0), -FAR, FAR)


class Shape:
    """A surface, prepared for intersection with bundles of rays.

    Parameters
    ----------
    surface : Surface

    Attributes
    ----------
    curvature : float
    is_spherical : bool
        A plane or a sphere of revolution; its normals need no arrays.
    """

    def __init__(self, surface):
        self._surface = surface
        self._coefficients = _coefficients(surface)
        self.curvature = surface.curvature
        self.is_spherical = (
            surface.conic == 0.0 and not surface.asphere and surface.curved_along is None
        )
        self._rim_slant = self._slant_of_rim()

    def clears_rim(self, bundle):
        """Return whether all rays that met the surface are certainly inside its rim.

        On a sphere the normal tells how far from the axis a ray is; no square needs to be made.

        Parameters
        ----------
        bundle : Bundle

        Returns
        -------
        bool
        """
        return self._rim_slant is not None and bool(bundle.slant.min() > self._rim_slant)

    def _slant_of_rim(self):
        """Return z of the normal at the rim with a margin for rounding; None on other shapes."""
        sine = abs(float(self.curvature)) * float(self._surface.semi_diameter)
        if not self.is_spherical or not 0.0 < sine < 1.0:
            return None
        return math.sqrt(1.0 - sine * sine) + 1.0e-13

    def meet(self, bundle):
        """Move rays to the surface; set `cosine` and `square`, and `slant` on a sphere or plane.

        Parameters
        ----------
        bundle : Bundle
            Positions from the vertex.

        Returns
        -------
        ndarray of bool, shape (N,), or None
            Rays that miss; None if all meet it. Their numbers may not be finite, and floating
            point errors are to be silenced by the caller.
        """
        if self.is_spherical:
            return self._meet_plane(bundle) if self.curvature == 0.0 else self._meet_sphere(bundle)
        return self._meet_general(bundle)

    def normals(self, bundle):
        """Return the unit normals, towards +z, where rays met a surface that is not spherical."""
        return _normal(self._surface, self._coefficients, bundle.x, bundle.y)

    def _meet_plane(self, bundle):
        n, a = bundle.n, bundle.a
        along = None
        if not (n.min() > 0.0 or n.max() < 0.0):
            along = n == 0.0
        np.divide(bundle.z, n, out=a)
        np.negative(a, out=a)
        if along is not None:
            a[along] = 0.0
        bundle.advance(a)
        bundle.z[:] = 0.0
        bundle.cosine[:] = n
        np.multiply(n, n, out=bundle.square)
        bundle.slant[:] = 1.0
        return along

    def _meet_sphere(self, bundle):
        # With t in mm over index i, d times i: c i^2 t^2 + 2 h t + C = 0, h = c (d . p) - d_z and
        # C = c p^2 - 2 z. The root of the direction's sign is C / (s - h), s^2 = h^2 - c i^2 C, and
        # s is i times the cosine at the surface, whose unit normal is (-c x, -c y, 1 - c z).
        c, n, a, b, half = self.curvature, bundle.n, bundle.a, bundle.b, bundle.slant
        forward = n.min() > STEEPEST * bundle.index
        if forward:
            self._start_at_vertex_plane(bundle)
        else:
            self._start_near_vertex(bundle)
        square, cosine, slant = bundle.square, bundle.cosine, bundle.slant
        np.multiply(half, half, out=square)
        square -= np.multiply(a, c * bundle.index * bundle.index, out=b)
        missed = None
        if not square.min() > 0.0:
            missed = ~(square > 0.0)
            square[missed] = 1.0
            a[missed] = 0.0
        np.sqrt(square, out=cosine)
        if not forward:
            np.copysign(cosine, n, out=cosine)
        np.divide(a, np.subtract(cosine, half, out=b), out=a)
        if forward:
            bundle.xy += np.multiply(a, bundle.lm, out=bundle.bc)
            np.multiply(a, n, out=bundle.z)
        else:
            bundle.advance(a)
        np.multiply(bundle.z, -c, out=slant)
        slant += 1.0
        if not slant.min() > 0.0:
            beyond = ~(slant > 0.0)
            missed = beyond if missed is None else missed | beyond
        return missed

    def _start_at_vertex_plane(self, bundle):
        """Move rays there, but for their z; set h (in `slant`) and C (in `a`)."""
        a, half = bundle.a, bundle.slant
        np.divide(bundle.z, bundle.n, out=a)
        bundle.xy -= np.multiply(a, bundle.lm, out=bundle.bc)
        bundle.radius_squared()
        a *= self.curvature
        bundle.sideways(half)
        half *= self.curvature
        half -= bundle.n

    def _start_near_vertex(self, bundle):
        """Move rays to their points nearest to the vertex; set h and C."""
        a, b = bundle.a, bundle.b
        bundle.approach()
        bundle.radius_squared()
        a += np.multiply(bundle.z, bundle.z, out=b)
        a *= self.curvature
        a -= np.add(bundle.z, bundle.z, out=b)
        np.negative(bundle.n, out=bundle.slant)

    def _meet_general(self, bundle):
        bundle.approach()
        distance, missed = self._conic_distance(bundle)
        if self._surface.asphere:
            start = np.where(missed, -bundle.z / bundle.n, distance)
            distance, missed = self._newton(bundle, start)
        bundle.advance(np.where(missed, 0.0, distance))
        nx, ny, nz = self.normals(bundle)
        bundle.cosine[:] = bundle.l * nx + bundle.m * ny + bundle.n * nz
        np.multiply(bundle.cosine, bundle.cosine, out=bundle.square)
        missed |= ~(np.abs(bundle.cosine) > 0.0)
        return missed if missed.any() else None

    def _conic_distance(self, bundle):
        c, stretch = self.curvature, 1.0 + self._surface.conic
        x, y, z, l, m, n = (getattr(bundle, name) for name in (*POSITION, *DIRECTION))  # noqa: E741
        along = self._surface.curved_along
        square, cross, length = stretch * n * n, stretch * z * n, stretch * z * z
        if along != "y":
            square, cross, length = square + l * l, cross + x * l, length + x * x
        if along != "x":
            square, cross, length = square + m * m, cross + y * m, length + y * y
        half = c * cross - n
        constant = c * length - 2.0 * z
        discriminant = half * half - c * square * constant
        root = np.copysign(np.sqrt(np.maximum(discriminant, 0.0)), n)
        found = np.zeros(bundle.count, dtype=bool)
        distance = np.zeros(bundle.count)
        for sign in (1.0, -1.0):
            candidate = constant / (sign * root - half)
            on_sheet = 1.0 - stretch * c * (z + candidate * n) > 0.0
            take = ~found & on_sheet & (discriminant >= 0.0) & (np.abs(candidate) < FAR)
            distance[take] = candidate[take]
            found |= take
        return distance, ~found

    def _newton(self, bundle, distance):
        missed = ~(np.abs(distance) < FAR)
        distance[missed] = 0.0
        rows = np.flatnonzero(~missed)
        rays = [getattr(bundle, name)[rows] for name in (*POSITION, *DIRECTION)]
        steps = 0
        while len(rows):
            x, y, z, l, m, n = rays  # noqa: E741
            t = distance[rows]
            x, y = x + t * l, y + t * m
            height, slope, inside = _sag(self._coefficients, _curving_squared(self._surface, x, y))
            along = self._surface.curved_along
            turn = (x * l if along != "y" else 0.0) + (y * m if along != "x" else 0.0)
            step = (height - z - t * n) / (n - 2.0 * slope * turn)
            lost = ~(np.abs(t + step) < FAR)
            converged = np.abs(step) <= LAST_STEP + 1.0e-14 * np.abs(t)
            steps += 1
            failed = lost | (converged & ~inside)
            if steps == MOST_STEPS:
                failed |= ~converged
            distance[rows] = np.where(failed, 0.0, t + step)
            missed[rows[failed]] = True
            going = ~(failed | converged)
            if not going.all():
                rows = rows[going]
                rays = [values[going] for values in rays]
        return distance, missed


def _coefficients(surface):
    """Curvature, 1 + conic, and coefficients of u, u^2, ... u^10."""
    powers = [0.0] * (max((order for order, _ in surface.asphere), default=0) // 2)
    for order, coefficient in surface.asphere:
        powers[order // 2 - 1] += coefficient
    return surface.curvature, 1.0 + surface.conic, tuple(powers)


def _curving_squared(surface, x, y):
    if surface.curved_along == "x":
        return x * x + 0.0 * y
    if surface.curved_along == "y":
        return y * y + 0.0 * x
    return x * x + y * y


def _sag(coefficients, u):
    """Sag, its derivative with respect to u, and where the conic reaches."""
    c, stretch, powers = coefficients
    bend = stretch * c * c
    under = 1.0 - bend * u
    inside = under > 0.0
    root = np.sqrt(np.where(inside, under, 0.0))
    polynomial, slope = _polynomial(powers, u)
    # Beyond the equator the conic's height goes on, so that Newton's method may pass there.
    reach = np.where(inside, u, 1.0 / bend) if bend > 0.0 else u
    height = c * reach / (1.0 + root)
    return height + polynomial, np.where(inside, 0.5 * c / root, 0.0) + slope, inside


def _polynomial(powers, u):
    """Sum a_j u^j and its derivative."""
    value, slope = np.zeros_like(u), np.zeros_like(u)
    for coefficient in reversed(powers):
        slope = slope * u + value
        value = value * u + coefficient
    return value * u, slope * u + value


def _normal(surface, coefficients, x, y):
    """Components of the unit normal towards +z; scaled by the root, finite at the equator."""
    c, stretch, powers = coefficients
    u = _curving_squared(surface, x, y)
    root = np.sqrt(np.maximum(1.0 - stretch * c * c * u, 0.0))
    tilt = c + 2.0 * root * _polynomial(powers, u)[1]
    nx = -tilt * x if surface.curved_along != "y" else np.zeros_like(u)
    ny = -tilt * y if surface.curved_along != "x" else np.zeros_like(u)
    length = np.sqrt(nx * nx + ny * ny + root * root)
    return nx / length, ny / length, root / length
