"""The real lens of a frame's samples: tables over its picture, and the light of each sample.

The light that samples bring to each place of the picture is divided by that of all of them, so that
an even world is even, however few they are and whatever the rims cut: *even exposure*. *As the
lens* multiplies it by what a great many samples bring there, over the same on the picture's optical
axis. Where next to no light comes through, a little is added to all samples alike; and a trace
everywhere, so that what few samples see, none of which the lens lets through, is no hole.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ...errors import AplanatError, FocusError
from ...lens_bokeh.samples.artist_rays import ArtistRays
from ...lens_bokeh.samples.cylinder_rays import CylinderRays
from ...lens_bokeh.samples.field_grid import field_grid
from ...lens_bokeh.samples.lens_colors import LensColors
from ...lens_bokeh.samples.lens_rays import lens_rays
from ...lens_bokeh.samples.sample_tables import SampleTables, sample_tables
from ...lens_bokeh.tables.artist_lens import opening_at
from ...optics.distortion import divisor
from ...sampling.sequence import lens_samples
from .field_table import field_of_raster, picture_radius

# Share of the picture's sides that points beyond its edges are told apart, too.
_MARGIN = 0.15
# Light of a place of the picture over that of the axis, below which some is let by.
_DARK = 0.02
# The trace of light that every sample has everywhere, over that of the axis: half a percent of what
# `_DARK` leaves, and enough to divide by.
_TRACE = 1e-4
# Samples whose mean is the light of the lens; of them, how many are looked at for bounds.
_MANY, _TYPICAL = 1024, 64
# Steps over the vergences for bounds, and what is added for samples that were not looked at.
_LOOKS, _SURE = 5, 1.1
# Fields are traced up to a step, so that a little larger picture has the same.
_STEPS = 16.0


@dataclass(frozen=True, eq=False)
class RealLensPlan:
    """The real lens of a frame's samples.

    Parameters
    ----------
    tables : SampleTables
    base : ndarray of shape (rows, columns)
        Light that counts as 1, at the nodes of the light.
    floor : ndarray of shape (rows, columns)
        Added to the light of each sample.
    falloff : ndarray of shape (rows, columns)
        Light of the picture over that of an even one: 1 with an even exposure.
    most_moved : float
        Bound of what the lens adds to the thin lens' displacement, as a tangent, up to the largest
        vergence of the tables.
    most_blurred : float
        Bound of how far it moves samples apart beyond the thin lens, as a tangent.
    spacing : float
        Of the samples, in radii of the iris.
    colors : LensColors or None
        What other wavelengths change; None: all are like the reference.
    strengths : tuple of 2 float
        Factors of the axial and the lateral part of that.
    parts_colors : bool
        The colours of the picture are those; else those of a thin lens are drawn.
    is_dark : bool
        Next to no light comes through somewhere in the picture.
    cylinders : CylinderRays or None
        The rays of a lens that has some.
    """

    tables: SampleTables
    base: np.ndarray
    floor: np.ndarray
    falloff: np.ndarray
    most_moved: float
    most_blurred: float
    spacing: float = 0.0
    colors: LensColors | None = None
    strengths: tuple[float, float] = (1.0, 1.0)
    parts_colors: bool = False
    is_dark: bool = False
    cylinders: CylinderRays | None = None

    def with_samples(self, count):
        """Return the plan for a number of samples."""
        return replace(self, spacing=float(np.sqrt(np.pi / count)))

    def color_shares(self, wavelengths_nm):
        """Return what samples of wavelengths have of the traced colours, as `SampleTables.moves`.

        Parameters
        ----------
        wavelengths_nm : ndarray of shape (N,)

        Returns
        -------
        ndarray of shape (N, 2, K) or None
        """
        if self.colors is None:
            return None
        return self.colors.shares(wavelengths_nm)[:, None] * np.array(self.strengths)[:, None]

    def light(self, lens_positions):
        """Return the weights of lens samples over the picture.

        Parameters
        ----------
        lens_positions : ndarray of shape (N, 2)
            In m.

        Returns
        -------
        ndarray of float32, shape (N, rows, columns)
            About 1 in the mean over the samples.
        """
        found = self.tables.light(lens_positions, self.spacing)
        return ((found + self.floor) / self.base).astype(np.float32)

    @property
    def corner(self):
        """Distance of the farthest field that was traced from the axis, as a tangent."""
        return max(float(np.abs(self.grid.low).max()), float(np.abs(self.grid.high).max()))

    @property
    def grid(self):
        """The `FieldGrid` of the light."""
        return self.tables.light_grid

    def bound(self, nearest):
        """Bound of what the lens adds to the displacement of points from a depth (m) on."""
        tables = self.tables
        beyond = 1.0 / max(nearest, 1e-9) - tables.focus_vergence
        reach = tables.largest_vergence - tables.focus_vergence
        return self.most_moved * max(beyond / reach, 1.0)

    def growth(self, farthest):
        """Return how much farther points move than those of a thin lens.

        Parameters
        ----------
        farthest : ndarray of shape (...)
            Depth, m.

        Returns
        -------
        ndarray of shape (...)
            Bound for that depth and all nearer ones, m.
        """
        tables = self.tables
        near = 1.0 / (tables.largest_vergence - tables.focus_vergence)
        return self.most_moved * (np.maximum(farthest, 0.0) + near)


def plan_real_lens(camera, film, lens):
    """Plan the real lens of a frame's samples.

    Parameters
    ----------
    camera : Camera
        With a `real_lens`, or an artist's.
    film : Film
    lens : ThinLens
        Of the camera.

    Returns
    -------
    plan : RealLensPlan or None
        None where the lens cannot be traced: the samples are those of the thin lens.
    report : tuple of str
        Warnings, one sentence each.

    Raises
    ------
    FocusError
        If the lens cannot be focused there: then its discs cannot be traced either.
    """
    scale_x, scale_y, *low = field_of_raster(camera.projection, film)
    low = np.array(low)
    high = low + np.array([scale_x, scale_y]) * film.region[2:]
    low, high = np.minimum(low, high), np.maximum(low, high)
    corners = (*low.tolist(), *high.tolist())
    if camera.real_lens is None:
        return _plan(artist_rays(camera), _Thin(lens), corners, _outermost(camera), None), ()
    name = camera.real_lens.prescription.name
    try:
        colors = _colors(camera.chromatic)
        made = _plan(_Lens(camera.real_lens), _Thin(lens), corners, _outermost(camera), colors)
    except FocusError:
        raise
    except AplanatError as error:
        # Its discs may be traced all the same.
        return None, (f"lens samples do without lens '{name}' and are a thin lens': {error}",)
    report = ()
    if made.is_dark and camera.real_lens.exposure == "EVEN":
        report = (
            f"lens '{name}' lets next to no light through at the edge of the picture; it is drawn"
            " as if it did (a smaller sensor, or Exposure: As the Lens)",
        )
    return made, report


def _colors(aberration):
    """Return the strengths and the range of wavelengths of a lens' own colours, or None."""
    if aberration is None or not aberration.of_lens:
        return None
    return aberration.axial, aberration.lateral, *aberration.extremes_nm


