"""The sequential prescription of a lens, and its configurations: zoom position, opening, focus.

Lengths are in mm, angles of lens files in degrees; light travels towards +z; a radius is positive
when the centre of curvature lies on the +z side. Surfaces are counted from 1 in the order in which
light meets them, the stop included.
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

from ..errors import PrescriptionError
from .glass import AIR, Glass
from .surfaces import sag

# Depth of a stop inside a bulge over the sag at the rim, at most: patents print it with few digits.
_ROUNDED_BULGE = 1.1


@dataclass(frozen=True)
class Surface:
    """One surface, and the medium and distance behind it.

    ``sag(r) = c r^2 / (1 + sqrt(1 - (1 + conic) c^2 r^2)) + sum a_n r^n``, c = 1 / radius.

    Parameters
    ----------
    radius : float
        Radius of curvature at the vertex in mm; inf for a plane.
    thickness : float
        To the next vertex, mm; the last one to the image plane of an object at infinity. Negative
        only beside a stop that lies within the bulge of its neighbour; see `may_overlap`.
    semi_diameter : float
        Clear radius, mm: a ray that hits farther from the axis is blocked.
    glass : Glass
        The medium behind the surface.
    conic : float
    asphere : tuple of (int, float)
        Order n (even, 2 to 20) and coefficient a_n in mm^(1 - n), rising orders.
    is_stop : bool
    id : str or None
        By which zoom and focus settings refer to the distance behind this surface.
    curved_along : str or None
        None for a surface of revolution; "x" or "y" for a cylinder whose sag depends on that
        coordinate alone (r in the equation is then x or y).
    """

    radius: float
    thickness: float
    semi_diameter: float
    glass: Glass
    conic: float = 0.0
    asphere: tuple[tuple[int, float], ...] = ()
    is_stop: bool = False
    id: str | None = None
    curved_along: str | None = None

    @property
    def curvature(self):
        """1 / radius in 1/mm; 0 for a plane."""
        return 1.0 / self.radius


def may_overlap(surfaces, number):
    """Return whether the negative distance behind a surface is possible.

    The opening of an iris may lie behind the vertex of the surface that follows, or in front of
    that of the one before it, where their rims leave room. It is a plane that refracts nothing, so
    that rays can be followed to it and back.

    Parameters
    ----------
    surfaces : sequence of (Surface or None)
        None for one that is not known.
    number : int
        From 1.

    Returns
    -------
    bool
    """
    for stop, neighbour in ((number, number + 1), (number + 1, number)):
        if max(stop, neighbour) > len(surfaces):
            continue
        plane, bulging = surfaces[stop - 1], surfaces[neighbour - 1]
        before = surfaces[stop - 2] if stop > 1 else None
        if plane is None or bulging is None or (stop > 1 and before is None):
            continue
        idle = plane.glass == (AIR if stop == 1 else before.glass)
        if plane.is_stop and idle and math.isinf(plane.radius) and not plane.asphere:
            overlap = -surfaces[number - 1].thickness
            bulge = sag(bulging, 0.0, bulging.semi_diameter)
            # The bulge is on the side of the stop.
            depth = float(bulge if neighbour > stop else -bulge)
            return overlap <= _ROUNDED_BULGE * depth
    return False


@dataclass(frozen=True)
class Diaphragm:
    """The iris.

    Parameters
    ----------
    blades : int
        0 for a round opening, else 3 to 32.
    blade_curvature : float
        0 for straight edges, 1 for a circle.
    rotation_deg : float
    """

    blades: int = 0
    blade_curvature: float = 0.0
    rotation_deg: float = 0.0


@dataclass(frozen=True)
class FocusGroup:
    """The part of a lens that moves for focusing.

    The distance before `first` shrinks by as much as the distance behind `last` grows. A group
    that starts with surface 1 moves towards the scene; one that ends with the last surface moves
    away from the sensor.

    Parameters
    ----------
    first, last : int
        Numbers of its outermost surfaces, from 1.
    """

    first: int
    last: int


@dataclass(frozen=True)
class ZoomPosition:
    """One setting of a zoom lens.

    Parameters
    ----------
    label : str
    focal_length, f_number, half_field_deg : float
        Nominal; mm, wide open, degrees.
    thicknesses : dict of str to float
        The distances that move, by surface id, mm.
    stop_semi_diameter : float or None
        None: that of the stop surface.
    """

    label: str
    focal_length: float
    f_number: float
    half_field_deg: float
    thicknesses: dict[str, float]
    stop_semi_diameter: float | None = None

    def applied(self, surfaces):
        """Return the lens at this position.

        Parameters
        ----------
        surfaces : sequence of Surface
            As the file gives them.

        Returns
        -------
        Configuration
        """
        return Configuration(
            tuple(self._applied_to(surface) for surface in surfaces),
            self.focal_length,
            self.f_number,
            self.half_field_deg,
            self.label,
        )

    def _applied_to(self, surface):
        semi_diameter = surface.semi_diameter
        if surface.is_stop and self.stop_semi_diameter is not None:
            semi_diameter = self.stop_semi_diameter
        thickness = self.thicknesses.get(surface.id, surface.thickness)
        return replace(surface, semi_diameter=semi_diameter, thickness=thickness)


@dataclass(frozen=True)
class Configuration:
    """A lens at one zoom position, opening and focus, ready to be traced.

    Parameters
    ----------
    surfaces : tuple of Surface
        With the distances and the stop's opening of this configuration.
    focal_length, f_number, half_field_deg : float
        Nominal values of the file; the f-number wide open.
    label : str or None
        Of the zoom position; None for a lens that has none.
    """

    surfaces: tuple[Surface, ...]
    focal_length: float
    f_number: float
    half_field_deg: float
    label: str | None = None

    @cached_property
    def stop(self):
        """Number of the stop surface, from 1."""
        return next(i for i, surface in enumerate(self.surfaces, 1) if surface.is_stop)

    @cached_property
    def vertices(self):
        """The z of each vertex, mm, from surface 1."""
        positions = [0.0]
        for surface in self.surfaces[:-1]:
            positions.append(positions[-1] + surface.thickness)
        return tuple(positions)

    @cached_property
    def rear_vertex(self):
        """The z of the last vertex that refracts, mm, from surface 1; a stop behind it has none."""
        before = [AIR, *(surface.glass for surface in self.surfaces[:-1])]
        vertices = zip(self.surfaces, before, self.vertices, strict=True)
        bending = [z for surface, medium, z in vertices if surface.glass != medium]
        return bending[-1] if bending else self.vertices[-1]

    @cached_property
    def of_revolution(self):
        """Whether the lens looks the same however it is turned about its axis."""
        return all(surface.curved_along is None for surface in self.surfaces)

    @property
    def sensor(self):
        """The z of the sensor plane by the last thickness, mm, from surface 1."""
        return self.vertices[-1] + self.surfaces[-1].thickness

    def with_thickness(self, number, thickness):
        """Return the configuration with another distance behind surface `number` (from 1)."""
        surfaces = list(self.surfaces)
        surfaces[number - 1] = replace(surfaces[number - 1], thickness=thickness)
        return replace(self, surfaces=tuple(surfaces))

    def stopped_down(self, f_number):
        """Return the configuration at an f-number, never wider than wide open.

        The stop's radius scales by wide-open f-number over `f_number`.

        Parameters
        ----------
        f_number : float

        Raises
        ------
        PrescriptionError
            If the f-number is not positive.
        """
        if not f_number > 0.0:
            raise PrescriptionError(f"f-number {f_number:g} must be greater than 0")
        scale = min(1.0, self.f_number / f_number)
        surfaces = list(self.surfaces)
        stop = surfaces[self.stop - 1]
        surfaces[self.stop - 1] = replace(stop, semi_diameter=stop.semi_diameter * scale)
        return replace(self, surfaces=tuple(surfaces))


@dataclass(frozen=True)
class Prescription:
    """The prescription of a lens, as its file has it.

    Parameters
    ----------
    name : str
    focal_length, f_number, half_field_deg : float
        Nominal; mm, wide open, degrees.
    surfaces : tuple of Surface
        From the scene to the sensor; exactly one is the stop.
    designer, source, notes : str or None
    year : int or None
    projection : str
        "rectilinear" or "fisheye".
    image_circle_diameter : float or None
        mm.
    diaphragm : Diaphragm
    zoom : tuple of ZoomPosition
        Empty, or at least two, ordered by focal length.
    focus : FocusGroup or None
        None: the whole lens moves.
    """

    name: str
    focal_length: float
    f_number: float
    half_field_deg: float
    surfaces: tuple[Surface, ...]
    designer: str | None = None
    source: str | None = None
    year: int | None = None
    notes: str | None = None
    projection: str = "rectilinear"
    image_circle_diameter: float | None = None
    diaphragm: Diaphragm = field(default_factory=Diaphragm)
    zoom: tuple[ZoomPosition, ...] = ()
    focus: FocusGroup | None = None

    @property
    def labels(self):
        """Labels of the zoom positions; (None,) for a lens without."""
        return tuple(position.label for position in self.zoom) or (None,)

    def configuration(self, label=None):
        """Return the lens at a zoom position.

        Parameters
        ----------
        label : str or None
            None: the first position.

        Returns
        -------
        Configuration

        Raises
        ------
        PrescriptionError
            If there is no such position.
        """
        if label is not None and label not in self.labels:
            known = ", ".join(f"'{name}'" for name in self.labels if name) or "none"
            raise PrescriptionError(
                f"lens '{self.name}' has no zoom position '{label}'; it has {known}"
            )
        if not self.zoom:
            return Configuration(
                self.surfaces, self.focal_length, self.f_number, self.half_field_deg
            )
        return next(p for p in self.zoom if label in (None, p.label)).applied(self.surfaces)

    def configurations(self):
        """Return the lens at all its zoom positions.

        Returns
        -------
        tuple of Configuration
        """
        if not self.zoom:
            return (self.configuration(),)
        return tuple(position.applied(self.surfaces) for position in self.zoom)
