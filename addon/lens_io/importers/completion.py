"""Completion of a draft to a prescription: values that the file lacks are computed.

First-order values come from paraxial optics at the reference wavelength (the aperture's at the
wavelength of the file), rims and fields from traced rays. The notes of the lens say what was
computed.
"""

import math
import re
from dataclasses import dataclass, replace

from ...errors import LensFileError, PrescriptionError
from ...optics.paraxial import first_order
from ...optics.prescription import Configuration, Prescription, Surface, ZoomPosition
from ..toml.findings import Finding
from ..toml.lens_tables import LONGEST_NAME
from ..toml.surface_tables import FEWEST_SURFACES, MOST_SURFACES
from ..toml.toml_reader import parse_lens
from ..toml.toml_writer import lens_toml
from .draft.draft import DraftPosition
from .sizes import UNKNOWN_RIM, FileValueError, fields_of, half_field, rims, stop_radius

# Focal lengths nearer than this, as a share, are one: the distances show how the lens focuses.
_SAME_FOCAL_LENGTH = 0.01
_LONGEST_NOTES = 20_000
_SURFACE_PATH = re.compile(r"surface\[(\d+)\]")


@dataclass(frozen=True)
class _Stand:
    """A lens at one zoom position, and the values that the file has for it."""

    lens: Configuration
    told: DraftPosition
    fields_deg: tuple[float, ...] = ()


def complete(draft, file_name, options):
    """Make a checked prescription of a draft.

    Parameters
    ----------
    draft : Draft
        Without refusals.
    file_name : str
        For messages.
    options : ImportOptions

    Returns
    -------
    Prescription
    tuple of Finding
        Warnings.

    Raises
    ------
    LensFileError
        If a value is not possible, or a missing one cannot be computed.
    """
    count = len(draft.surfaces)
    if not FEWEST_SURFACES <= count <= MOST_SURFACES:
        message = f"the lens has {count} surfaces; it must have {FEWEST_SURFACES} to"
        raise LensFileError(file_name, [Finding("E11", "surface", f"{message} {MOST_SURFACES}")])
    base = _standing(draft, [surface.thickness for surface in draft.surfaces])
    _checked(_assembled(draft, [_Stand(base, DraftPosition([]))]), draft, file_name)
    try:
        stands = _chosen(_stands(draft), draft)
        stands = [_with_image(stand, draft) for stand in stands]
        stands = [_with_stop(stand, draft, options) for stand in stands]
        stands = [_with_fields(stand, draft, options) for stand in stands]
        stands = _with_rims(stands, draft)
        stands = [_with_half_field(stand, stands, draft) for stand in stands]
    except FileValueError as error:
        raise LensFileError(file_name, [Finding(error.code, "", str(error))]) from error
    except PrescriptionError as error:
        # The base position was checked: this is another one, without power or entrance pupil.
        raise LensFileError(file_name, [Finding("E24", "zoom", str(error))]) from error
    read = _checked(_assembled(draft, stands), draft, file_name)
    return read.prescription, _placed(read.warnings, draft)


def _standing(draft, thicknesses):
    surfaces = tuple(
        Surface(
            radius=told.radius,
            thickness=thickness,
            semi_diameter=UNKNOWN_RIM if told.semi_diameter is None else told.semi_diameter,
            glass=told.glass,
            conic=told.conic,
            asphere=tuple(sorted(told.asphere.items())),
            is_stop=told.is_stop,
        )
        for told, thickness in zip(draft.surfaces, thicknesses, strict=True)
    )
    # The stop opens last: what is computed of it needs a pupil whose scale is known.
    surfaces = tuple(
        replace(surface, semi_diameter=UNKNOWN_RIM) if surface.is_stop else surface
        for surface in surfaces
    )
    return Configuration(surfaces, 1.0, 1.0, 1.0)


def _stands(draft):
    told = draft.positions or [
        DraftPosition(
            [surface.thickness for surface in draft.surfaces],
            focal_length=draft.focal_length,
            f_number=draft.f_number,
        )
    ]
    for position in told:
        lens = _standing(draft, position.thicknesses)
        lens = replace(lens, focal_length=first_order(lens).efl)
        yield _Stand(
            lens,
            replace(
                position,
                opening=position.opening or draft.opening,
                field=position.field or draft.field,
            ),
        )


def _chosen(stands, draft):
    # Zoom positions by rising focal length; of a lens that only focuses, the first column.
    stands = list(stands)
    ordered = sorted(stands, key=lambda stand: stand.lens.focal_length)
    longest, shortest = ordered[-1].lens.focal_length, ordered[0].lens.focal_length
    if longest > (1.0 + _SAME_FOCAL_LENGTH) * shortest and _moving(ordered):
        return ordered
    if len(stands) > 1:
        line = draft.surfaces[0].line
        draft.passed_over.add(
            f"positions 2 to {len(stands)}: the focal length stays, the lens only focuses", line
        )
    return stands[:1]


def _moving(stands):
    # Indices of the distances that differ between positions.
    rows = zip(*(stand.told.thicknesses for stand in stands), strict=True)
    return [index for index, row in enumerate(rows) if len(set(row)) > 1]


