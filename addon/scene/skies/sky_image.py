"""A sky as an equirectangular image, with the disc of its sun."""

from dataclasses import dataclass

import numpy as np

from . import fitted_skies, multiple_scattering, single_scattering
from .scattering import Atmosphere

# As Blender keeps a scattering sky: azimuths, and elevations that lie closer at the horizon.
_COLUMNS, _ROWS = 512, 256
# Of the equirectangular image: so fine that the sun's disc is a few texels wide.
_WIDTH = 2048
# Of a texel along each side, where the disc is.
_PARTS = 8
# How much darker the edge of the sun is than its middle.
_LIMB = 0.6
# Where a sky ends at the horizon it fades to black this far below it, in radians, with this power:
# measured of Cycles.
_FADE, _FADE_POWER = 0.409, 3.153
_HALF = 0.5 * np.pi
_MODELS = {"SINGLE_SCATTERING": single_scattering, "MULTIPLE_SCATTERING": multiple_scattering}


@dataclass(frozen=True)
class Sky:
    """A Sky Texture's settings.

    Parameters
    ----------
    kind : str
        Blender's ``sky_type``.
    air, aerosols, ozone : float
        Densities.
    altitude : float
        Of the eye, m.
    sun : tuple of 3 float
        Unit vector towards the sun.
    disc : float
        Angular diameter of the disc that is shown, radians; 0 shows none.
    intensity : float
        Of the disc.
    turbidity, albedo : float
        Of the fitted skies.
    """

    kind: str
    sun: tuple[float, float, float]
    air: float = 1.0
    aerosols: float = 1.0
    ozone: float = 1.0
    altitude: float = 0.0
    disc: float = 0.0
    intensity: float = 1.0
    turbidity: float = 2.2
    albedo: float = 0.3

    @property
    def atmosphere(self):
        """Its amounts, `Atmosphere`."""
        return Atmosphere(self.air, self.aerosols, self.ozone)


def sky_xyz(sky):
    """Compute a sky.

    Parameters
    ----------
    sky : Sky

    Returns
    -------
    ndarray of shape (height, width, 3)
        CIE XYZ; equirectangular as Blender's environments, bottom row first.
    """
    width, height = _WIDTH, _WIDTH // 2
    elevation = ((np.arange(height) + 0.5) / height - 0.5) * np.pi
    # From +x, clockwise as seen from above: the middle of the image is +x.
    azimuth = ((np.arange(width) + 0.5) / width - 0.5) * 2.0 * np.pi
    if sky.kind in {"PREETHAM", "HOSEK_WILKIE"}:
        return _fitted(sky, elevation, azimuth).astype(np.float32)
    image = _scattering(sky, elevation, azimuth)
    if sky.disc > 0.0:
        image += _disc(sky, elevation, azimuth)
    return image


def directions(elevation, azimuth):
    """Return unit vectors, shape (H, W, 3)."""
    up, across = np.sin(elevation)[:, None], np.cos(elevation)[:, None]
    parts = (across * np.cos(azimuth), -across * np.sin(azimuth), up + 0.0 * azimuth)
    return np.stack(parts, axis=-1)


def _fitted(sky, elevation, azimuth):
    cosine = np.clip(directions(elevation, azimuth) @ np.array(sky.sun), -1.0, 1.0)
    theta = np.broadcast_to((_HALF - elevation)[:, None], cosine.shape)
    sun_theta = float(np.arccos(np.clip(sky.sun[2], -1.0, 1.0)))
    gamma = np.arccos(cosine)
    if sky.kind == "PREETHAM":
        return fitted_skies.preetham(sky.turbidity, sun_theta, theta, gamma)
    return fitted_skies.hosek_wilkie(sky.turbidity, sky.albedo, sun_theta, theta, gamma)


