"""The cross-section of a lens, with fans of rays: glass, stop, sensor, in mm.

The section holds the optical axis and one meridian. Rays are real ones, traced through everything
and spread over what gets through, so that a fan of a field far from the axis is cut as the lens
cuts it.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..optics.glass import REFERENCE_WAVELENGTH_NM, Air
from ..optics.paraxial import image_distance
from ..optics.rays.trace import Rays, trace
from ..optics.surfaces import sag

# Places at which a surface is drawn, and where a beam is searched for what gets through.
_PROFILE_POINTS = 41
_SEARCHED_RAYS = 801


@dataclass(frozen=True)
class Palette:
    """Colours of a drawing, as matplotlib takes them.

    Parameters
    ----------
    glass, edge : str
        Of a lens element.
    line : str
        Stop, sensor and axis.
    rays : tuple of str
        One for each field, in turn.
    """

    glass: str
    edge: str
    line: str
    rays: tuple[str, ...]


ON_WHITE = Palette("#b9d3ea", "#33475b", "#222222", ("#c8641e", "#1f77b4", "#2ca02c"))
ON_BLACK = Palette("#5b86ab", "#d4e4f2", "#e6e6e6", ("#ffb561", "#6fd0e8", "#9ae27a"))


def draw_cross_section(
    axes, configuration, *, fields_deg=(0.0,), rays=7, palette=ON_WHITE, meridian="y"
):
    """Draw a lens in section with a fan of rays for each field.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Gets equal scales and limits that hold all of the lens.
    configuration : Configuration
    fields_deg : sequence of float
        Angles from the axis of the objects at infinity.
    rays : int
        In each fan.
    palette : Palette
    meridian : {"x", "y"}
    """
    for polygon in element_outlines(configuration, meridian):
        axes.fill(*polygon.T, facecolor=palette.glass, edgecolor=palette.edge, linewidth=0.8)
    sensor = sensor_plane(configuration)
    front, extent = _front(configuration), _extent(configuration)
    axes.plot(
        [front - 0.2 * extent, sensor], [0.0, 0.0], color=palette.line, linewidth=0.4, alpha=0.6
    )
    heights = [0.0]
    for order, field_deg in enumerate(fields_deg):
        color = palette.rays[order % len(palette.rays)]
        for path in ray_paths(configuration, field_deg, rays, meridian):
            axes.plot(*path.T, color=color, linewidth=0.7)
            heights.append(abs(path[-1, 1]))
    _draw_stop(axes, configuration, palette.line)
    half = max(max(heights), 0.4 * extent)
    axes.plot([sensor, sensor], [-half, half], color=palette.line, linewidth=1.4)
    axes.set_aspect("equal")
    axes.set_xlim(front - 0.2 * extent, sensor + 0.05 * extent)
    tallest = 1.1 * max(half, *(surface.semi_diameter for surface in configuration.surfaces))
    axes.set_ylim(-tallest, tallest)


def element_outlines(configuration, meridian="y"):
    """Outlines of the pieces of glass.

    Parameters
    ----------
    configuration : Configuration
    meridian : {"x", "y"}

    Returns
    -------
    list of ndarray of shape (P, 2)
        z and height of each corner, mm; closed by joining the last with the first.
    """
    surfaces, vertices = configuration.surfaces, configuration.vertices
    outlines = []
    for i in range(len(surfaces) - 1):
        if isinstance(surfaces[i].glass, Air):
            continue
        front, back = surfaces[i], surfaces[i + 1]
        rim = max(front.semi_diameter, back.semi_diameter)
        before = _profile(front, vertices[i], rim, meridian)
        behind = _profile(back, vertices[i + 1], rim, meridian)
        outlines.append(np.concatenate([before, behind[::-1]]))
    return outlines


def ray_paths(configuration, field_deg, count, meridian="y"):
    """Rays of a beam from infinity that get through, spread evenly over it.

    Parameters
    ----------
    configuration : Configuration
    field_deg : float
        Angle of the beam from the axis, in the section.
    count : int
    meridian : {"x", "y"}

    Returns
    -------
    list of ndarray of shape (P, 2)
        z and height of each ray, mm, from in front of the lens to the sensor; empty if nothing
        gets through.
    """
    places = _passing_places(configuration, field_deg, count, meridian)
    if not len(places):
        return []
    bundle = _beam(configuration, field_deg, places, meridian)
    traced = trace(configuration, bundle, REFERENCE_WAVELENGTH_NM, record=True)
    across = 0 if meridian == "x" else 1
    sensor = sensor_plane(configuration)
    starts, ends = bundle.origins, traced.at_plane(sensor)
    paths = []
    for row in np.flatnonzero(traced.passed):
        hits = traced.hits[:, row]
        points = [
            (starts[row, 2], starts[row, across]),
            *zip(hits[:, 2], hits[:, across], strict=True),
            (sensor, ends[row, across]),
        ]
        paths.append(np.array(points))
    return paths


def sensor_plane(configuration):
    """Plane in which the image of infinity is drawn.

    Parameters
    ----------
    configuration : Configuration

    Returns
    -------
    float
        z in mm; the paraxial focus where the file does not tell.
    """
    if configuration.surfaces[-1].thickness > 0.0:
        return configuration.sensor
    return configuration.vertices[-1] + image_distance(configuration, math.inf)


def _front(configuration):
    first = configuration.surfaces[0]
    return min(0.0, float(sag(first, 0.0, first.semi_diameter)))


def _extent(configuration):
    """Return the larger of the lens' length and diameter, the unit of drawn lengths."""
    widest = max(surface.semi_diameter for surface in configuration.surfaces)
    return max(configuration.vertices[-1], 2.0 * widest)


