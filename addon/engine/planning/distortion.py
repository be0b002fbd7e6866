"""Distortion of the picture: the size of an undistorted raster, and the mapping between both.

Everything is drawn undistorted, in a raster that covers what the distorted picture shows; the
picture is then resampled from it, once. Division model (methods 13, `optics.distortion`) over the
field, the plane at 1 m from the lens (see `engine.planning.chromatic`): the place d of the
distorted picture shows the undistorted place ``u = d / (1 + K1 s + K2 s^2 + ...)``, ``s = |d|^2``.
The centre is the optical axis; Ki are in units of the distance of the picture's outermost corner
from it. Farther out, which only a viewport shows, the scale is that of the corner.

A barrel shows more of the scene than the frame holds. A pincushion enlarges its corners: the raster
is as fine as they need, within a limit. The pixel filter is that of a pixel of the raster; where
those are smaller than the picture's, the sampling is blurred by the rest.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...optics.distortion import TERMS, distorted_radius, divisor, most_magnified, slope
from .bokeh_plan import filter_width
from .field_table import field_of_raster, picture_radius

# Most pixels of the raster along one of the picture: four times the work.
_FINEST = 2.0
# Margin of the raster, px: the reach of the resampling filter and its blur.
_RIM = 4


@dataclass(frozen=True, eq=False)
class DistortionPlan:
    """Mapping from the pixels of a distorted picture to the undistorted raster.

    Parameters
    ----------
    terms : tuple of 4 float
        Ki of the division model, per even powers of the field's unit.
    radius : float
        Distance of the picture's outermost corner from the axis in the field.
    width, height : int
        Size of the picture, px.
    to_field : ndarray of shape (4,)
        From places in the picture, px, to the field: scale and offset, x and y each.
    from_field : ndarray of shape (4,)
        From the field to places in the raster, px.
    fineness : float
        Pixels of the raster along one of the picture, on the axis.
    filter_width : float
        Side of the box with the variance of the pixel filter, px.
    """

    terms: tuple[float, ...]
    radius: float
    width: int
    height: int
    to_field: np.ndarray
    from_field: np.ndarray
    fineness: float
    filter_width: float

    def sources(self, places):
        """Convert places of the picture to places of the raster.

        Parameters
        ----------
        places : ndarray of shape (..., 2)
            In px.

        Returns
        -------
        ndarray of shape (..., 2)
            In px.
        """
        field = places * self.to_field[:2] + self.to_field[2:]
        return field * self._factor(field) * self.from_field[:2] + self.from_field[2:]

    def pictured(self, sources):
        """Convert places of the raster to places of the picture; the inverse of `sources`."""
        field = (sources - self.from_field[2:]) / self.from_field[:2]
        reach = np.linalg.norm(field, axis=-1, keepdims=True)
        corner = float(divisor(self.radius**2, self.terms))
        inside = reach <= self.radius / corner
        places = distorted_radius(np.where(inside, reach, 0.0), self.terms)
        scale = np.divide(places, reach, out=np.ones_like(reach), where=inside & (reach > 0.0))
        field = field * np.where(inside, scale, corner)
        return (field - self.to_field[2:]) / self.to_field[:2]

    def growth(self, places):
        """Return the magnification: pixels of the raster along a pixel of the picture.

        Parameters
        ----------
        places : ndarray of shape (..., 2)
            In the picture, px.

        Returns
        -------
        ndarray of shape (..., 2)
            Radially and tangentially.
        """
        field = places * self.to_field[:2] + self.to_field[2:]
        square = np.sum(field**2, axis=-1, keepdims=True)
        across = self._factor(field)
        along = np.where(square < self.radius**2, across**2 * slope(square, self.terms), across)
        return self.fineness * np.concatenate([along, across], axis=-1)

    def centres(self):
        """Return the centres of the picture's pixels, shape (height, width, 2), px."""
        x, y = np.arange(self.width) + 0.5, np.arange(self.height) + 0.5
        return np.stack(np.meshgrid(x, y), axis=-1)

    def nearest(self, size):
        """Return the nearest pixel of the raster for each of the picture's: rows and columns.

        Parameters
        ----------
        size : tuple of 2 int
            Width and height of the raster.

        Returns
        -------
        tuple of 2 ndarray of shape (height, width)
        """
        places = np.floor(self.sources(self.centres())).astype(int)
        places = np.clip(places, 0, np.array(size) - 1)
        return places[..., 1], places[..., 0]

    def _factor(self, field):
        square = np.sum(field**2, axis=-1, keepdims=True)
        return 1.0 / divisor(np.minimum(square, self.radius**2), self.terms)


