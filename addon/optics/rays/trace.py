"""Sequential tracing of rays through a lens.

Rays meet the surfaces in their order and are refracted by Snell's law in vector form: with the unit
normal N towards +z, d the unit direction times the index n, and `C = d . N`,
`d' = d + (sign(C) sqrt(n'^2 - n^2 + C^2) - C) N`. Reflected light is not followed.

Positions are in mm from the vertex of surface 1. A ray that fails is data, not an error: its status
says how and where, and its numbers are finite.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ...errors import PrescriptionError
from ..bundle import DIRECTION, POSITION, Bundle
from ..fresnel import transmittance
from ..media import indices
from ..surfaces import FAR, Shape, within_reach

# Rays at a time: the working arrays stay in a core's second-level cache.
CHUNK = 8192
# While more than this share of a chunk is being traced, ended rays are carried along: that costs
# less than compacting the arrays.
WORTH_KEEPING = 0.7


class RayStatus(IntEnum):
    """Result of tracing a ray."""

    PASSED = 0
    BLOCKED = 1  # outside a rim or the stop
    MISSED = 2  # a surface does not lie in its way
    TOTAL_REFLECTION = 3


@dataclass(frozen=True)
class Rays:
    """Rays to be traced.

    Parameters
    ----------
    origins : ndarray of shape (N, 3)
        Any point of each ray, mm.
    directions : ndarray of shape (N, 3)
        Unit vectors.

    Raises
    ------
    PrescriptionError
        If the shapes differ or a number is not finite.
    """

    origins: np.ndarray
    directions: np.ndarray

    def __post_init__(self):
        """Check that the rays can be traced."""
        for name in ("origins", "directions"):
            values = np.asarray(getattr(self, name), dtype=float)
            if values.ndim != 2 or values.shape[1] != 3:
                raise PrescriptionError(f"ray {name} have shape {values.shape}, wanted (N, 3)")
            if not np.isfinite(values).all():
                raise PrescriptionError(f"ray {name} contain numbers that are not finite")
            object.__setattr__(self, name, values)
        if self.origins.shape != self.directions.shape:
            raise PrescriptionError(
                f"{len(self.origins)} ray origins, but {len(self.directions)} directions"
            )

    def __len__(self):
        """Return the number of rays."""
        return len(self.origins)


@dataclass(frozen=True)
class TracedRays:
    """Rays behind the last surface traced, or where they ended.

    Parameters
    ----------
    points : ndarray of shape (N, 3)
        Where each ray met its last surface, mm from the vertex of surface 1. A ray that misses a
        surface has its point nearest to that vertex.
    directions : ndarray of shape (N, 3)
        Unit vectors behind that surface; of a ray that ended, with which it arrived.
    status : ndarray of uint8, shape (N,)
        `RayStatus`. Without clipping BLOCKED rays went on to the last surface.
    surface : ndarray of int, shape (N,)
        Number of the surface that stopped the ray (without clipping: the first outside of whose rim
        it met it, or the one that it missed); 0 if it passed.
    reached : ndarray of bool, shape (N,)
        Whether point and direction are those behind the last surface.
    hits : ndarray of shape (S, N, 3) or None
        Where each ray met each surface, in the order of travel; a ray that ended stays in place.
    transmission : ndarray of shape (N,) or None
        Share of light left by Fresnel reflection; 0 for rays that did not get through.
    """

    points: np.ndarray
    directions: np.ndarray
    status: np.ndarray
    surface: np.ndarray
    reached: np.ndarray
    hits: np.ndarray | None = None
    transmission: np.ndarray | None = None

    @property
    def passed(self):
        """Mask of the rays that got through everything, shape (N,)."""
        return self.status == RayStatus.PASSED

    def at_plane(self, z):
        """Points at which the rays cross a plane perpendicular to the axis.

        Parameters
        ----------
        z : float
            mm from the vertex of surface 1.

        Returns
        -------
        ndarray of shape (N, 2)
            x and y in mm; 0 for rays that did not reach the last surface or run along the plane.
        """
        along = self.directions[:, 2]
        crossing = self.reached & (np.abs(along) > 1.0e-9)
        every = crossing.all()
        distance = np.subtract(z, self.points[:, 2])
        np.divide(distance, along, out=distance, where=True if every else crossing)
        crossed = np.empty((len(along), 2))
        for axis in (0, 1):
            np.multiply(distance, self.directions[:, axis], out=crossed[:, axis])
            crossed[:, axis] += self.points[:, axis]
        if not every:
            crossed[~crossing] = 0.0
        return crossed


@dataclass(frozen=True)
class _Step:
    """A surface, prepared for tracing."""

    number: int
    shape: Shape
    z: float
    semi_diameter: float
    before: float
    behind: float


def trace(
    configuration,
    rays,
    wavelength_nm,
    *,
    clip=True,
    record=False,
    transmission=False,
    coating=None,
    first=1,
    last=None,
    backwards=False,
):
    """Trace rays through a lens or some of its surfaces.

    Parameters
    ----------
    configuration : Configuration
    rays : Rays
        In the medium in front of the first surface met.
    wavelength_nm : float
    clip : bool
        Whether rims and the stop end a ray. Without, it goes on and tells the first that would.
    record : bool
        Whether to keep the hit points.
    transmission : bool
        Whether to find the share of light that Fresnel reflection leaves.
    coating : Coating or None
        On the surfaces between glass and air; None: bare glass.
    first, last : int
        Numbers of the outermost surfaces to trace, from 1; None: the last one. `last` may be
        ``first - 1``: no surface.
    backwards : bool
        From `last` to `first`, for rays that travel towards the scene.

    Returns
    -------
    TracedRays

    Raises
    ------
    PrescriptionError
        If there are no such surfaces, or a glass has no index at the wavelength.
    """
    steps = _steps(configuration, wavelength_nm, first, last, backwards)
    count = len(rays)
    result = TracedRays(
        points=np.empty((count, 3)),
        directions=np.empty((count, 3)),
        status=np.zeros(count, dtype=np.uint8),
        surface=np.zeros(count, dtype=np.int32),
        reached=np.ones(count, dtype=bool),
        hits=np.empty((len(steps), count, 3)) if record else None,
        transmission=np.ones(count) if transmission else None,
    )
    start_index = steps[0].before if steps else 1.0
    bundle = Bundle(rays.origins[:CHUNK], rays.directions[:CHUNK])
    with np.errstate(all="ignore"):
        for start in range(0, count, CHUNK):
            part = slice(start, start + CHUNK)
            bundle.load(rays.origins[part], rays.directions[part], start_index)
            _Chunk(result, part, bundle, clip, coating, wavelength_nm).run(steps)
    if transmission:
        result.transmission[~result.reached] = 0.0
    return result


def _steps(configuration, wavelength_nm, first, last, backwards):
    surfaces = configuration.surfaces
    last = len(surfaces) if last is None else last
    if not (1 <= first <= last + 1 <= len(surfaces) + 1):
        raise PrescriptionError(
            f"surfaces {first} to {last} were asked for; the lens has 1 to {len(surfaces)}"
        )
    media = indices(configuration, wavelength_nm)
    steps = []
    for number in range(first, last + 1):
        surface = surfaces[number - 1]
        before, behind = media[number - 1], media[number]
        if backwards:
            before, behind = behind, before
        z = configuration.vertices[number - 1]
        steps.append(_Step(number, Shape(surface), z, surface.semi_diameter, before, behind))
    return steps[::-1] if backwards else steps


class _Chunk:
    """One chunk of rays on its way, and where its results go."""

    def __init__(self, result, part, bundle, clip, coating, wavelength_nm):
        self.bundle = bundle
        self.clip = clip
        self.coating = coating
        self.wavelength_nm = wavelength_nm
        self.points = result.points[part]
        self.directions = result.directions[part]
        self.status = result.status[part]
        self.surface = result.surface[part]
        self.reached = result.reached[part]
        self.hits = None if result.hits is None else result.hits[:, part]
        self.transmission = None if result.transmission is None else result.transmission[part]
        self.vertex = 0.0
        self.alive = None

    def run(self, steps):
        bundle = self.bundle
        for order, step in enumerate(steps):
            bundle.z -= step.z - self.vertex
            self.vertex = step.z
            if bundle.count:
                self.meet(step)
            if self.hits is not None:
                self.record(order)
            if bundle.count:
                self.refract(step)
        self.leave()

    def meet(self, step):
        """Move rays to a surface; end those that do not find it or are outside its rim."""
        bundle = self.bundle
        missed = step.shape.meet(bundle)
        if missed is None and step.shape.clears_rim(bundle):
            return
        squared = bundle.radius_squared()
        limit = step.semi_diameter * step.semi_diameter
        if missed is None and squared.max() <= limit:
            return
        outside = ~(squared <= limit)
        lost = ~(squared <= FAR * FAR)
        if missed is not None:
            lost |= missed
        outside &= ~lost
        if self.clip:
            self.end(step, (RayStatus.MISSED, lost), (RayStatus.BLOCKED, outside))
            return
        rows = self.rows(self.places(outside))
        rows = rows[self.surface[rows] == 0]
        self.surface[rows] = step.number
        self.status[rows] = RayStatus.BLOCKED
        self.end(step, (RayStatus.MISSED, lost))

    def end(self, step, *fates):
        """Record rays that end, each status with its mask, and go on without them."""
        gone = []
        for status, chosen in fates:
            places = self.places(chosen)
            if len(places):
                rows = self.rows(places)
                self.status[rows] = status
                self.surface[rows] = step.number
                self.reached[rows] = False
                self.leave_ended(places, rows)
                gone.append(places)
        if gone:
            self.retire(np.concatenate(gone))

    def retire(self, places):
        """Park ended rays, or compact the chunk if they are many."""
        alive = np.ones(self.bundle.count, dtype=bool) if self.alive is None else self.alive
        alive[places] = False
        if np.count_nonzero(alive) < WORTH_KEEPING * len(alive):
            self.bundle.keep(alive)
            self.alive = None
        else:
            self.bundle.park(places)
            self.alive = alive

    def places(self, chosen):
        """Places in the bundle of chosen rays that are on their way."""
        return np.flatnonzero(chosen if self.alive is None else chosen & self.alive)

    def rows(self, places):
        """Places in the chunk of rays of the bundle."""
        return places if self.bundle.rows is None else self.bundle.rows[places]

    def leave(self):
        """Write positions and directions of the rays on their way to the result."""
        bundle, alive = self.bundle, self.alive
        pairs = [(self.points, POSITION), (self.directions, DIRECTION)]
        for result, names in pairs:
            for axis, name in enumerate(names):
                values, column = getattr(bundle, name), result[:, axis]
                if names is DIRECTION and bundle.index != 1.0:
                    values = values / bundle.index
                elif name == "z":
                    values = values + self.vertex
                if bundle.rows is None:
                    np.copyto(column, values, where=True if alive is None else alive)
                elif alive is None:
                    column[bundle.rows] = values
                else:
                    column[bundle.rows[alive]] = values[alive]

    def leave_ended(self, places, rows):
        """Write positions and directions of rays that have ended to the result."""
        positions, directions = self.bundle.state(places)
        positions[:, 2] += self.vertex
        self.points[rows] = within_reach(positions)
        self.directions[rows] = directions

    def record(self, order):
        """Keep the hit points; rays that have ended stay where they are."""
        ended = ~self.reached
        self.leave()
        self.hits[order] = self.points
        if order:
            missed = ended & (self.status != RayStatus.BLOCKED)
            self.hits[order, missed] = self.hits[order - 1, missed]

    def refract(self, step):
        """Refract the rays at a surface; end those that are totally reflected."""
        if step.before == step.behind:
            return
        bundle = self.bundle
        # Of the cosine times index: below this there is no refracted ray.
        gain = step.behind * step.behind - step.before * step.before
        if gain < 0.0 and not bundle.square.min() > -gain:
            self.end(step, (RayStatus.TOTAL_REFLECTION, ~(bundle.square > -gain)))
            if not bundle.count:
                return
        if self.transmission is not None:
            rows = slice(None) if bundle.rows is None else bundle.rows
            cosine = np.abs(bundle.cosine) / step.before
            self.transmission[rows] *= transmittance(
                cosine, step.before, step.behind, self.coating, self.wavelength_nm
            )
        cosine, a, b = bundle.cosine, bundle.a, bundle.b
        np.add(bundle.square, gain, out=a)
        np.sqrt(a, out=a)
        if not cosine.min() > 0.0:
            np.copysign(a, cosine, out=a)
        a -= cosine
        bundle.index = step.behind
        if step.shape.is_spherical:
            bundle.n += np.multiply(a, bundle.slant, out=b)
            if step.shape.curvature != 0.0:
                a *= step.shape.curvature
                bundle.lm -= np.multiply(a, bundle.xy, out=bundle.bc)
            return
        for direction, component in zip(DIRECTION, step.shape.normals(bundle), strict=True):
            values = getattr(bundle, direction)
            values += a * component
