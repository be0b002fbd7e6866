"""Vignetting: the share of a beam that gets through the lens at a field angle."""

from dataclasses import dataclass

import numpy as np

from ..glass import REFERENCE_WAVELENGTH_NM
from ..paraxial import entrance_pupil
from .beam import Beam
from .pupil import grid_of, is_open, passing, pupil_box, stop_outline, without_rims
from .trace import Rays, trace

# Largest field angle that is searched, degrees: lens files go up to 90.
LARGEST_FIELD_DEG = 89.9


@dataclass(frozen=True)
class Vignetting:
    """Light of an object at infinity that gets through a lens, at one field angle.

    Parameters
    ----------
    field_deg : float
        Between the beam and the axis, degrees.
    area_passing : float
        Of the beam that clears every rim and the stop, across the beam, mm^2.
    area_stop_only : float
        Of the beam that clears the stop with all other rims out of the way, and finds its way to
        the sensor, mm^2. Rays that take a second way to the stop far outside the rims are not
        counted.
    unvignetted_fraction : float
        `area_passing` over `area_stop_only`; 0 where nothing clears the stop.
    fraction_of_paraxial_pupil : float
        Share of points spread evenly over the paraxial entrance pupil whose ray passes.
    """

    field_deg: float
    area_passing: float
    area_stop_only: float
    unvignetted_fraction: float
    fraction_of_paraxial_pupil: float


def vignetting(configuration, field_deg, wavelength_nm=REFERENCE_WAVELENGTH_NM, grid=401):
    """Measure the vignetting of a beam from infinity in the direction (0, sin a, cos a).

    Parameters
    ----------
    configuration : Configuration
    field_deg : float
        Angle a, degrees.
    wavelength_nm : float
    grid : int
        Rays along each side of the box around the pupil.

    Returns
    -------
    Vignetting

    Raises
    ------
    PrescriptionError
        If the field angle is not below 90 degrees, or the entrance pupil is at infinity.
    """
    beam = Beam.from_infinity(field_deg)
    open_area = area_passing(configuration, beam, wavelength_nm, grid)
    stop_area = _area_stop_only(configuration, beam, wavelength_nm, grid)
    return Vignetting(
        field_deg=float(field_deg),
        area_passing=open_area,
        area_stop_only=stop_area,
        unvignetted_fraction=open_area / stop_area if stop_area > 0.0 else 0.0,
        fraction_of_paraxial_pupil=_paraxial_share(configuration, beam, wavelength_nm, grid),
    )


def area_passing(configuration, beam, wavelength_nm=REFERENCE_WAVELENGTH_NM, grid=401):
    """Area of a parallel beam that gets through the lens.

    Parameters
    ----------
    configuration : Configuration
    beam : Beam
        Of an object at infinity.
    wavelength_nm : float
    grid : int

    Returns
    -------
    float
        mm^2, across the beam.
    """
    box = pupil_box(configuration, beam, wavelength_nm)
    if box is None:
        return 0.0
    coordinates, cell = grid_of(box, grid)
    return cell * int(np.count_nonzero(passing(configuration, beam, coordinates, wavelength_nm)))


def coverage(configuration, share=0.0, wavelength_nm=REFERENCE_WAVELENGTH_NM, grid=101):
    """Find the largest field angle that the lens covers.

    Parameters
    ----------
    configuration : Configuration
    share : float
        Of the pupil's area on the axis that must be open; at 0 any ray will do.
    wavelength_nm : float
    grid : int
        Rays along each side of the box around the pupil.

    Returns
    -------
    float
        Degrees, to 0.01; 0 if nothing gets through on the axis. At most `LARGEST_FIELD_DEG`.
    """

    def area(field_deg):
        return area_passing(configuration, Beam.from_infinity(field_deg), wavelength_nm, grid)

    wanted = share * area(0.0)

    def is_covered(field_deg):
        if share > 0.0:
            return area(field_deg) >= wanted
        return is_open(configuration, float(field_deg), wavelength_nm)

    if not is_covered(0.0):
        return 0.0
    # Upwards first: beyond the edge of the picture light may find a way again past some rims.
    inside, outside = 0.0, LARGEST_FIELD_DEG
    for field in np.arange(5.0, LARGEST_FIELD_DEG, 5.0):
        if not is_covered(field):
            outside = float(field)
            break
        inside = float(field)
    else:
        if is_covered(outside):
            return outside
    while outside - inside > 0.01:
        middle = 0.5 * (inside + outside)
        inside, outside = (middle, outside) if is_covered(middle) else (inside, middle)
    return inside


def _area_stop_only(configuration, beam, wavelength_nm, grid):
    outline = stop_outline(configuration, beam, wavelength_nm=wavelength_nm)
    if not len(outline.points):
        return 0.0
    coordinates, cell = grid_of(outline.box, grid)
    bare = without_rims(configuration)
    return cell * int(np.count_nonzero(passing(bare, beam, coordinates, wavelength_nm)))


def _paraxial_share(configuration, beam, wavelength_nm, grid):
    z, diameter = entrance_pupil(configuration, wavelength_nm)
    places, _ = grid_of((-1.0, 1.0, -1.0, 1.0), grid)
    places = 0.5 * diameter * places[np.sum(places**2, axis=1) <= 1.0]
    origins = np.concatenate([places, np.full((len(places), 1), z)], axis=1)
    rays = Rays(origins, np.broadcast_to(beam.axis, origins.shape))
    return float(trace(configuration, rays, wavelength_nm).passed.mean())
