"""Importer of CODE V sequences (``.seq``).

Commands for the whole lens, then one block per surface: ``SO`` object, ``S`` surface, ``SI`` image,
each with radius or curvature, thickness and glass, followed by commands for that surface.
"""

import math
import re

from ....optics.glass import AIR, REFERENCE_WAVELENGTH_NM
from ..draft.draft import Draft, DraftSurface, Field, Opening
from ..draft.media import UnknownGlassError, codev_glass
from ..draft.source_text import clean, number, radius_of, whole_number
from .codev_keywords import (
    APERTURES,
    COEFFICIENTS,
    EDITS,
    ENDLESS,
    FARTHEST,
    FIELDS,
    LABEL,
    LENS_WORDS,
    MIRRORS,
    OFF_AXIS,
    OTHER_SHAPES,
    SOLVED,
    SOLVES,
    UNITS_MM,
)
from .codev_text import commands

FORMAT_NAME = "CODE V sequence"


def looks_like(lines):
    """Return whether there are surfaces as CODE V writes them.

    Parameters
    ----------
    lines : list of (int, str)

    Returns
    -------
    bool
    """
    firsts = {
        part.split(None, 1)[0].upper()
        for _, text in lines
        for part in text.split(";")
        if part.strip()
    }
    return "S" in firsts and bool(firsts & (LENS_WORDS - {"S"}))


def read(lines, options):
    """Read a sequence.

    Parameters
    ----------
    lines : list of (int, str)
    options : ImportOptions

    Returns
    -------
    Draft
    """
    reader = _Reader(options)
    for command in commands(lines, reader.draft.refusals):
        if reader.draft.is_full(len(reader.draft.surfaces), command.line):
            break
        reader.take(command)
    return reader.finish()