def _with_image(stand, draft):
    if draft.image_distance_told and math.isinf(draft.object_distance):
        return stand
    number = len(stand.lens.surfaces)
    distance = first_order(stand.lens).bfl
    thicknesses = [*stand.told.thicknesses[:-1], distance]
    why = "" if math.isinf(draft.object_distance) else ": the file has a near object"
    _note(draft, f"Image distance: the paraxial focus for an object at infinity{why}.")
    told = replace(stand.told, thicknesses=thicknesses)
    return replace(stand, lens=stand.lens.with_thickness(number, distance), told=told)


def _with_stop(stand, draft, options):
    radius, notes = stop_radius(stand.lens, stand.told, draft, options)
    for note in notes:
        _note(draft, note)
    surfaces = tuple(
        replace(surface, semi_diameter=radius) if surface.is_stop else surface
        for surface in stand.lens.surfaces
    )
    values = first_order(replace(stand.lens, surfaces=surfaces))
    told_length, told_number = stand.told.focal_length, stand.told.f_number
    if not told_length:
        _note(draft, "Focal length: computed.")
    if not told_number:
        _note(draft, "f-number: focal length over entrance pupil diameter, computed.")
    return replace(
        stand,
        lens=replace(
            stand.lens,
            surfaces=surfaces,
            focal_length=told_length or _nominal(values.efl),
            f_number=told_number or _nominal(values.f_number),
        ),
        told=replace(stand.told, stop_semi_diameter=radius),
    )


def _with_fields(stand, draft, options):
    angles, notes = fields_of(stand.lens, stand.told.field, draft.object_distance)
    for note in notes:
        _note(draft, note)
    if not angles and options.half_field_deg is not None:
        _note(draft, "Half field: chosen at the import.")
        angles = (options.half_field_deg,)
    elif options.half_field_deg is not None:
        line = draft.surfaces[0].line
        draft.passed_over.add("option --half-field: the file tells the field", line)
    return replace(stand, fields_deg=angles)


def _with_rims(stands, draft):
    radii, notes = rims([(stand.lens, stand.fields_deg) for stand in stands], draft)
    for note in notes:
        _note(draft, note)
    return [
        replace(
            stand,
            lens=replace(
                stand.lens,
                surfaces=tuple(
                    surface if surface.is_stop else replace(surface, semi_diameter=radius)
                    for surface, radius in zip(stand.lens.surfaces, radii, strict=True)
                ),
            ),
        )
        for stand in stands
    ]


def _with_half_field(stand, stands, draft):
    angle, note = half_field(stand.lens, stand.fields_deg, alone=len(stands) == 1)
    if note:
        _note(draft, note)
    return replace(stand, lens=replace(stand.lens, half_field_deg=_nominal(angle)))


def _assembled(draft, stands):
    first = stands[0].lens
    surfaces, zoom = first.surfaces, ()
    if len(stands) > 1:
        moving = _moving(stands)
        ids = {index: f"D{index + 1}" for index in moving}
        if len(surfaces) - 1 in ids:
            ids[len(surfaces) - 1] = "BF"
        widest = max(stand.told.stop_semi_diameter for stand in stands)
        surfaces = tuple(
            replace(
                surface,
                id=ids.get(index),
                semi_diameter=widest if surface.is_stop else surface.semi_diameter,
            )
            for index, surface in enumerate(surfaces)
        )
        zoom = tuple(_zoom_position(stand, ids, label) for stand, label in _labelled(stands))
    return Prescription(
        name=draft.name[:LONGEST_NAME].strip() or "Imported lens",
        focal_length=first.focal_length,
        f_number=first.f_number,
        half_field_deg=first.half_field_deg,
        surfaces=surfaces,
        source=draft.source,
        image_circle_diameter=draft.image_circle_diameter,
        notes="\n".join(draft.notes)[:_LONGEST_NOTES] or None,
        zoom=zoom,
    )


def _labelled(stands):
    # As few digits as tell the positions apart.
    for digits in range(3, 8):
        labels = [f"{stand.lens.focal_length:.{digits}g} mm" for stand in stands]
        if len(set(labels)) == len(labels):
            break
    return zip(stands, labels, strict=True)


def _zoom_position(stand, ids, label):
    return ZoomPosition(
        label=label,
        focal_length=stand.lens.focal_length,
        f_number=stand.lens.f_number,
        half_field_deg=stand.lens.half_field_deg,
        thicknesses={name: stand.told.thicknesses[index] for index, name in ids.items()},
        stop_semi_diameter=stand.told.stop_semi_diameter,
    )


def _checked(prescription, draft, file_name):
    """Read the lens back as its file would be, so that it is held to the same rules."""
    try:
        return parse_lens(lens_toml(prescription).encode(), file_name)
    except LensFileError as error:
        findings, warnings = _placed(error.findings, draft), _placed(error.warnings, draft)
        raise LensFileError(file_name, findings, warnings) from None


def _placed(findings, draft):
    # Where a finding names a surface, the line of the foreign file is what its reader looks for.
    placed = []
    for finding in findings:
        found = _SURFACE_PATH.match(finding.path)
        number = int(found[1]) if found else 0
        if 1 <= number <= len(draft.surfaces):
            line = draft.surfaces[number - 1].line
            finding = replace(finding, message=f"{finding.message} (line {line} of the file)")
        placed.append(finding)
    return tuple(placed)


def _note(draft, sentence):
    if sentence not in draft.notes:
        draft.notes.append(sentence)


def _nominal(value):
    # Nominal values are what one reads; the figures of the lens stay as they are.
    return float(f"{value:.6g}")
