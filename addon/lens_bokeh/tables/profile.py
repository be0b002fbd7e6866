"""The bokeh profile of a lens: patterns of axial points, and the paper's 2D table (methods 12).

The paper stores one table, the pattern of a point at 1000 mm over image distance and radius, and
maps focus and object depth to its rows by equal circles of confusion. That leaves out how
aberrations change with the object's distance and how a closed stop cuts the pattern from inside.
Here the profile is the *ray map* (see `ray_map`): a grid of 50 to 150 kilobytes a wavelength,
nine times that with a focus group. From it the pattern of any object distance, focus and f-number
is laid out in a millisecond (achromatic; see `mapping`). The paper's table is a product of it.

**Rows and radii.** A pattern is energy density over radius, on rings of equal width from 0 to the
*extent* R, the radius that holds all energy. R is part of each row: the size of the pattern near
focus comes from aberrations, where the circle of confusion would be 0. With x = r / R the
density stored is per unit of x, so ``sum_j density_j pi (x_(j+1)^2 - x_j^2) = 1`` in each channel.

**Colour.** A chromatic profile holds 25 wavelengths; each channel is their sum with the shares of
`sampling.spectrum.rgb_weights`, by the energy that each wavelength brings through, and is then
normalised by itself. So a flat spectrum is white over the whole pattern, in focus and out of it,
and what glass and coatings take of a channel does not tint the picture; that is told apart
(`PatternRow.brought`).

References
----------
Jeong et al., Real-time dynamic bokeh rendering with efficient look-up table sampling, 2020,
sections 5.2 and 5.3.
"""

from dataclasses import dataclass

import numpy as np

from ...errors import InputError, RenderCancelledError
from ...optics.glass import REFERENCE_WAVELENGTH_NM
from ...sampling.spectrum import rgb_weights, spectrum_wavelengths
from .focus_state import FocusState, state_at, trace_states
from .radial_energy import ring_energy

TABLE_ROWS = 1024
TABLE_RADII = 1024
# The paper's reference object, before the first principal plane.
REFERENCE_DISTANCE = 1000.0
# Rays between axis and rim of a row: edges and folds are then exact to a thousandth of the pattern.
_ROW_RAYS = 1025
# A pattern smaller than this, mm, is a point: far below any pixel and any wavelength.
SMALLEST_EXTENT = 1.0e-9


@dataclass(frozen=True)
class LensProfile:
    """The bokeh of a lens at one zoom position.

    Parameters
    ----------
    name : str
    label : str or None
        Of the zoom position.
    f_number : float
        Wide open, as the lens file tells it: stopping down scales the stop by it.
    wavelengths_nm : ndarray of shape (L,)
    nearness : ndarray of shape (S,)
        1 / distance from surface 1 at which each state is focused, 1/mm; (0,) if the whole lens
        is moved.
    states : tuple of FocusState
    color : ndarray of shape (L, channels)
        Share of each wavelength in each channel; columns sum to 1. One channel: achromatic.
    """

    name: str
    label: str | None
    f_number: float
    wavelengths_nm: np.ndarray
    nearness: np.ndarray
    states: tuple[FocusState, ...]
    color: np.ndarray

    @property
    def channels(self):
        """1 for an achromatic profile, 3 for a chromatic one."""
        return self.color.shape[1]

    def focused(self, distance):
        """Return the lens focused at a distance.

        Parameters
        ----------
        distance : float
            From H, mm; inf is allowed.

        Returns
        -------
        FocusState

        Raises
        ------
        FocusError
            If a focus group does not reach so near.
        """
        return state_at(self.nearness, self.states, distance)

    def stop_fraction(self, f_number):
        """Radius of the stop at an f-number over that wide open, 0 to 1.

        Parameters
        ----------
        f_number : float
            Smaller than wide open counts as wide open.

        Raises
        ------
        InputError
            If it is not positive.
        """
        if not f_number > 0.0:
            raise InputError(f"f-number {f_number:g} must be greater than 0")
        return min(1.0, self.f_number / f_number)


@dataclass(frozen=True)
class PatternRow:
    """The pattern of an axial point on one plane.

    Parameters
    ----------
    extent : float
        R, mm: the radius that holds all energy.
    density : ndarray of shape (radii, channels)
        Energy per unit of (r / R)^2-area on rings of equal width; integrates to 1.
    brought : ndarray of shape (channels,)
        Energy that came through before it was normalised, as an area in the entrance pupil, mm^2.
    """

    extent: float
    density: np.ndarray
    brought: np.ndarray

    @property
    def edges(self):
        """Edges of the rings in mm, shape (radii + 1,)."""
        return self.extent * np.linspace(0.0, 1.0, len(self.density) + 1)

    @property
    def energy(self):
        """Integral over the rings, by channel: 1."""
        return ring_areas(len(self.density)) @ self.density


@dataclass(frozen=True)
class ProfileTable:
    """Patterns of one axial point on many planes: the paper's table.

    Parameters
    ----------
    object_distance : float
        Before H, mm.
    planes : ndarray of shape (rows,)
        The z of each row, mm from surface 1.
    image_distances : ndarray of shape (rows,)
        From H' of the reference wavelength, mm: the u of the paper.
    extents : ndarray of shape (rows,)
        R, mm.
    density : ndarray of float32, shape (rows, radii, channels)
    """

    object_distance: float
    planes: np.ndarray
    image_distances: np.ndarray
    extents: np.ndarray
    density: np.ndarray

    @property
    def energies(self):
        """Integral of each row and channel, shape (rows, channels): 1."""
        areas = ring_areas(self.density.shape[1])
        return np.einsum("r,krc->kc", areas, self.density.astype(np.float64))


