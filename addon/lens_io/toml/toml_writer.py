"""A prescription to the text of a lens file, such that reading it gives the same prescription."""

import math

from ...optics.glass import AbbeGlass, Air, ConstantGlass, SellmeierGlass, SeriesGlass
from ...optics.prescription import Diaphragm, may_overlap
from ..glasses.glass_catalog import catalog_glass, catalog_names
from .surface_tables import ID_PATTERN


def lens_toml(prescription):
    """Write a lens file.

    Nothing is checked: what the format does not allow is written as it is, and its reader says
    what is wrong with it.

    Parameters
    ----------
    prescription : Prescription
        The outermost surfaces of a focus group that have no id get one, "S" and their number.

    Returns
    -------
    str
        TOML 1.0, to be stored as UTF-8.
    """
    ids = _ids(prescription)
    blocks = [
        ['format = "lens-description"', "format_version = 1"],
        ["[lens]", *_lens_lines(prescription)],
    ]
    if prescription.diaphragm != Diaphragm():
        blocks.append(["[diaphragm]", *_diaphragm_lines(prescription.diaphragm)])
    if prescription.focus is not None:
        ends = (("first", prescription.focus.first), ("last", prescription.focus.last))
        blocks.append(["[focus]", *(f"{key} = {_text(ids[end - 1])}" for key, end in ends)])
    for number, (surface, name) in enumerate(zip(prescription.surfaces, ids, strict=True), 1):
        overlaps = surface.thickness < 0.0 and may_overlap(prescription.surfaces, number)
        blocks.append(["[[surface]]", *_surface_lines(surface, name, overlaps)])
    blocks.extend(["[[zoom]]", *_zoom_lines(position)] for position in prescription.zoom)
    return "\n\n".join("\n".join(block) for block in blocks) + "\n"


def _lens_lines(lens):
    yield f"name = {_text(lens.name)}"
    for key in ("designer", "source"):
        if getattr(lens, key) is not None:
            yield f"{key} = {_text(getattr(lens, key))}"
    if lens.year is not None:
        yield f"year = {int(lens.year)}"
    if lens.notes is not None:
        yield f"notes = {_text(lens.notes)}"
    yield from _nominal_lines(lens)
    yield f"projection = {_text(lens.projection)}"
    if lens.image_circle_diameter is not None:
        yield f"image_circle_diameter_mm = {_number(lens.image_circle_diameter)}"


def _nominal_lines(lens):
    yield f"focal_length_mm = {_number(lens.focal_length)}"
    yield f"f_number = {_number(lens.f_number)}"
    yield f"half_field_deg = {_number(lens.half_field_deg)}"


def _diaphragm_lines(diaphragm):
    yield f"blades = {int(diaphragm.blades)}"
    yield f"blade_curvature = {_number(diaphragm.blade_curvature)}"
    yield f"rotation_deg = {_number(diaphragm.rotation_deg)}"


def _surface_lines(surface, name, overlaps):
    if name is not None:
        yield f"id = {_text(name)}"
    yield f"radius_mm = {_number(surface.radius)}"
    if surface.curved_along is not None:
        yield f"curved_along = {_text(surface.curved_along)}"
    yield f"thickness_mm = {_number(0.0 if overlaps else surface.thickness)}"
    if overlaps:
        yield f"overlap_mm = {_number(-surface.thickness)}"
    yield f"semi_diameter_mm = {_number(surface.semi_diameter)}"
    yield f"material = {_material(surface.glass)}"
    if surface.conic != 0.0:
        yield f"conic = {_number(surface.conic)}"
    if surface.asphere:
        terms = (f"a{n}_per_mm{n - 1} = {_number(a)}" for n, a in surface.asphere)
        yield f"asphere = {{ {', '.join(terms)} }}"
    if surface.is_stop:
        yield "stop = true"


def _zoom_lines(position):
    yield f"label = {_text(position.label)}"
    yield from _nominal_lines(position)
    if position.stop_semi_diameter is not None:
        yield f"stop_semi_diameter_mm = {_number(position.stop_semi_diameter)}"
    moved = (f"{_key(name)} = {_number(value)}" for name, value in position.thicknesses.items())
    yield f"thickness_mm = {{ {', '.join(moved)} }}"


def _material(glass):
    if isinstance(glass, Air):
        return '"air"'
    if isinstance(glass, ConstantGlass):
        return f"{{ nd = {_number(glass.nd)} }}"
    if isinstance(glass, AbbeGlass):
        deviation = f", dpgf = {_number(glass.dpgf)}" if glass.dpgf != 0.0 else ""
        return f"{{ nd = {_number(glass.nd)}, vd = {_number(glass.vd)}{deviation} }}"
    if isinstance(glass, SeriesGlass):
        return f"{{ series_um = {_numbers(glass.coefficients)} }}"
    return _sellmeier(glass)


def _sellmeier(glass: SellmeierGlass):
    # A name stands for the catalogue's figures; with others the figures themselves must stand.
    if glass.name in catalog_names() and catalog_glass(glass.name) == glass:
        return _text(glass.name)
    b, c_um2 = _numbers(glass.b), _numbers(glass.c_um2)
    return f"{{ sellmeier_b = {b}, sellmeier_c_um2 = {c_um2} }}"


def _ids(prescription):
    ids = [surface.id for surface in prescription.surfaces]
    focus = prescription.focus
    for number in () if focus is None else (focus.first, focus.last):
        name = f"S{number}"
        while ids[number - 1] is None:
            if name not in ids:
                ids[number - 1] = name
            name += "_"
    return ids


def _numbers(values):
    return f"[{', '.join(map(_number, values))}]"


def _number(value):
    value = float(value)
    if math.isinf(value):
        return "inf" if value > 0.0 else "-inf"
    # The shortest text that reads back as the same float.
    return repr(value)


def _key(name):
    return name if ID_PATTERN.fullmatch(name) else _text(name)


def _text(text):
    escaped = text.replace("\\", "\\\\").replace('"', '\\"')
    shown = (c if c.isprintable() else f"\\U{ord(c):08x}" for c in escaped)
    return f'"{"".join(shown).replace("\\U0000000a", "\\n")}"'