def plan_distortion(snapshot):
    """Plan the distortion of a frame.

    Parameters
    ----------
    snapshot : SceneSnapshot

    Returns
    -------
    distortion : DistortionPlan or None
        None where there is none.
    snapshot : SceneSnapshot
        With the film of the undistorted raster; without distortion the one given.
    """
    camera, film = snapshot.camera, snapshot.film
    if not any(camera.distortion):
        return None, snapshot
    terms = (*camera.distortion, *(0.0,) * (TERMS - len(camera.distortion)))
    x, y, width, height = film.region
    radius = camera.field_radius or picture_radius(camera.projection, camera.orthographic)
    # Chosen for the whole frame, so that render regions have the same pixels.
    fineness = min(max(1.0, most_magnified(terms)), _FINEST)
    if snapshot.stack is not None:
        # A captured picture is as fine as its pixels.
        fineness = 1.0
    to_field = field_of_raster(camera.projection, film)
    whole = field_of_raster(camera.projection, replace(film, region=(0, 0, *film.region[2:])))
    from_field = np.concatenate([fineness / whole[:2], -fineness * whole[2:] / whole[:2]])
    distortion = DistortionPlan(
        terms=tuple(k / radius ** (2 * power) for power, k in enumerate(terms, 1)),
        radius=radius,
        width=width,
        height=height,
        to_field=to_field,
        from_field=from_field,
        fineness=fineness,
        filter_width=filter_width(film.filter_kind, film.filter_size_px),
    )
    low, high = _covered(distortion)
    distortion = replace(distortion, from_field=from_field - (0.0, 0.0, *low))
    columns, rows = (high - low).tolist()
    crop = _crop(fineness * np.array([film.width, film.height]), low, high)
    wide = replace(
        camera,
        projection=crop @ camera.projection,
        previous=camera.previous and (camera.previous[0], crop @ camera.previous[1]),
        next=camera.next and (camera.next[0], crop @ camera.next[1]),
        field_radius=radius,
    )
    film = replace(film, width=columns, height=rows, region=(0, 0, columns, rows))
    return distortion, replace(snapshot, camera=wide, film=film)


def _covered(distortion):
    """Return the corners, in whole pixels, of the part of the raster that the picture shows."""
    across, up = (np.linspace(0.0, n, 4 * n + 1) for n in (distortion.width, distortion.height))
    # The mapping is continuous and invertible: its extent is that of the picture's edge.
    edge = np.concatenate(
        [
            np.stack(np.broadcast_arrays(x, y), axis=-1)
            for x, y in (
                (across, 0.0),
                (across, float(distortion.height)),
                (0.0, up),
                (float(distortion.width), up),
            )
        ]
    )
    reached = distortion.sources(edge)
    low = np.floor(reached.min(axis=0)).astype(int) - _RIM
    return low, np.ceil(reached.max(axis=0)).astype(int) + _RIM


def _crop(size, low, high):
    """Return the matrix that restricts a picture's clip space to a part of it, both in px."""
    crop = np.eye(4)
    crop[[0, 1], [0, 1]] = size / (high - low)
    crop[:2, 3] = (size - low - high) / (high - low)
    return crop
