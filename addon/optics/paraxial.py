"""First-order optics of a lens: focal length, principal planes, pupils, conjugates.

Rays near the axis are pairs (height y, n times slope); a surface and a distance are matrices of
determinant 1 on them. With the lens' matrix [[A, B], [C, D]] and n' the index behind it,
`EFL = -n' / C`, `BFL = -n' A / C`, `FFL = D / C`, in mm. An even asphere bends rays near the axis
by `c + 2 a_2`. A cylinder acts in the meridian along which it curves.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..errors import PrescriptionError
from .glass import REFERENCE_WAVELENGTH_NM
from .media import indices

# Least power of a lens, 1/mm: with less its focus is beyond 1000 km, and its value is rounding.
LEAST_POWER = 1.0e-9
# Largest magnification of a pupil: beyond, it is an image at infinity, as the stop is in the focal
# plane of the elements on that side, to the digits of prescriptions.
LARGEST_PUPIL = 1.0e6


@dataclass(frozen=True)
class FirstOrder:
    """First-order values of a lens in one meridian, in mm.

    Parameters
    ----------
    efl : float
        Rear effective focal length.
    bfl : float
        Last vertex to rear focal point.
    ffl : float
        Vertex of surface 1 to front focal point; negative in front of it.
    h : float
        Vertex of surface 1 to the first principal plane.
    h_prime : float
        Last vertex to the second principal plane; negative before it.
    enp_z : float
        Vertex of surface 1 to the entrance pupil.
    enp_diameter : float
        Of the stop's image in object space.
    exp_z, exp_diameter : float or None
        Last vertex to the exit pupil, and its diameter; None for a pupil at infinity.
    f_number : float
        EFL over entrance pupil diameter, object at infinity.
    """

    efl: float
    bfl: float
    ffl: float
    h: float
    h_prime: float
    enp_z: float
    enp_diameter: float
    exp_z: float | None
    exp_diameter: float | None
    f_number: float


def ray_matrix(configuration, wavelength_nm, meridian="y", first=1, last=None):
    """Matrix of surfaces and the distances between them, on (height, index times slope).

    Parameters
    ----------
    configuration : Configuration
    wavelength_nm : float
    meridian : {"x", "y"}
    first, last : int
        Outermost surfaces, from 1; None: the last one. `last` may be ``first - 1``: no surface.

    Returns
    -------
    ndarray of shape (2, 2)
        From in front of surface `first` to behind surface `last`; not finite where it overflows.

    Raises
    ------
    PrescriptionError
        If a glass has no index at the wavelength.
    """
    media = indices(configuration, wavelength_nm)
    last = len(configuration.surfaces) if last is None else last
    matrix = np.eye(2)
    with np.errstate(all="ignore"):
        for number in range(first, last + 1):
            if number > first:
                gap = configuration.surfaces[number - 2].thickness
                matrix = transfer(gap, media[number - 1]) @ matrix
            bend = _vertex_curvature(configuration.surfaces[number - 1], meridian)
            power = np.float64(media[number] - media[number - 1]) * bend
            matrix = np.array([[1.0, 0.0], [-power, 1.0]]) @ matrix
    return matrix


def transfer(distance, index):
    """Matrix of a distance in a medium.

    Parameters
    ----------
    distance : float
        mm.
    index : float

    Returns
    -------
    ndarray of shape (2, 2)
    """
    return np.array([[1.0, distance / index], [0.0, 1.0]])


def power(configuration, wavelength_nm=REFERENCE_WAVELENGTH_NM, meridian="y"):
    """Power of the lens, index behind it over focal length.

    Parameters
    ----------
    configuration : Configuration
    wavelength_nm : float
    meridian : {"x", "y"}

    Returns
    -------
    float
        1/mm; negative for a diverging lens, about 0 for an afocal one, not finite on overflow.

    Raises
    ------
    PrescriptionError
        If a glass has no index at the wavelength.
    """
    return -float(ray_matrix(configuration, wavelength_nm, meridian)[1, 0])


def entrance_pupil(configuration, wavelength_nm=REFERENCE_WAVELENGTH_NM, meridian="y"):
    """Paraxial image of the stop in object space.

    Parameters
    ----------
    configuration : Configuration
    wavelength_nm : float
    meridian : {"x", "y"}

    Returns
    -------
    z, diameter : float
        mm; z from the vertex of surface 1.

    Raises
    ------
    PrescriptionError
        If the image is at infinity, the stop is closed, or a glass has no index at the wavelength.
    """
    stop = configuration.stop
    front = _to_stop(configuration, wavelength_nm, meridian)
    pupil = _image_of_stop(front[0, 0], front[0, 1], configuration)
    if pupil is None:
        raise PrescriptionError(
            f"the stop (surface {stop}) has no finite image in object space: it is in the focal"
            " plane of the surfaces before it; move it"
        )
    if not pupil[1] > 0.0:
        raise PrescriptionError(f"the stop (surface {stop}) is closed; open it")
    return pupil


def first_order(configuration, wavelength_nm=REFERENCE_WAVELENGTH_NM, meridian="y"):
    """First-order values of a lens.

    Parameters
    ----------
    configuration : Configuration
    wavelength_nm : float
    meridian : {"x", "y"}
        They differ in lenses with cylinders only.

    Returns
    -------
    FirstOrder

    Raises
    ------
    PrescriptionError
        If the lens has no power, its entrance pupil is at infinity, or a glass has no index at the
        wavelength.
    """
    (a, _), (c, d) = _focusing_matrix(configuration, wavelength_nm, meridian)
    behind = indices(configuration, wavelength_nm)[-1]
    enp_z, enp_diameter = entrance_pupil(configuration, wavelength_nm, meridian)
    # A stop that refracts may be taken as lying in front of or behind its own surface: a surface
    # neither moves nor enlarges what stands in its vertex plane.
    rear = ray_matrix(configuration, wavelength_nm, meridian, first=configuration.stop)
    exit_pupil = _image_of_stop(rear[1, 1], -behind * float(rear[0, 1]), configuration)
    exp_z, exp_diameter = exit_pupil or (None, None)
    efl = -behind / c
    values = FirstOrder(
        efl=efl,
        bfl=-behind * a / c,
        ffl=d / c,
        h=(d - 1.0) / c,
        h_prime=behind * (1.0 - a) / c,
        enp_z=enp_z,
        enp_diameter=enp_diameter,
        exp_z=exp_z,
        exp_diameter=exp_diameter,
        f_number=efl / enp_diameter,
    )
    _refuse_overflow(value for value in vars(values).values() if value is not None)
    return values


def image_distance(configuration, object_to_first_vertex, wavelength_nm=REFERENCE_WAVELENGTH_NM):
    """Distance of the paraxial image of an axial point.

    Parameters
    ----------
    configuration : Configuration
    object_to_first_vertex : float
        mm in front of surface 1; inf for an object at infinity.
    wavelength_nm : float

    Returns
    -------
    float
        Last vertex to image, mm; negative for a virtual image.

    Raises
    ------
    PrescriptionError
        If the lens has no power, or the image is at infinity.
    """
    matrix = _focusing_matrix(configuration, wavelength_nm, "y")
    behind = indices(configuration, wavelength_nm)[-1]
    (a, b), (c, d) = matrix
    if math.isinf(object_to_first_vertex):
        distance = -behind * a / c
    else:
        height = a * object_to_first_vertex + b
        distance = -behind * height / _spread(c, d, object_to_first_vertex)
    _refuse_overflow([distance])
    return distance


def magnification(configuration, object_to_first_vertex, wavelength_nm=REFERENCE_WAVELENGTH_NM):
    """Paraxial transverse magnification.

    Parameters
    ----------
    configuration : Configuration
    object_to_first_vertex : float
        mm in front of surface 1; inf gives 0.
    wavelength_nm : float

    Returns
    -------
    float
        Image height over object height.

    Raises
    ------
    PrescriptionError
        If the lens has no power, or the image is at infinity.
    """
    (_, _), (c, d) = _focusing_matrix(configuration, wavelength_nm, "y")
    if math.isinf(object_to_first_vertex):
        return 0.0
    return 1.0 / _spread(c, d, object_to_first_vertex)


def _vertex_curvature(surface, meridian):
    if surface.curved_along not in (None, meridian):
        return 0.0
    return surface.curvature + 2.0 * dict(surface.asphere).get(2, 0.0)


def _to_stop(configuration, wavelength_nm, meridian):
    """Matrix from in front of surface 1 to the stop's vertex plane."""
    stop = configuration.stop
    if stop == 1:
        return np.eye(2)
    front = ray_matrix(configuration, wavelength_nm, meridian, last=stop - 1)
    gap = configuration.surfaces[stop - 2].thickness
    index = indices(configuration, wavelength_nm)[stop - 1]
    with np.errstate(all="ignore"):
        return transfer(gap, index) @ front