def make_profile(
    configuration,
    *,
    name="",
    focus_group=None,
    chromatic=True,
    wavelengths_nm=None,
    coating=None,
    fresnel=False,
    progress=None,
    cancelled=None,
):
    """Trace the profile of a lens.

    Parameters
    ----------
    configuration : Configuration
        Wide open.
    name : str
    focus_group : FocusGroup or None
        None: the whole lens is moved for focusing.
    chromatic : bool
        Whether to take the spectrum into RGB, or the reference wavelength alone.
    wavelengths_nm : array_like or None
        Other wavelengths than the usual 25, or than the reference.
    coating : Coating or None
    fresnel : bool
        Whether rays lose what the surfaces reflect.
    progress : callable or None
        Called with the share done, 0 to 1.
    cancelled : callable or None
        Asked between steps; true ends the work.

    Returns
    -------
    LensProfile

    Raises
    ------
    PrescriptionError
        If the lens forms no image.
    RenderCancelledError
        If it was cancelled.
    """
    if wavelengths_nm is None:
        wavelengths_nm = spectrum_wavelengths() if chromatic else [REFERENCE_WAVELENGTH_NM]
    wavelengths = np.asarray(wavelengths_nm, dtype=np.float64)
    step = _watched(progress, cancelled)
    step(0.0)
    color = rgb_weights(wavelengths) if chromatic else np.full((len(wavelengths), 1), 1.0)
    nearness, states = trace_states(
        configuration,
        wavelengths,
        focus_group=focus_group,
        coating=coating,
        fresnel=fresnel,
        step=step,
    )
    return LensProfile(
        name,
        configuration.label,
        configuration.f_number,
        wavelengths,
        nearness,
        states,
        color / color.sum(axis=0),
    )


def profile_table(
    profile,
    object_distance=REFERENCE_DISTANCE,
    *,
    rows=TABLE_ROWS,
    radii=TABLE_RADII,
    f_number=None,
    span=None,
    progress=None,
    cancelled=None,
):
    """Lay out the paper's table: energy over radius, for planes about the sensor.

    A lens with a focus group stands at infinity.

    Parameters
    ----------
    profile : LensProfile
    object_distance : float
        Before the first principal plane, mm.
    rows, radii : int
    f_number : float or None
        None: wide open.
    span : float or None
        Planes reach this far before and behind the infinity focus, mm; None: the distance from the
        last surface, as in the paper, or the focal length if the focus lies inside the lens.
    progress, cancelled : callable or None
        As for `make_profile`.

    Returns
    -------
    ProfileTable
    """
    step = _watched(progress, cancelled)
    state = profile.states[0]
    ray_map, order = state.ray_map, state.first_order
    if span is None:
        span = order.bfl if order.bfl > 0.0 else order.efl
    planes = ray_map.plane + span * np.linspace(-1.0, 1.0, rows)
    opening = 1.0 if f_number is None else profile.stop_fraction(f_number)
    vergence = state.vergence(object_distance)
    fan = ray_map.rays(vergence, opening, _ROW_RAYS)
    density = np.empty((rows, radii, profile.channels), np.float32)
    extents = np.empty(rows)
    for i, plane in enumerate(planes):
        row = row_of_fan(fan, plane - ray_map.plane, profile.color, radii)
        density[i], extents[i] = row.density, row.extent
        if i % 32 == 31:
            step((i + 1) / rows)
    image_distances = planes - state.last_vertex - order.h_prime
    return ProfileTable(object_distance, planes, image_distances, extents, density)


def row_of_fan(fan, shift, color, radii):
    """Lay out the pattern of traced rays on a plane.

    Parameters
    ----------
    fan : tuple of ndarray
        Height, slope and effective pupil radius of rays, from `RayMap.rays`.
    shift : float
        Of the plane from that of the heights, mm.
    color : ndarray of shape (L, channels)
    radii : int

    Returns
    -------
    PatternRow
    """
    height, slope, energy_radius = fan
    across = height + shift * slope
    extent = max(float(np.abs(across).max()), SMALLEST_EXTENT)
    edges = extent * np.linspace(0.0, 1.0, radii + 1)
    energy = np.empty((len(across), radii))
    for i in range(len(across)):
        energy[i] = ring_energy(across[i], energy_radius[i], edges)
    colored = energy.T @ color
    total = colored.sum(axis=0)
    return PatternRow(extent, colored / total / ring_areas(radii)[:, None], total)


def ring_areas(radii):
    """Areas of rings of equal width in the unit disk.

    Parameters
    ----------
    radii : int

    Returns
    -------
    ndarray of shape (radii,)
    """
    return np.pi * np.diff(np.linspace(0.0, 1.0, radii + 1) ** 2)


def _watched(progress, cancelled):
    def step(share):
        if cancelled and cancelled():
            raise RenderCancelledError("the lens profile was cancelled")
        if progress:
            progress(share)

    return step
