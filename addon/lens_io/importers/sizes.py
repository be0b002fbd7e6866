"""Sizes that the file of a lens lacks: stop, rims, field."""

import math

from ...errors import PrescriptionError
from ...optics.glass import CHECKED_RANGE_NM, REFERENCE_WAVELENGTH_NM
from ...optics.paraxial import first_order
from ...optics.surfaces import sag
from .rims import COVERED_SHARE, beam_radii, coverage, fields_of_heights

# Placeholder of an unknown rim, mm: so small that every ray through it is paraxial.
UNKNOWN_RIM = 1.0e-6
# The stop's own rim may be this much smaller than the aperture asks for before the notes say so.
_RIM_TOLERANCE = 0.03
# Clear radii are given to this many digits, rounded up.
_DIGITS = 4
# Positions of a zoom lens and fields of each whose beams are traced for rims, and how many
# surfaces these beams may meet (an asphere counts as three): about a second's work.
_MOST_POSITIONS, _MOST_FIELDS, _SEARCH_COST = 5, 3, 400
# Halvings of the search for the radius at which two surfaces meet.
_HALVINGS = 40


class FileValueError(PrescriptionError):
    """A value is missing in the file and in the options.

    Parameters
    ----------
    code : str
    message : str
    """

    def __init__(self, code, message):
        super().__init__(message)
        self.code = code


def stop_radius(lens, told, draft, options):
    """Return the radius of the stop, and sentences on where it comes from.

    Light is limited by the aperture that the file asks for and by the stop's own rim, if it has a
    fixed one; the smaller of the two is the stop.

    Parameters
    ----------
    lens : Configuration
        With `UNKNOWN_RIM` as the rim of its stop.
    told : DraftPosition
    draft : Draft
    options : ImportOptions

    Returns
    -------
    float
        mm.
    list of str

    Raises
    ------
    FileValueError
        I06 if nothing tells the aperture.
    """
    stop = next(surface for surface in draft.surfaces if surface.is_stop)
    rim = told.stop_semi_diameter or stop.semi_diameter
    asked = _asked_radius(lens, told.opening, draft.object_distance)
    if asked is None and options.f_number is not None and rim is None:
        scale = UNKNOWN_RIM / first_order(lens).enp_diameter
        return first_order(lens).efl / options.f_number * scale, [
            "The stop follows from the f-number chosen at the import."
        ]
    if asked is None and rim is None:
        raise FileValueError(
            "I06", "the file tells neither the aperture nor the stop; choose with --f-number X"
        )
    if options.f_number is not None:
        draft.passed_over.add("option --f-number: the file tells the aperture", stop.line)
    if asked is None:
        return rim, []
    fixed = rim if stop.rim_is_fixed else None
    if fixed is None:
        return asked, [f"The stop follows from the {told.opening.kind} of the file."]
    if fixed < (1.0 - _RIM_TOLERANCE) * asked:
        return fixed, [
            f"The stop's own rim is smaller than the {told.opening.kind} of the file asks for."
        ]
    return min(fixed, asked), []


def _asked_radius(lens, opening, object_distance):
    if opening is None or opening.kind == "stop":
        return None
    low, high = CHECKED_RANGE_NM
    inside = low <= opening.wavelength_nm <= high
    values = first_order(lens, opening.wavelength_nm if inside else REFERENCE_WAVELENGTH_NM)
    scale = UNKNOWN_RIM / values.enp_diameter
    if opening.kind == "entrance pupil":
        diameter = opening.value
    elif opening.kind == "f-number":
        diameter = values.efl / opening.value
    elif opening.kind == "working f-number":
        diameter = _working_diameter(values, object_distance, opening.value)
    elif opening.kind == "image NA":
        diameter = _working_diameter(values, object_distance, 0.5 / opening.value)
    elif math.isinf(object_distance):
        return None
    else:
        diameter = 2.0 * _object_slope(opening) * abs(object_distance + values.enp_z)
    return diameter * scale


def _object_slope(opening):
    cone = opening.kind == "object cone angle"
    limit, unit = (90.0, " degrees") if cone else (1.0, "")
    if opening.value >= limit:
        raise FileValueError(
            "I07",
            f"the {opening.kind} is {opening.value:g}{unit}; it must be below {limit:g}{unit}",
        )
    return math.tan(math.radians(opening.value) if cone else math.asin(opening.value))


def _working_diameter(values, object_distance, working_f_number):
    """Return the diameter of the entrance pupil that gives a marginal slope behind the lens, mm."""
    if math.isinf(object_distance):
        return values.efl / working_f_number
    # Newton's equation: the lateral magnification by the distance from the front focal point. The
    # marginal ray's slope in front of the lens is that behind it times the magnification.
    from_focus = object_distance + values.ffl
    if from_focus == 0.0:
        raise FileValueError(
            "I06",
            "the object of the file stands in the front focal plane, where the working f-number is"
            " not defined; choose with --f-number X",
        )
    magnification = values.efl / from_focus
    return abs((object_distance + values.enp_z) * magnification) / working_f_number