# Memo of its arguments alone: a picture asks for the same again and again.
@lru_cache(maxsize=4)
def _plan(key, thin, corners, outermost, colors):
    lens = thin.lens
    low, high = np.array(corners[:2]), np.array(corners[2:])
    if isinstance(key, ArtistRays):
        rays = key
    else:
        sides = None
        if not key.settings.shapes_bokeh:
            sides = tuple(_reach(each) for each in np.maximum(np.abs(low), np.abs(high)))
        rays = _rays(key, lens.focus_distance, _reach(outermost), sides, colors is not None)
    grids = field_grid(low, high), field_grid(low, high, _MARGIN)
    tables = sample_tables(rays, *grids, lens.aperture_radius, lens.iris.ratio, outermost)
    places = lens_samples(0, _MANY, lens.iris) * lens.aperture_radius
    spacing = float(np.sqrt(np.pi / _MANY))
    axis = float(tables.axial_light(places, spacing).mean())
    mean = tables.light(places, spacing).mean(axis=0)
    lacking = np.maximum(_DARK * axis - mean, 0.0)
    floor = lacking + _TRACE * axis
    falloff = np.ones_like(mean)
    if key.loses_light:
        falloff = mean / axis
    own = colors is not None and rays.parts_colors
    plan = RealLensPlan(
        tables,
        mean + floor,
        floor,
        falloff,
        0.0,
        0.0,
        parts_colors=own,
        is_dark=bool(lacking.any()),
    )
    if not rays.of_revolution:
        plan = replace(plan, cylinders=rays)
    if rays.colors is not None:
        plan = replace(plan, colors=rays.colors, strengths=colors[:2])
    moved, apart = _bounds(plan, np.append(places[:_TYPICAL], [[0.0, 0.0]], axis=0), colors)
    return replace(plan, most_moved=_SURE * moved, most_blurred=_SURE * apart)


