"""The real lens of a frame's samples: tables over its picture, and the light of each sample.

The exposure is even, or that of the lens. Even: the light of the samples is divided, at each place
of the picture, by that of all of them, so that the lens takes no light away, whatever its rims do.
Where next to none comes through, a little is added to all samples alike. As the lens: it is divided
by the light of the picture's optical axis.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...errors import AplanatError
from ...lens_bokeh.samples.lens_rays import lens_rays
from ...lens_bokeh.samples.sample_tables import SampleTables, field_grid, sample_tables
from .field_table import field_of_raster

# Share of the picture's sides that points beyond its edges are told apart, too.
_MARGIN = 0.15
# Light of a place of the picture over that of the axis, below which an even exposure lets some by.
_DARK = 0.02
# Samples whose light is added up to begin with; the sums of all are divided by in the end.
_TYPICAL = 256
# Fields are traced up to a step, so that a little larger picture has the same.
_STEPS = 16.0


@dataclass(frozen=True, eq=False)
class RealLensPlan:
    """The real lens of a frame's samples.

    Parameters
    ----------
    tables : SampleTables
    even : bool
        Exposure: even, else as the lens.
    spacing : float
        Of the samples, in radii of the iris.
    base : ndarray of shape (rows, columns) or (1, 1)
        Light that counts as 1.
    floor : ndarray of shape (rows, columns) or (1, 1)
        Added to the light of each sample.
    """

    tables: SampleTables
    even: bool
    spacing: float
    base: np.ndarray
    floor: np.ndarray

    def light(self, lens_positions):
        """Return the weights of lens samples over the picture.

        Parameters
        ----------
        lens_positions : ndarray of shape (N, 2)
            In m.

        Returns
        -------
        ndarray of float32, shape (N, rows, columns)
            About 1 in the mean over the samples of an even exposure.
        """
        found = self.tables.light(lens_positions, self.spacing)
        return ((found + self.floor) / self.base).astype(np.float32)

    @property
    def grid(self):
        """The `FieldGrid` of the light."""
        return self.tables.light_grid


def plan_real_lens(camera, film, lens, lens_positions):
    """Plan the real lens of a frame's samples.

    Parameters
    ----------
    camera : Camera
        With a `real_lens`.
    film : Film
    lens : ThinLens
        Of the camera.
    lens_positions : ndarray of shape (N, 2)
        In m.

    Returns
    -------
    plan : RealLensPlan or None
        None where the lens cannot be traced: the samples are those of the thin lens.
    report : tuple of str
        Warnings, one sentence each.
    """
    settings = camera.real_lens
    scale_x, scale_y, *low = field_of_raster(camera.projection, film)
    low = np.array(low)
    high = low + np.array([scale_x, scale_y]) * film.region[2:]
    low, high = np.minimum(low, high), np.maximum(low, high)
    name = settings.prescription.name
    try:
        rays = _rays(_Lens(settings), lens.focus_distance, _reach(low, high))
    except AplanatError as error:
        return None, (f"lens '{name}' shapes no lens samples, a thin lens does: {error}",)
    tables = sample_tables(
        rays,
        field_grid(low, high),
        field_grid(low, high, _MARGIN),
        lens.aperture_radius,
        lens.iris.ratio,
    )
    spacing = float(np.sqrt(np.pi / len(lens_positions)))
    axis = float(tables.axial_light(lens_positions, spacing).mean())
    if settings.exposure == "LENS":
        unit, none = np.full((1, 1), axis), np.zeros((1, 1))
        return RealLensPlan(tables, False, spacing, unit, none), ()
    step = -(-len(lens_positions) // _TYPICAL)
    mean = tables.light(lens_positions[::step], spacing).mean(axis=0)
    floor = np.maximum(_DARK * axis - mean, 0.0)
    report = ()
    if floor.any():
        report = (
            f"lens '{name}' lets next to no light through at the edge of the picture; it is drawn"
            " as if it did (a smaller sensor, or Exposure: As the Lens)",
        )
    return RealLensPlan(tables, True, spacing, mean + floor, floor), report


def _reach(low, high):
    """Return the tangent of the outermost field that is wanted, rounded up."""
    wider = _MARGIN * (high - low)
    corner = float(np.hypot(*np.maximum(np.abs(low - wider), np.abs(high + wider))))
    return float(2.0 ** (np.ceil(np.log2(corner) * _STEPS) / _STEPS))


class _Lens:
    """A real lens as a cache key."""

    def __init__(self, settings):
        self.settings = settings

    def _key(self):
        return self.settings.id, self.settings.label, self.settings.f_number

    def __eq__(self, other):
        same = self.settings.prescription == other.settings.prescription
        return self._key() == other._key() and same

    def __hash__(self):
        return hash(self._key())


# Memo of its arguments alone: a picture asks for the same again and again.
@lru_cache(maxsize=4)
def _rays(lens, focus_distance, tangent):
    settings = lens.settings
    return lens_rays(
        settings.prescription, settings.label, focus_distance, settings.f_number, tangent
    )
