"""The draft of a lens: what an importer has read, before missing values are computed."""

import dataclasses
from dataclasses import dataclass

from ....optics.glass import AIR, Glass
from .source_text import PassedOver, Refusals

# A lens file may have a hundred surfaces; foreign ones have dummies, too.
_MOST_SURFACES = 1000


@dataclass
class DraftSurface:
    """One surface as the file describes it.

    Parameters
    ----------
    line : int
        Where it stands in the file.
    number : int
        Its number in the file.
    radius, thickness : float
        mm; inf for a plane.
    semi_diameter : float or None
        mm; None if the file does not tell it.
    glass : Glass
        Behind the surface.
    conic : float
    asphere : dict of int to float
        Order to coefficient, mm^(1 - n).
    is_stop : bool
    rim_is_fixed : bool
        False if a program computed the semi-diameter from the rays of the file.
    """

    line: int
    number: int
    radius: float = float("inf")
    thickness: float = 0.0
    semi_diameter: float | None = None
    glass: Glass = AIR
    conic: float = 0.0
    asphere: dict = dataclasses.field(default_factory=dict)
    is_stop: bool = False
    rim_is_fixed: bool = True

    @property
    def is_flat(self):
        """Whether the surface is a plane in every respect."""
        return self.radius in (float("inf"), float("-inf")) and not any(self.asphere.values())


@dataclass(frozen=True)
class Opening:
    """The aperture as a file specifies it.

    Parameters
    ----------
    kind : str
        "entrance pupil" (diameter, mm), "f-number" (EFL over entrance pupil diameter), "working
        f-number" (1 over twice the paraxial marginal slope in the image of the file's object),
        "image NA" (half the inverse of that), "object NA" (sine of the marginal ray's angle at the
        file's object), "object cone angle" (that angle in degrees), or "stop" (the stop's own rim
        is the aperture).
    value : float
        0 for "stop".
    wavelength_nm : float
        Of the paraxial rays it is meant for.
    """

    kind: str
    value: float
    wavelength_nm: float


@dataclass(frozen=True)
class Field:
    """The field as a file specifies it: the largest value of its list.

    Parameters
    ----------
    kind : str
        "angle" (degrees), "image height" (mm; paraxial), "real image height" (mm) or "object
        height" (mm).
    values : tuple of float
        Positive.
    """

    kind: str
    values: tuple[float, ...]


@dataclass
class DraftPosition:
    """One column of a zoom lens.

    Parameters
    ----------
    thicknesses : list of float
        Behind every surface of the draft, mm.
    opening : Opening or None
        None: that of the lens.
    field : Field or None
    stop_semi_diameter : float or None
        mm; None: that of the stop surface.
    focal_length, f_number : float or None
        Nominal, if the file tells them.
    """

    thicknesses: list
    opening: Opening | None = None
    field: Field | None = None
    stop_semi_diameter: float | None = None
    focal_length: float | None = None
    f_number: float | None = None


@dataclass
class Draft:
    """A lens on its way from a foreign file to a prescription.

    Parameters
    ----------
    name : str
    source : str or None
        Patent or book, if the file tells it.
    image_circle_diameter : float or None
        mm.
    surfaces : list of DraftSurface
    notes : list of str
        Sentences for the notes of the lens.
    opening : Opening or None
    field : Field or None
    object_distance : float
        mm; inf for an object at infinity.
    image_distance_told : bool
        Whether the last thickness is that of the image of an object at infinity.
    focal_length, f_number : float or None
        Nominal, if the file tells them.
    positions : list of DraftPosition
        Of a zoom lens; else empty.
    passed_over : PassedOver
    refusals : Refusals
    """

    name: str = ""
    source: str | None = None
    image_circle_diameter: float | None = None
    surfaces: list = dataclasses.field(default_factory=list)
    notes: list = dataclasses.field(default_factory=list)
    opening: Opening | None = None
    field: Field | None = None
    object_distance: float = float("inf")
    image_distance_told: bool = True
    focal_length: float | None = None
    f_number: float | None = None
    positions: list = dataclasses.field(default_factory=list)
    passed_over: PassedOver = dataclasses.field(default_factory=PassedOver)
    refusals: Refusals = dataclasses.field(default_factory=Refusals)

    def is_full(self, count, line):
        """Refuse (E11) and return True if a file goes on after far too many surfaces.

        Parameters
        ----------
        count : int
            Surfaces so far.
        line : int
        """
        if count < _MOST_SURFACES:
            return False
        self.refusals.add("E11", line, f"the file has more than {_MOST_SURFACES} surfaces")
        return True

    def drop_dummies(self):
        """Leave out planes in air that are not the stop, adding up the distances."""
        kept, owners = [], []
        before = AIR
        for surface in self.surfaces:
            idle = surface.is_flat and surface.glass is AIR and before is AIR
            before = surface.glass
            if idle and not surface.is_stop:
                self.passed_over.add("dummy plane in air", surface.line)
                if not kept:
                    self.object_distance += surface.thickness
            else:
                kept.append(surface)
            owners.append(len(kept) - 1)
        distances = _folded([surface.thickness for surface in self.surfaces], owners, len(kept))
        for surface, distance in zip(kept, distances, strict=True):
            surface.thickness = distance
        for position in self.positions:
            position.thicknesses = _folded(position.thicknesses, owners, len(kept))
        self.surfaces = kept

    def choose_stop(self, options):
        """Mark the stop that the user named, or refuse if the file leaves it open.

        Parameters
        ----------
        options : ImportOptions
        """
        stops = [surface for surface in self.surfaces if surface.is_stop]
        if len(stops) == 1:
            if options.stop is not None and options.stop != stops[0].number:
                self.passed_over.add("option --stop: the file tells the stop", stops[0].line)
            return
        numbers = [surface.number for surface in stops or self.surfaces]
        chosen = next((s for s in self.surfaces if s.number == options.stop), None)
        if self.refusals.has("I07"):
            # A line that could not be read may be the stop.
            return
        if options.stop is None or (stops and chosen not in stops) or chosen is None:
            what = "names more than one stop" if stops else "does not name the stop"
            asked = "" if options.stop is None else f" (asked for {options.stop})"
            listed = ", ".join(str(n) for n in numbers[:6]) + (", ..." if len(numbers) > 6 else "")
            self.refusals.add(
                "I06",
                stops[1].line if stops else None,
                f"the file {what}{asked}; choose one with --stop N, N out of {listed}",
            )
            return
        for surface in self.surfaces:
            surface.is_stop = surface is chosen


def _folded(distances, owners, count):
    # A distance behind a dummy belongs to the surface that is kept before it.
    sums = [0.0] * count
    for distance, owner in zip(distances, owners, strict=True):
        if owner >= 0:
            sums[owner] += distance
    return sums