def _profile(surface, vertex, rim, meridian):
    heights = np.linspace(-1.0, 1.0, _PROFILE_POINTS) * surface.semi_diameter
    across = (heights, 0.0 * heights)
    z = vertex + sag(surface, *(across if meridian == "x" else across[::-1]))
    points = np.stack([z, heights], axis=-1)
    if rim > surface.semi_diameter:
        # The rest of the rim is ground flat.
        points = np.concatenate([[[z[0], -rim]], points, [[z[-1], rim]]])
    return points


def _beam(configuration, field_deg, places, meridian):
    """Return parallel rays that cross a line through the first vertex at `places`, in mm."""
    angle = math.radians(field_deg)
    direction, sideways = np.zeros(3), np.zeros(3)
    across = 0 if meridian == "x" else 1
    direction[[across, 2]] = math.sin(angle), math.cos(angle)
    sideways[[across, 2]] = math.cos(angle), -math.sin(angle)
    origins = np.asarray(places)[:, None] * sideways
    # Up to the plane from which rays are drawn, unless that is far along a flat ray.
    start = _front(configuration) - 0.2 * _extent(configuration)
    reach = np.minimum(
        (origins[:, 2] - start) / max(direction[2], 1e-3), 1.5 * _extent(configuration)
    )
    origins = origins - np.maximum(reach, 0.0)[:, None] * direction
    return Rays(origins, np.broadcast_to(direction, origins.shape))


def _passing_places(configuration, field_deg, count, meridian):
    reach = 1.5 * max(surface.semi_diameter for surface in configuration.surfaces)
    places = np.linspace(-reach, reach, _SEARCHED_RAYS)
    bundle = _beam(configuration, field_deg, places, meridian)
    passing = places[trace(configuration, bundle, REFERENCE_WAVELENGTH_NM).passed]
    if not len(passing):
        return passing
    # The outermost rays would lie on the rims.
    return np.linspace(passing[0], passing[-1], count)


def _draw_stop(axes, configuration, color):
    surface = configuration.surfaces[configuration.stop - 1]
    z = configuration.vertices[configuration.stop - 1]
    inner = surface.semi_diameter
    outer = max(1.25 * inner, 0.8 * max(s.semi_diameter for s in configuration.surfaces))
    edge = z + float(sag(surface, 0.0, inner))
    for side in (-1.0, 1.0):
        axes.plot([edge, edge], [side * inner, side * outer], color=color, linewidth=1.6)