def _image_of_stop(scale, shift, configuration):
    """Position and diameter of the stop's image; None at infinity."""
    radius = float(configuration.surfaces[configuration.stop - 1].semi_diameter)
    scale, shift = float(scale), float(shift)
    if not (abs(scale) * LARGEST_PUPIL > 1.0 and math.isfinite(scale) and math.isfinite(shift)):
        return None
    pupil = shift / scale, 2.0 * radius / abs(scale)
    return pupil if all(map(math.isfinite, pupil)) else None


def _focusing_matrix(configuration, wavelength_nm, meridian):
    matrix = ray_matrix(configuration, wavelength_nm, meridian)
    _refuse_overflow(matrix.ravel())
    if abs(matrix[1, 0]) < LEAST_POWER:
        raise PrescriptionError(
            f"the prescription has no power (1 / focal length = {-matrix[1, 0]:.3g} per mm in"
            f" {meridian}); check radii and materials"
        )
    return matrix.tolist()


def _refuse_overflow(values):
    if not all(map(math.isfinite, values)):
        raise PrescriptionError(
            "the prescription's numbers are too large: its first-order values overflow"
        )


def _spread(c, d, distance):
    """Index times slope behind the lens of the ray that leaves the object with slope 1."""
    spread = c * distance + d
    if not abs(spread) > 1.0e-12:
        raise PrescriptionError(
            f"an object {distance:g} mm in front of the lens is in its front focal plane:"
            " its image is at infinity"
        )
    return spread
