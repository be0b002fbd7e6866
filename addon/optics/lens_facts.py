"""Facts of a lens for photographers: focal length, opening, coverage, elements and groups."""

import math
from dataclasses import dataclass

from ..errors import PrescriptionError
from .glass import Air
from .paraxial import first_order


@dataclass(frozen=True)
class LensFacts:
    """Facts of a lens at one zoom position.

    Parameters
    ----------
    focal_length : float
        Computed from the prescription, mm; of an anamorphic lens across the picture's height.
    horizontal_focal_length : float or None
        Across the width, mm; None if it is the same or there is none.
    f_number : float
        Wide open, as the file has it.
    half_field : float
        Radians.
    image_circle_diameter : float
        mm; as the file has it, else what the half field covers.
    elements, groups : int
        Pieces of glass, and groups of them that touch.
    """

    focal_length: float
    horizontal_focal_length: float | None
    f_number: float
    half_field: float
    image_circle_diameter: float
    elements: int
    groups: int


def lens_facts(prescription, label=None):
    """Return the facts of a lens.

    Parameters
    ----------
    prescription : Prescription
    label : str or None
        Of the zoom position; None: the first.

    Returns
    -------
    LensFacts

    Raises
    ------
    PrescriptionError
        If the lens has no such position or no power.
    """
    configuration = prescription.configuration(label)
    focal_length = first_order(configuration).efl
    half_field = math.radians(configuration.half_field_deg)
    # The stated circle belongs to the file as a whole; a zoom lens covers the same at every length.
    circle = prescription.image_circle_diameter
    if circle is None:
        circle = 2.0 * _image_height(abs(focal_length), half_field, prescription.projection)
    elements, groups = _elements_and_groups(configuration)
    return LensFacts(
        focal_length=focal_length,
        horizontal_focal_length=_horizontal(configuration),
        f_number=configuration.f_number,
        half_field=half_field,
        image_circle_diameter=circle,
        elements=elements,
        groups=groups,
    )


def squeeze(prescription, label=None):
    """Return how much narrower an anamorphic lens draws than it is high.

    Its opening is seen narrower by the same number.

    Parameters
    ----------
    prescription : Prescription
    label : str or None
        Of the zoom position.

    Returns
    -------
    float
        Focal length along the picture's height over that along its width; 1 for other lenses.
    """
    configuration = prescription.configuration(label)
    wide = _horizontal(configuration)
    return abs(first_order(configuration).efl / wide) if wide else 1.0


def _horizontal(configuration):
    if configuration.of_revolution:
        return None
    try:
        return first_order(configuration, meridian="x").efl
    except PrescriptionError:
        return None


def _image_height(focal_length, half_field, projection):
    # A fisheye as f theta, the most common rule.
    angle = half_field if projection == "fisheye" else math.tan(half_field)
    return focal_length * angle


def _elements_and_groups(configuration):
    glassy = [not isinstance(surface.glass, Air) for surface in configuration.surfaces]
    starts = [now and not before for before, now in zip([False, *glassy], glassy, strict=False)]
    return sum(glassy), sum(starts)