class _Reader:
    """Follows the commands of a sequence."""

    def __init__(self, options):
        self.options = options
        self.draft = Draft()
        self.scale = 1.0
        self.has_unit = False
        self.radii = None
        self.radii_missing_at = None
        self.surface = None
        self.shapes = {}
        self.aperture = None
        self.fields = {}
        self.wavelengths = ()
        self.reference = None
        self.object_line = None
        self.image_line = None
        self.private_glasses = False

    def take(self, command):
        """Carry out one command."""
        keyword, words, line = command.keyword, command.words, command.line
        refuse = self.draft.refusals.add
        if self.private_glasses:
            self.private_glasses = keyword != "END"
            self.draft.passed_over.add("PRV glasses", line)
        elif keyword in ("SO", "S", "SI"):
            self._begin_surface(command)
        elif keyword in MIRRORS or (keyword == "RMD" and _has(words, MIRRORS)):
            refuse("I02", line, f"{command.text} is a mirror; light must go on towards +z")
        elif keyword in OFF_AXIS:
            refuse("I03", line, f"{command.text}: tilts and decentres are not supported")
        elif keyword in OTHER_SHAPES:
            refuse("I04", line, f"{command.text}: this surface or rim is no figure of revolution")
        elif self._is_solve(command):
            self.draft.passed_over.add(
                f"solve {clean(' '.join(words[:2]))[:20]}: the value of the S line holds",
                line,
            )
        elif keyword in EDITS:
            refuse("I04", line, f"{command.text}: changes of a lens after its S lines are not read")
        elif keyword[:1] in ("X", "Y") and keyword[1:] in FIELDS:
            self.fields[keyword[1:], keyword[0]] = self._numbers(command)
        elif keyword in APERTURES:
            self.aperture = (keyword, self._one(command), line)
        elif not self._take_lens_word(command) and not self._take_surface_word(command):
            self.draft.passed_over.add(clean(keyword)[:20], line)

    def _is_solve(self, command):
        words = command.words
        return (
            self.surface is not None
            and command.keyword in SOLVED
            and len(words) > 1
            and words[1].upper() in SOLVES
        )

    def _take_lens_word(self, command):
        keyword, words = command.keyword, command.words
        if keyword == "DIM":
            self._read_unit(command)
        elif keyword == "RDM":
            answer = words[1].upper() if len(words) > 1 else "Y"
            self.radii = "curvature" if answer.startswith("N") else "radius"
            if self.options.radii not in (None, self.radii):
                self.draft.passed_over.add("option --radii: the file has RDM", command.line)
        elif keyword in ("TIT", "TITLE"):
            self._read_title(command)
        elif keyword == "WL":
            self.wavelengths = self._numbers(command)
        elif keyword == "REF":
            self.reference = whole_number(words[1]) if len(words) > 1 else None
        elif keyword == "PRV":
            self.private_glasses = True
        elif keyword == "ZOO":
            self.draft.passed_over.add("ZOO: zoom positions are not read", command.line)
        else:
            return False
        return True

    def _read_title(self, command):
        words = command.words[1:]
        if words and re.fullmatch(r"Z\d{1,3}", words[0], re.IGNORECASE):
            # Of one zoom position; Z1 is that of the S lines.
            if words[0].upper() != "Z1":
                self.draft.passed_over.add("TIT of another zoom position", command.line)
                return
            words = words[1:]
        self.draft.name = clean(" ".join(words))

    def _read_unit(self, command):
        unit = command.words[1].upper() if len(command.words) > 1 else "none"
        self.has_unit = True
        if unit not in UNITS_MM:
            known = ", ".join(UNITS_MM)
            self.draft.refusals.add(
                "I08", command.line, f"unit '{clean(unit)[:20]}' is not known; known are {known}"
            )
        elif self.surface is not None:
            self.draft.refusals.add("I07", command.line, "DIM must stand before the surfaces")
        else:
            self.scale = UNITS_MM[unit]

    def _take_surface_word(self, command):
        keyword, words = command.keyword, command.words
        known = {"STO", "CIR", "CON", "ASP", "SPH", "K", *COEFFICIENTS}
        if keyword not in known:
            return False
        if self.surface is None:
            self.draft.refusals.add("I07", command.line, f"{command.text} stands in no surface")
        elif keyword == "STO":
            self._mark_stop(command)
        elif keyword == "CIR":
            self._read_rim(command)
        elif keyword in ("CON", "ASP", "SPH"):
            self.shapes[id(self.surface)] = keyword
        elif len(words) > 1 and words[1].upper().startswith("S"):
            self.draft.refusals.add("I07", command.line, f"{command.text} is not in its surface")
        elif keyword == "K":
            self.surface.conic = self._one(command)
        else:
            self._read_coefficient(command)
        return True

    def _mark_stop(self, command):
        if len(command.words) == 1:
            self.surface.is_stop = True
            return
        named = self._surface_named(command, f"S{command.words[1].upper().removeprefix('S')}")
        if named is not None:
            named.is_stop = True

    def _read_rim(self, command):
        # A qualifier says what the circle is (clear aperture unless told), a label names it.
        words = [word.upper() for word in command.words[1:] if not LABEL.fullmatch(word)]
        surface = self.surface
        if words and re.fullmatch(r"S\d{1,9}", words[0]):
            surface = self._surface_named(command, words.pop(0))
        if "OBS" in words or "HOL" in words:
            self.draft.refusals.add("I04", command.line, f"{command.text}: a hole round the axis")
        elif "EDG" in words:
            self.draft.passed_over.add("CIR EDG", command.line)
        elif surface is not None:
            numbers = [word for word in words if word != "CLR"]
            radius = number(numbers[0]) if len(numbers) == 1 else None
            if radius is None:
                self.draft.refusals.add("I07", command.line, f"{command.text} is not one number")
            else:
                surface.semi_diameter = radius * self.scale

    def _surface_named(self, command, word):
        named = whole_number(word[1:])
        if named is None or not 1 <= named <= len(self.draft.surfaces):
            self.draft.refusals.add("I07", command.line, f"{command.text} names no surface so far")
            return None
        return self.draft.surfaces[named - 1]

    def _read_coefficient(self, command):
        order = COEFFICIENTS[command.keyword]
        value = self._one(command)
        if value:
            self.surface.asphere[order] = value * self.scale ** (1 - order)

    def _begin_surface(self, command):
        keyword, words, line = command.keyword, command.words, command.line
        if keyword == "SO":
            if self.surface is not None:
                self.draft.refusals.add("I07", line, "SO must be the first surface")
            self.object_line = line
        elif self.image_line is not None:
            self.draft.refusals.add("I07", line, "SI must be the last surface")
        shape = self._shape_at(command, 1)
        thickness = self._distance_at(command, 2)
        self.surface = DraftSurface(line, len(self.draft.surfaces) + 1, thickness=thickness)
        self._set_shape(shape, line)
        glass = words[3] if len(words) > 3 else "AIR"
        if glass.upper() in MIRRORS:
            self.draft.refusals.add("I02", line, f"{command.text} is a mirror")
        elif keyword == "S":
            self.surface.glass = self._glass(glass, line)
        elif glass.upper() != "AIR":
            self.draft.refusals.add("I04", line, f"{command.text}: object and image stand in air")
        if keyword == "S":
            self.draft.surfaces.append(self.surface)
        elif keyword == "SO":
            far = abs(thickness) >= FARTHEST * self.scale
            self.draft.object_distance = math.inf if far else thickness
        else:
            self.image_line = line
            if thickness != 0.0:
                self.draft.notes.append(
                    f"The file's picture plane is {thickness:g} mm behind the image surface."
                )
                self.draft.passed_over.add("SI thickness: defocus of the picture plane", line)
            if shape != 0.0:
                self.draft.passed_over.add("curved image surface: pictures are flat", line)

    def _set_shape(self, shape, line):
        radii = self.radii or self.options.radii
        if shape == 0.0:
            return
        if radii is None:
            self.radii_missing_at = self.radii_missing_at or line
        if radii == "curvature":
            self.surface.radius = radius_of(shape, self.scale)
        else:
            self.surface.radius = shape * self.scale

    def _glass(self, word, line):
        if word.upper() == "AIR":
            return AIR
        try:
            glass, note = codev_glass(word, self.options)
        except UnknownGlassError as error:
            self.draft.refusals.add("I05", line, str(error))
            return AIR
        if note and note not in self.draft.notes:
            self.draft.notes.append(note)
        return glass

    def _shape_at(self, command, position):
        # An endless radius is a plane, which sequences otherwise write as 0.
        if self._is_endless(command, position) and (self.radii or self.options.radii) == "radius":
            return 0.0
        return self._number_at(command, position)

    def _distance_at(self, command, position):
        if command.keyword == "SO" and self._is_endless(command, position):
            return math.inf
        return self._number_at(command, position) * self.scale

    @staticmethod
    def _is_endless(command, position):
        words = command.words
        return position < len(words) and words[position].upper().lstrip("+-") in ENDLESS

    def _number_at(self, command, position):
        word = command.words[position] if position < len(command.words) else "0"
        value = number(word)
        if value is None:
            self.draft.refusals.add("I07", command.line, f"{command.text} has no number {position}")
            return 0.0
        return value

    def _one(self, command):
        if len(command.words) != 2:
            self.draft.refusals.add("I07", command.line, f"{command.text} is not one number")
            return 0.0
        return self._number_at(command, 1)

    def _numbers(self, command):
        return [self._number_at(command, i) for i in range(1, min(len(command.words), 100))]

    def finish(self):
        """Check the values that depend on the whole file, and return the draft."""
        draft = self.draft
        if self.object_line is None or self.image_line is None or not draft.surfaces:
            draft.refusals.add("I07", None, "the file needs SO, at least one S, and SI")
        if self.radii_missing_at is not None:
            draft.refusals.add(
                "I06",
                self.radii_missing_at,
                "the file has no RDM in front of its surfaces, so these may be radii or"
                " curvatures; choose with --radii radius|curvature",
            )
        for surface in draft.surfaces:
            self._check_shape(surface)
        if not self.has_unit:
            draft.notes.append("The file tells no unit; mm, the program's own, are taken.")
        draft.opening = self._opening()
        draft.field = self._field()
        draft.choose_stop(self.options)
        draft.drop_dummies()
        return draft

    def _check_shape(self, surface):
        # Without a word for its shape, a surface has the one that its constants ask for.
        shape = self.shapes.get(id(surface))
        if shape == "SPH" and (surface.conic or surface.asphere):
            told = "K or A to J"
        elif shape == "CON" and surface.asphere:
            told = "A to J"
        else:
            return
        self.draft.refusals.add(
            "I07", surface.line, f"the surface is called {shape}, but has {told}; which one holds?"
        )

    def _opening(self):
        if self.aperture is None:
            return None
        keyword, value, line = self.aperture
        if value <= 0.0:
            self.draft.refusals.add("I07", line, f"{keyword} {value:g} must be above 0")
        kind = APERTURES[keyword]
        scale = self.scale if kind == "entrance pupil" else 1.0
        return Opening(kind, value * scale, self._wavelength())

    def _wavelength(self):
        if not self.wavelengths:
            return REFERENCE_WAVELENGTH_NM
        # Without REF, the program takes the one in the middle.
        number_of = self.reference or (len(self.wavelengths) + 1) // 2
        inside = 1 <= number_of <= len(self.wavelengths)
        return self.wavelengths[number_of - 1] if inside else REFERENCE_WAVELENGTH_NM

    def _field(self):
        for ending, kind in FIELDS.items():
            across = self.fields.get((ending, "X"), [])
            along = self.fields.get((ending, "Y"), [])
            length = max(len(across), len(along))
            pairs = zip(
                [*across, *[0.0] * (length - len(across))],
                [*along, *[0.0] * (length - len(along))],
                strict=True,
            )
            scale = 1.0 if kind == "angle" else self.scale
            values = sorted({math.hypot(*pair) * scale for pair in pairs} - {0.0})
            if values:
                return Field(kind, tuple(values))
        return None


def _has(words, wanted):
    return any(word.upper() in wanted for word in words[1:])
