"""Bokeh sprites: the picture of a point out of focus, for panels and data sheets.

A sprite is oriented as in the final picture: x to the right along columns, y up along rows (row 0
is the bottom), its centre where a pinhole would put the point. Each channel sums to 1, so that a
splat only multiplies it by the energy of the source.

Behind the plane of focus the opening appears upright; in front of it, turned by half a turn.
"""

import numpy as np

from ..openings.masks import texel_centres
from .appearance import Appearance
from .deposit import deposit, open_weights, rays_for, spacing

_SUPERSAMPLING = 3
# Strongest spherical aberration of the edge control: r = p (1 + k (p^2 - 1)). At -0.5 the rim is
# a caustic; towards the core the same light is spread as far as looks even.
_BUBBLE, _CREAM = -0.45, 0.8


def sprite(
    appearance=None,
    size=128,
    *,
    row=None,
    upright=True,
    chief=(0.0, 0.0),
    fresnel_number=None,
    extent=1.0,
):
    """Compose a sprite from the profile of a lens, or an even disc, and an appearance.

    Parameters
    ----------
    appearance : Appearance or None
    size : int
        Texels along a side.
    row : PatternRow or None
        Of a lens' profile, at the very f-number; None: a thin lens.
    upright : bool
        Whether the point lies behind the plane of focus.
    chief : tuple of float
        Tangent of the angle to the point in x and y, as the camera sees it.
    fresnel_number : float or None
        Of the defocus at 587.6 nm, for diffraction.
    extent : float
        The sprite spans -extent to extent in units of the radius of the pattern (that of `row`).

    Returns
    -------
    ndarray of shape (size, size, channels)
        Not negative, finite, each channel of sum 1; as many channels as the row or diffraction
        has, whichever are more.
    """
    appearance = appearance or Appearance()
    fine = size * _SUPERSAMPLING
    places = texel_centres(fine, extent)
    opening = places if upright else -places
    light = appearance.transmission(opening, 2.0 * extent / fine, chief, fresnel_number)
    radius = np.hypot(places[..., 0] * appearance.anamorphic_ratio, places[..., 1])
    if row is not None:
        light = light * _density_of_row(row, radius)
    elif appearance.edge != 0.0:
        edge = appearance.edge if upright else -appearance.edge
        light = light * _density_of_edge(edge, radius)[..., None]
    light = light.reshape(size, _SUPERSAMPLING, size, _SUPERSAMPLING, -1).mean(axis=(1, 3))
    return _normalised(light)


def sprite_of_beam(
    beam,
    shift,
    appearance=None,
    size=128,
    *,
    extent,
    azimuth=0.5 * np.pi,
    fresnel_number=None,
    centre=None,
    fresnel_losses=False,
):
    """Compose a sprite from the traced pupil of a real lens and an appearance.

    Parameters
    ----------
    beam : PupilBeam or sequence of (PupilBeam, ndarray of shape (channels,))
        Of the point, at the f-number wanted; or one for each wavelength with its share in each
        channel.
    shift : float
        Sensor's distance behind the sensor plane of the tables, mm.
    appearance : Appearance or None
        Places of the opening are those in the stop.
    size : int
        Texels along a side.
    extent : float
        Half the width of the sprite on the sensor, mm.
    azimuth : float
        Direction from the axis to the point as the camera sees it, radians from x towards y.
    fresnel_number : float or None
    centre : float or None
        Image height of the sprite's middle, mm; None: where the chief ray lands.
    fresnel_losses : bool
        Whether rays lose what the surfaces reflect.

    Returns
    -------
    ndarray of shape (size, size, channels)
        Not negative, finite, each channel of sum 1 (0 throughout if no ray gets through).
    """
    appearance = appearance or Appearance()
    beams = [(beam, np.ones(1))] if hasattr(beam, "landing") else list(beam)
    first = beams[0][0]
    if centre is None:
        centre = first.chief[1] + first.chief[3] * shift
    turn = azimuth - 0.5 * np.pi
    total = 0.0
    for one, shares in beams:
        fine = one.refined(rays_for(one, shift, 2.0 * extent / size))
        # A picture is the sensor turned by half a turn, and the camera sees the opening from
        # behind the stop as it is: the frame of the beam has the point at -y.
        places = _turned(fine.landing(shift) - (0.0, centre), turn)
        stop = -_turned(fine.stop, turn) / fine.stop_scale
        width = np.median(np.maximum(spacing(stop[..., 0]), spacing(stop[..., 1])))
        light = appearance.transmission(stop, width, _chief_tangent(one, azimuth), fresnel_number)
        light = light * open_weights(fine, None, fresnel_losses, stop_rim=False)[..., None]
        texels = (places + extent) * (size / (2.0 * extent))
        shares = np.asarray(shares, dtype=float)
        channels = max(light.shape[-1], len(shares))
        layers = [
            deposit(texels, light[..., min(i, light.shape[-1] - 1)], size)
            * shares[min(i, len(shares) - 1)]
            for i in range(channels)
        ]
        total = total + np.stack(layers, axis=-1)
    return _normalised(total)


def _chief_tangent(beam, azimuth):
    tangent = np.tan(min(beam.angle, 1.55))
    return tangent * np.cos(azimuth), tangent * np.sin(azimuth)


def _turned(vectors, angle):
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([x * cos - y * sin, x * sin + y * cos], axis=-1)


def _density_of_row(row, radius):
    """Density at radii in units of the row's extent; 0 beyond."""
    count = len(row.density)
    ring = np.minimum((radius * count).astype(int), count - 1)
    return np.where((radius < 1.0)[..., None], row.density[ring], 0.0)


def edge_landing(edge, pupil):
    """Radii at which rays land in a disc under third-order spherical aberration.

    Parameters
    ----------
    edge : float
        -1 a bright core, 1 a bright rim.
    pupil : ndarray of shape (...)
        Places of the opening, 0 to 1.

    Returns
    -------
    ndarray of shape (...)
        Radii, 0 to 1, rising with the place.
    """
    return pupil * (1.0 + _edge_strength(edge) * (pupil**2 - 1.0))


def _edge_strength(edge):
    return _BUBBLE * edge if edge > 0.0 else -_CREAM * edge


def _density_of_edge(edge, radius):
    """Density of a disc under third-order spherical aberration, by its own radius."""
    k = _edge_strength(edge)
    pupil = np.linspace(0.0, 1.0, 1025)
    landing = edge_landing(edge, pupil)
    # p dp / (r dr) = 1 / ((r / p) (dr / dp)), with its limit on the axis.
    density = 1.0 / ((1.0 + k * (pupil**2 - 1.0)) * (1.0 - k + 3.0 * k * pupil**2))
    return np.interp(radius, landing, density)


def _normalised(light):
    light = np.maximum(light, 0.0)
    total = light.sum(axis=(0, 1))
    return light / np.where(total > 0.0, total, 1.0)