def _scattering(sky, elevation, azimuth):
    """Return the sky read from a table as coarse as Blender's, between its texels."""
    sun_elevation = float(np.arcsin(np.clip(sky.sun[2], -1.0, 1.0)))
    sun_azimuth = np.arctan2(-sky.sun[1], sky.sun[0])
    column = np.arange(_COLUMNS)
    whole = sky.kind == "MULTIPLE_SCATTERING"
    if whole:
        around = (column + 0.5) / _COLUMNS * 2.0 * np.pi
        line = (np.arange(_ROWS) + 0.5) / _ROWS * 2.0 - 1.0
        rising = np.sign(line) * line * line * _HALF
        root = np.sign(elevation) * np.sqrt(np.abs(elevation) / _HALF)
        rows = (0.5 * root + 0.5) * _ROWS - 0.5
    else:
        # This one ends at the horizon. Its texels are of their lower and outer edges.
        count = _ROWS // 2
        rising = (np.arange(count) / count) ** 2 * _HALF
        around = np.where(column < _COLUMNS // 2, column + 1, _COLUMNS - column)
        around = around / _COLUMNS * 2.0 * np.pi
        rows = np.sqrt(np.maximum(elevation, 0.0) / _HALF) * count - 0.5
    table = _MODELS[sky.kind].radiance(sky.atmosphere, sky.altitude, sun_elevation, rising, around)
    columns = ((azimuth - sun_azimuth) / (2.0 * np.pi) % 1.0) * _COLUMNS - 0.5
    image = _between(_between(table.astype(np.float32), rows, 0, False), columns, 1, True)
    if not whole:
        fade = np.clip(1.0 + elevation / _FADE, 0.0, 1.0) ** _FADE_POWER
        image *= fade[:, None, None].astype(np.float32)
    return image


def _between(table, places, axis, wraps):
    """Read a table between its texels along an axis."""
    size = table.shape[axis]
    low = np.floor(places).astype(int)
    share = (places - low).astype(np.float32)
    share = share[:, None, None] if axis == 0 else share[:, None]
    first, second = (
        np.take(table, i % size if wraps else np.clip(i, 0, size - 1), axis=axis)
        for i in (low, low + 1)
    )
    return first + (second - first) * share


def _disc(sky, elevation, azimuth):
    """Return the light of the sun's disc: darker at its edge, and redder at its lower side."""
    sun_elevation = float(np.arcsin(np.clip(sky.sun[2], -1.0, 1.0)))
    half = 0.5 * sky.disc
    image = np.zeros((len(elevation), len(azimuth), 3), np.float32)
    rows = np.flatnonzero((np.abs(elevation - sun_elevation) < half + 0.01) & (elevation > 0.0))
    if sun_elevation + half <= 0.0 or not len(rows):
        return image
    lower, upper = (
        _MODELS[sky.kind].sunlight(sky.atmosphere, sky.altitude, max(edge, 0.0))
        for edge in (sun_elevation - half, sun_elevation + half)
    )
    # A texel has the mean of its parts: the disc is few texels wide, each with much of its light.
    parts = (np.arange(_PARTS) + 0.5) / _PARTS - 0.5
    fine_rows = (elevation[rows, None] + parts * np.pi / len(elevation)).ravel()
    columns = np.flatnonzero(_columns_reached(azimuth, sky.sun, sun_elevation, half))
    fine_columns = (azimuth[columns, None] + parts * 2.0 * np.pi / len(azimuth)).ravel()
    angle = _angles(fine_rows, fine_columns, sky.sun) / half
    limb = 1.0 - _LIMB * (1.0 - np.sqrt(np.clip(1.0 - angle * angle, 0.0, 1.0)))
    limb[angle > 1.0] = 0.0
    height = ((fine_rows - sun_elevation) / sky.disc + 0.5)[:, None, None]
    solid = 2.0 * np.pi * (1.0 - np.cos(half))
    light = (lower + (upper - lower) * np.clip(height, 0.0, 1.0)) / solid
    fine = (sky.intensity * limb)[..., None] * light
    fine = fine.reshape(len(rows), _PARTS, len(columns), _PARTS, 3)
    image[np.ix_(rows, columns)] = fine.mean(axis=(1, 3))
    return image


def _columns_reached(azimuth, sun, sun_elevation, half):
    """Whether a disc, of half an angle, comes into columns of texels: at the zenith into all."""
    away = np.abs((azimuth - np.arctan2(-sun[1], sun[0]) + np.pi) % (2.0 * np.pi) - np.pi)
    if sun_elevation + half >= _HALF:
        return away >= 0.0
    texel = 2.0 * np.pi / len(azimuth)
    return away <= np.arcsin(np.sin(half) / np.cos(sun_elevation)) + texel


def _angles(elevation, azimuth, towards):
    """Return the angles of directions from a unit vector, shape (H, W); exact for small ones."""
    chord = directions(elevation, azimuth) - np.array(towards)
    return 2.0 * np.arcsin(np.minimum(0.5 * np.linalg.norm(chord, axis=-1), 1.0))
