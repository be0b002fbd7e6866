"""`aplanat lens trace`: a fan of rays from an axial point, or the vignetting of a beam."""

import numpy as np

from ...optics.glass import REFERENCE_WAVELENGTH_NM
from ...optics.paraxial import first_order, image_distance
from ...optics.rays.trace import Rays, RayStatus, trace
from ..words.text_table import text_table
from .lens_arguments import DEFAULT_GRID, DEFAULT_RHO
from .lens_command import open_lens, tell_warnings

# Default planes around the paraxial image, in focal lengths.
_PLANES = (-0.05, -0.01, 0.0, 0.01)


def trace_lens(arguments, console):
    """Carry out `aplanat lens trace`; parameters and result as `lens_command.lens`."""
    read = open_lens(arguments.lens)
    tell_warnings(read, console)
    configuration = read.prescription.configuration(arguments.zoom)
    wavelength = arguments.wavelength or REFERENCE_WAVELENGTH_NM
    answer = {
        "name": read.prescription.name,
        "label": configuration.label,
        "wavelength_nm": wavelength,
    }
    if arguments.field_deg is None:
        distance = arguments.object_to_first_vertex_mm
        planes = arguments.planes_mm or default_planes(configuration, distance)
        rho = arguments.rho or DEFAULT_RHO
        answer |= axis_fan(configuration, distance, rho, planes, wavelength)
        text = _fan_text
    else:
        grid = arguments.grid or DEFAULT_GRID
        answer |= beam(configuration, arguments.field_deg, wavelength, grid)
        text = _beam_text
    if not arguments.json:
        console.answer(text(answer))
    return answer


def axis_fan(configuration, object_to_first_vertex, rho, planes, wavelength_nm):
    """Rays from an axial point through heights in the paraxial entrance pupil.

    The pupil is that of the reference wavelength at any wavelength. Rims end no ray; the first rim
    that would block it is returned.

    Parameters
    ----------
    configuration : Configuration
    object_to_first_vertex : float
        mm.
    rho : sequence of float
        Heights in units of the pupil's radius.
    planes : sequence of float
        mm behind the last vertex.
    wavelength_nm : float

    Returns
    -------
    dict
        ``rho``, ``blocked_at_surface``, ``tan_slope``, ``height_at_last_vertex_plane_mm`` by ray
        and ``heights_mm`` by plane and ray; None where a ray misses a surface or is totally
        reflected.
    """
    pupil = first_order(configuration)
    start = np.array([0.0, 0.0, -object_to_first_vertex])
    heights = np.asarray(rho, dtype=float) * pupil.enp_diameter / 2.0
    way = np.zeros((len(heights), 3))
    way[:, 1] = heights
    way[:, 2] = pupil.enp_z + object_to_first_vertex
    # A pupil behind the object: light travels towards +z all the same.
    way *= np.where(way[:, 2:] < 0.0, -1.0, 1.0)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    traced = trace(
        configuration, Rays(np.tile(start, (len(heights), 1)), way), wavelength_nm, clip=False
    )
    failed = np.isin(traced.status, (RayStatus.MISSED, RayStatus.TOTAL_REFLECTION))
    ahead = np.where(failed, 1.0, traced.directions[:, 2])
    last = configuration.rear_vertex
    return {
        "object_to_first_vertex_mm": object_to_first_vertex,
        "plane_distance_mm": list(planes),
        "rho": list(rho),
        "blocked_at_surface": _or_none(traced.surface, failed),
        "tan_slope": _or_none(traced.directions[:, 1] / ahead, failed),
        "height_at_last_vertex_plane_mm": _or_none(traced.at_plane(last)[:, 1], failed),
        "heights_mm": [_or_none(traced.at_plane(last + plane)[:, 1], failed) for plane in planes],
    }


def default_planes(configuration, object_to_first_vertex):
    """Planes around the paraxial image of an axial point, and the focus of infinity.

    Parameters
    ----------
    configuration : Configuration
    object_to_first_vertex : float
        mm.

    Returns
    -------
    tuple of 5 float
        mm behind the last vertex that refracts.
    """
    values = first_order(configuration)
    behind = configuration.vertices[-1] - configuration.rear_vertex
    image = image_distance(configuration, object_to_first_vertex) + behind
    return (*(image + share * values.efl for share in _PLANES), values.bfl + behind)


def beam(configuration, field_deg, wavelength_nm, grid):
    """Measure the vignetting of a beam from infinity.

    Parameters
    ----------
    configuration : Configuration
    field_deg : float
    wavelength_nm : float
    grid : int
        Rays along each side.

    Returns
    -------
    dict
        ``field_deg``, ``area_passing_mm2`` and ``fraction_of_paraxial_pupil``, with
        ``area_stop_only_mm2`` and ``unvignetted_fraction``.
    """
    from ...optics.rays.vignetting import vignetting

    found = vignetting(configuration, field_deg, wavelength_nm, grid=grid)
    return {
        "field_deg": field_deg,
        "grid": grid,
        "area_passing_mm2": found.area_passing,
        "fraction_of_paraxial_pupil": found.fraction_of_paraxial_pupil,
        "area_stop_only_mm2": found.area_stop_only,
        "unvignetted_fraction": found.unvignetted_fraction,
    }


def _or_none(values, failed):
    return [None if bad else value for value, bad in zip(values.tolist(), failed, strict=True)]


def _heading(answer):
    place = f", at {answer['label']}" if answer["label"] else ""
    return f"{answer['name']}{place}, {answer['wavelength_nm']:g} nm"


def _fan_text(answer):
    planes = [f"y at {plane:.4f}" for plane in answer["plane_distance_mm"]]
    rows = [["rho", "blocked at", "slope", *planes]]
    for ray, rho in enumerate(answer["rho"]):
        surface = answer["blocked_at_surface"][ray]
        numbers = [answer["tan_slope"][ray], *(plane[ray] for plane in answer["heights_mm"])]
        rows.append(
            [
                f"{rho:g}",
                "lost" if surface is None else "" if surface == 0 else f"surface {surface}",
                *("-" if number is None else f"{number:.6f}" for number in numbers),
            ]
        )
    start = f"rays from {answer['object_to_first_vertex_mm']:g} mm in front of surface 1"
    table = text_table(rows, right=set(range(len(rows[0]))) - {1})
    return f"{_heading(answer)}\n{start}; planes and heights in mm, behind the last vertex\n{table}"


def _beam_text(answer):
    facts = [
        ["area that passes", f"{answer['area_passing_mm2']:.4f} mm2"],
        ["area that passes the stop alone", f"{answer['area_stop_only_mm2']:.4f} mm2"],
        ["share of these", f"{answer['unvignetted_fraction']:.4f}"],
        ["share of the paraxial pupil", f"{answer['fraction_of_paraxial_pupil']:.4f}"],
    ]
    start = f"beam from infinity, {answer['field_deg']:g}° from the axis"
    return f"{_heading(answer)}\n{start}\n{text_table(facts, right={1})}"
