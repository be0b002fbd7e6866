"""`aplanat lens info`: description and first-order values of a lens."""

import textwrap

from ...optics.glass import REFERENCE_WAVELENGTH_NM, AbbeGlass, Air, ConstantGlass, SellmeierGlass
from ...optics.media import indices
from ...optics.paraxial import first_order, image_distance, magnification
from ..words.text_table import text_table
from .lens_command import open_lens

# Of the values at a finite distance: the object is that far from the first principal plane of the
# reference wavelength.
_OBJECT_MM = 1000.0
_WIDTH = 100


def tell_facts(arguments, console):
    """Carry out `aplanat lens info`; parameters and result as `lens_command.lens`."""
    read = open_lens(arguments.lens)
    configuration = read.prescription.configuration(arguments.zoom)
    wavelength = arguments.wavelength or REFERENCE_WAVELENGTH_NM
    answer = {
        "name": read.prescription.name,
        "label": configuration.label,
        "wavelength_nm": wavelength,
        "index": list(indices(configuration, wavelength)[1:]),
        **first_order_values(configuration, wavelength),
        "warnings": [found.as_json() for found in read.warnings],
        "labels": [position.label for position in read.prescription.zoom],
        "source": read.prescription.source,
        "file": str(read.path) if read.path else None,
    }
    if not arguments.json:
        console.answer(_text(read, configuration, answer))
    return answer


def first_order_values(configuration, wavelength_nm):
    """First-order values by the names of the command line.

    Parameters
    ----------
    configuration : Configuration
    wavelength_nm : float

    Returns
    -------
    dict of str to float
        mm; None for an exit pupil at infinity. What is measured from the last vertex is measured
        from the last one that refracts.

    Raises
    ------
    PrescriptionError
        If the lens has none at that wavelength.
    """
    values = first_order(configuration, wavelength_nm)
    distance = _OBJECT_MM - first_order(configuration).h
    # A stop behind the glass is no vertex to measure from.
    behind = configuration.vertices[-1] - configuration.rear_vertex
    return {
        "efl_mm": values.efl,
        "bfl_mm": values.bfl + behind,
        "ffl_mm": values.ffl,
        "h_mm": values.h,
        "h_prime_mm": values.h_prime + behind,
        "enp_z_mm": values.enp_z,
        "enp_diameter_mm": values.enp_diameter,
        "exp_z_mm": None if values.exp_z is None else values.exp_z + behind,
        "exp_diameter_mm": values.exp_diameter,
        "f_number": values.f_number,
        "image_distance_1000_mm": image_distance(configuration, distance, wavelength_nm) + behind,
        "magnification_1000": magnification(configuration, distance, wavelength_nm),
    }


def _text(read, configuration, answer):
    lens = read.prescription
    title = lens.name if answer["label"] is None else f"{lens.name}, at {answer['label']}"
    parts = [title, _about(read, answer), _first_order_text(answer), _surfaces_text(configuration)]
    if read.warnings:
        parts.append(_warnings_text(read.warnings))
    return "\n\n".join(part for part in parts if part)


def _about(read, answer):
    lens = read.prescription
    iris = lens.diaphragm
    blades = f"{iris.blades} blades, curvature {iris.blade_curvature:g}" if iris.blades else "round"
    circle = lens.image_circle_diameter
    facts = [
        ("designer", lens.designer),
        ("year", lens.year and str(lens.year)),
        ("source", lens.source),
        ("notes", lens.notes),
        ("zoom", ", ".join(answer["labels"])),
        ("focusing", _focusing(lens)),
        ("iris", blades),
        ("image circle", circle and f"{circle:g} mm"),
        ("projection", lens.projection),
        ("file", answer["file"]),
    ]
    lines = []
    for name, text in facts:
        if text:
            start = f"{name:<14}"
            lines += textwrap.wrap(
                " ".join(text.split()), _WIDTH, initial_indent=start, subsequent_indent=" " * 14
            )
    return "\n".join(lines)


def _focusing(lens):
    if lens.focus is None:
        return "the whole lens moves"
    return f"surfaces {lens.focus.first} to {lens.focus.last} move"


def _first_order_text(answer):
    def mm(key):
        return "at infinity" if answer[key] is None else f"{answer[key]:.4f} mm"

    facts = [
        ("focal length", mm("efl_mm"), "f-number", f"{answer['f_number']:.4f}"),
        ("back focus", mm("bfl_mm"), "front focus", mm("ffl_mm")),
        ("principal plane H", mm("h_mm"), "H'", mm("h_prime_mm")),
        ("entrance pupil at", mm("enp_z_mm"), "diameter", mm("enp_diameter_mm")),
        ("exit pupil at", mm("exp_z_mm"), "diameter", mm("exp_diameter_mm")),
        (
            "image of 1 m at",
            mm("image_distance_1000_mm"),
            "magnification",
            f"{answer['magnification_1000']:.6f}",
        ),
    ]
    heading = f"First order at {answer['wavelength_nm']:g} nm"
    return f"{heading}\n{text_table([list(row) for row in facts], right={1, 3})}"


def _surfaces_text(configuration):
    rows = [["", "radius", "thickness", "semi-diameter", "material", ""]]
    for number, surface in enumerate(configuration.surfaces, 1):
        curved = f"{surface.radius:.5g}" if abs(surface.radius) < float("inf") else "plane"
        rows.append(
            [
                str(number),
                curved,
                f"{surface.thickness:.5g}",
                f"{surface.semi_diameter:.5g}",
                _material(surface.glass),
                _remarks(surface, configuration.label is not None),
            ]
        )
    return text_table(rows, right={0, 1, 2, 3})


def _material(glass):
    match glass:
        case Air():
            return ""
        case AbbeGlass(nd=nd, vd=vd):
            return f"{nd:.5f} {vd:.2f}"
        case ConstantGlass(nd=nd):
            return f"{nd:.5f}"
        case SellmeierGlass(name=str(name)):
            return name
    return f"{float(glass.index(REFERENCE_WAVELENGTH_NM)):.5f}"


def _remarks(surface, zooms):
    remarks = []
    if surface.is_stop:
        remarks.append("stop")
    if surface.asphere or surface.conic:
        remarks.append("asphere" if surface.asphere else f"conic {surface.conic:g}")
    if surface.curved_along:
        remarks.append(f"cylinder in {surface.curved_along}")
    if surface.id and zooms:
        remarks.append(surface.id)
    return ", ".join(remarks)


def _warnings_text(warnings):
    lines = ["Warnings"]
    for found in warnings:
        where = f"{found.path}: " if found.path else ""
        lines += textwrap.wrap(
            f"{found.code} {where}{found.message}",
            _WIDTH,
            initial_indent="  ",
            subsequent_indent="      ",
        )
    return "\n".join(lines)