def fields_of(lens, field, object_distance):
    """Return the fields of a file as angles.

    Parameters
    ----------
    lens : Configuration
    field : Field or None
    object_distance : float
        mm.

    Returns
    -------
    tuple of float
        Degrees; empty if the file tells none.
    list of str
        Sentences on how they were found.
    """
    if field is None:
        return (), []
    if field.kind == "angle":
        return field.values, []
    if field.kind == "object height":
        distance = object_distance + first_order(lens).enp_z
        if math.isinf(distance) or distance <= 0.0:
            return (), []
        angles = tuple(math.degrees(math.atan(height / distance)) for height in field.values)
        return angles, ["Half field: from the object height of the file."]
    if field.kind == "real image height":
        angles = fields_of_heights(lens, field.values)
        if angles is not None:
            return angles, ["Half field: where the chief ray meets the picture's edge, traced."]
    efl = first_order(lens).efl
    angles = tuple(math.degrees(math.atan(height / efl)) for height in field.values)
    return angles, ["Half field: from the image height of the file, by the focal length."]


def rims(stands, draft):
    """Return clear radii for all surfaces; those that the file has stay.

    Parameters
    ----------
    stands : list of (Configuration, tuple of float)
        The lens at each position, and the fields of the file there in degrees.
    draft : Draft

    Returns
    -------
    list of float
        mm.
    list of str
        Sentences on where they come from.

    Raises
    ------
    FileValueError
        I06 if rims are missing and there are no fields to compute them from.
    """
    missing = [
        index
        for index, surface in enumerate(draft.surfaces)
        if surface.semi_diameter is None and not surface.is_stop
    ]
    radii = [surface.semi_diameter or UNKNOWN_RIM for surface in draft.surfaces]
    if not missing:
        return radii, []
    notes = [
        "Semi-diameters that the file does not tell let the full beams of its fields through, as"
        " traced."
    ]
    found, axial = [0.0] * len(radii), [0.0] * len(radii)
    positions, angles = _search_size(stands)
    for lens, fields in _spread(stands, positions):
        if not fields:
            raise FileValueError(
                "I06",
                "the file tells neither all semi-diameters nor fields to compute them from;"
                " choose with --half-field DEG",
            )
        met, lost = beam_radii(lens, _spread(sorted(fields), angles))
        found = [max(pair) for pair in zip(found, met, strict=True)]
        met, lost_on_axis = beam_radii(lens, (0.0,))
        axial = [max(pair) for pair in zip(axial, met, strict=True)]
        notes.extend(
            f"No ray gets through at {field:.4g} degrees." for field in (*lost_on_axis, *lost)
        )
    found = [max(pair) for pair in zip(found, axial, strict=True)]
    for index in missing:
        if found[index] <= 0.0:
            raise FileValueError(
                "I06",
                f"the semi-diameter of surface {draft.surfaces[index].number} is not in the file,"
                " and no ray of its fields gets there; choose fields with --half-field DEG",
            )
        radii[index] = _rounded_up(found[index], draft.surfaces[index])
    notes.extend(_keep_apart(radii, missing, axial, stands[0][0].surfaces))
    return radii, notes


def _search_size(stands):
    # How many positions, and fields of each besides the axis: fewer for lenses of many surfaces.
    lens, _ = stands[0]
    cost = sum(3 if surface.asphere or surface.conic else 1 for surface in lens.surfaces)
    beams = max(2, _SEARCH_COST // cost)
    positions = min(_MOST_POSITIONS, max(1, beams // 2))
    return positions, min(_MOST_FIELDS, beams // min(positions, len(stands)) - 1)


def _spread(values, most):
    # Both ends and what lies evenly between: beams change little from one to the next. The last
    # field is the widest, the last zoom position has the largest stop.
    if len(values) <= most:
        return values
    if most == 1:
        return values[-1:]
    step = (len(values) - 1) / (most - 1)
    return [values[round(index * step)] for index in range(most)]


def _keep_apart(radii, missing, axial, surfaces):
    # Rims end where two surfaces meet: no glass is made with an edge of negative thickness. The
    # axial beam is never cut.
    notes = []
    for index, (this, following) in enumerate(zip(surfaces, surfaces[1:], strict=False)):
        reach = min(radii[index], radii[index + 1])
        meeting = _meeting_radius(this, following, reach)
        for number in (index, index + 1) if meeting < reach else ():
            if number in missing and axial[number] <= meeting < radii[number]:
                radii[number] = meeting
                notes = ["Some of them end where two surfaces meet."]
    return notes


def _meeting_radius(this, following, reach):
    def gap(radius):
        between = float(sag(following, 0.0, radius)) - float(sag(this, 0.0, radius))
        return this.thickness + between

    if not gap(reach) < 0.0:
        return reach
    low, high = 0.0, reach
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if gap(middle) >= 0.0 else (low, middle)
    return low


def half_field(lens, fields, alone):
    """Return the half field of a lens, and a sentence if it was computed.

    Parameters
    ----------
    lens : Configuration
    fields : tuple of float
        Degrees; of the file.
    alone : bool
        False for a position of a zoom lens.

    Returns
    -------
    float
        Degrees.
    str or None

    Raises
    ------
    FileValueError
        I06 if it cannot be computed.
    """
    if fields:
        return max(fields), None
    angle = coverage(lens) if alone else 0.0
    if angle <= 0.0:
        raise FileValueError("I06", "the file tells no field; choose with --half-field DEG")
    share = f"{COVERED_SHARE:.0%}"
    return angle, f"Half field: where {share} of the axial beam still gets through, traced."


def _rounded_up(radius, surface):
    step = 10.0 ** (math.floor(math.log10(radius)) + 1 - _DIGITS - 1)
    rounded = round(math.ceil(radius / step) * step, 12)
    squeeze = (1.0 + surface.conic) * (rounded / surface.radius) ** 2
    # A rim may end where the surface does, not beyond.
    return rounded if squeeze < 1.0 else radius