def _bounds(plan, places, colors):
    """Return how far samples move points, and apart, over all wavelengths, as tangents."""
    shares = [None]
    if plan.colors is not None:
        shares += [plan.color_shares(np.full(len(places), nm)) for nm in colors[2:]]
    powers = np.linspace(0.0, 1.0, _LOOKS)[:, None] ** np.arange(4)
    bounds = []
    for each in shares:
        moves = np.einsum("vk,nyxkc->nvyxc", powers, plan.tables.moves(places, each))
        # The last is the lens' middle.
        pair = moves, moves - moves[-1:]
        bounds.append([np.linalg.norm(part, axis=-1).max() for part in pair])
    return np.max(bounds, axis=0).tolist()


def artist_rays(camera):
    """Return the `ArtistRays` of a camera with an artist's lens and a thin one to add them to."""
    lens, opening = camera.lens, opening_at(camera.f_number)
    thin = lens.aperture_radius, 1.0 / lens.focus_distance
    return ArtistRays(camera.artist, opening, corner_of(camera), *thin)


def corner_of(camera):
    """Return the distance of the corner of the camera's own picture from the axis, a tangent."""
    return camera.field_radius or picture_radius(camera.projection, camera.orthographic)


def _outermost(camera):
    """Return the tangent of the farthest field that the camera's own picture shows.

    It does not depend on the part that is drawn: a region, or more around it in a viewport.
    """
    # A barrel shows what lies beyond.
    return corner_of(camera) / min(float(divisor(1.0, camera.distortion)), 1.0)


def _reach(outermost):
    """Return the tangent of the farthest field that is traced, rounded up."""
    wider = (1.0 + 2.0 * _MARGIN) * outermost
    return float(2.0 ** (np.ceil(np.log2(wider) * _STEPS) / _STEPS))


class _Lens:
    """A real lens as a cache key."""

    def __init__(self, settings):
        self.settings = settings
        self.loses_light = settings.exposure == "LENS"

    def _key(self):
        own = self.settings
        return own.id, own.label, own.f_number, own.exposure

    def __eq__(self, other):
        same = self.settings.prescription == other.settings.prescription
        return self._key() == other._key() and same

    def __hash__(self):
        return hash(self._key())


class _Thin:
    """A thin lens as a cache key; its iris may hold a picture."""

    def __init__(self, lens):
        self.lens = lens

    def __eq__(self, other):
        return self.lens == other.lens

    def __hash__(self):
        return hash((self.lens.aperture_radius, self.lens.focus_distance))


# Memo of its arguments alone: as of `_plan`, whatever part of the field is shown.
@lru_cache(maxsize=4)
def _rays(lens, focus_distance, tangent, sides, colored):
    settings = lens.settings
    state = settings.prescription, settings.label, focus_distance, settings.f_number, tangent
    return lens_rays(*state, sides=sides, colored=colored)
