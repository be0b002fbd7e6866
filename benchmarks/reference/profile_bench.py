"""How good and how fast the bokeh profile of a lens is, against tracing every ray."""

import time

import numpy as np

from addon.lens_bokeh.tables.mapping import frame_table, pattern_row
from addon.lens_bokeh.tables.profile import make_profile, profile_table
from addon.lens_bokeh.tables.ray_map_tracing import nearest_object
from addon.optics.paraxial import first_order

from .traced_bokeh import (
    RAYS,
    RINGS_PER_PIXEL,
    focused_lens,
    picture_of_rings,
    psnr,
    rings_of_row,
    traced_cone,
    traced_rings,
)

PIXELS = 256
# From H, mm; a lens that does not get as near starts at its own nearest.
OBJECT_DISTANCES = (300.0, 500.0, 800.0, 1200.0, 2000.0, 4000.0, 10000.0, np.inf)
FOCUS_DISTANCES = (450.0, 800.0, 1500.0, 3000.0, 8000.0, np.inf)
# Stops below wide open.
STOPS = (0.0, 1.5, 3.0)


def bench_profile(
    configuration, name="", focus_group=None, *, rays=RAYS, objects=8, focuses=6, progress=None
):
    """Measure the profile of one lens.

    Parameters
    ----------
    configuration : Configuration
        Wide open.
    name : str
    focus_group : FocusGroup or None
    rays : int
        Of each direct trace.
    objects, focuses : int
        How many of the grid's distances to use, at most 8 and 6.
    progress : callable or None
        Called with the share done, 0 to 1.

    Returns
    -------
    dict
        ``seconds``: of the achromatic and the chromatic profile, each with its 1024 x 1024 table,
        of one row, and of a frame's table; ``row_energy_error``: the largest;
        ``psnr``: median and minimum over the grid, and every value as
        [object, focus, f-number, dB], None for infinity.
    """
    seconds = {}
    started = time.perf_counter()
    profile = make_profile(configuration, name=name, focus_group=focus_group, chromatic=False)
    table = profile_table(profile)
    seconds["achromatic"] = time.perf_counter() - started
    started = time.perf_counter()
    colored = make_profile(configuration, name=name, focus_group=focus_group, chromatic=True)
    colored_table = profile_table(colored)
    seconds["chromatic"] = time.perf_counter() - started
    started = time.perf_counter()
    frame_table(profile, np.inf, configuration.f_number)
    seconds["frame_table"] = time.perf_counter() - started
    values = psnr_grid(
        configuration,
        profile,
        focus_group,
        rays,
        objects=objects,
        focuses=focuses,
        progress=progress,
    )
    started = time.perf_counter()
    pattern_row(profile, 2000.0, np.inf, configuration.f_number)
    seconds["row"] = time.perf_counter() - started
    decibels = [value[-1] for value in values]
    return {
        "lens": name,
        "zoom": configuration.label,
        "seconds": seconds,
        "row_energy_error": float(
            max(np.abs(t.energies - 1.0).max() for t in (table, colored_table))
        ),
        "psnr": {
            "median": float(np.median(decibels)),
            "minimum": min(decibels),
            "values": [[None if np.isinf(x) else x for x in value] for value in values],
        },
    }


def grid(configuration, nearest_focus=0.0, objects=8, focuses=6):
    """Distances and f-numbers to compare at.

    Parameters
    ----------
    configuration : Configuration
    nearest_focus : float
        mm from surface 1; distances are stretched to begin there.
    objects, focuses : int

    Returns
    -------
    object_distances, focus_distances, f_numbers : list of float
    """
    order = first_order(configuration)
    nearest = order.h - nearest_object(configuration, order)

    def chosen(distances, count, least):
        stretch = float(max(1.0, 1.05 * least / distances[0]))
        picked = np.linspace(0, len(distances) - 1, count).round().astype(int)
        return [float(distances[i]) * stretch for i in picked]

    f_numbers = [configuration.f_number * 2.0 ** (stop / 2.0) for stop in STOPS]
    return (
        chosen(OBJECT_DISTANCES, objects, nearest),
        chosen(FOCUS_DISTANCES, focuses, max(nearest, nearest_focus + order.h)),
        f_numbers,
    )


def psnr_grid(
    configuration, profile, focus_group=None, rays=RAYS, *, objects=8, focuses=6, progress=None
):
    """Compare the profile's patterns with traced ones.

    Each pattern is 256 pixels across, whatever its size in mm; the peak is the largest value of the
    traced pattern.

    Parameters
    ----------
    configuration : Configuration
        Wide open.
    profile : LensProfile
        Achromatic.
    focus_group, rays, objects, focuses, progress
        As for `bench_profile`.

    Returns
    -------
    list of list of float
        [object distance, focus distance, f-number, dB].
    """
    nearest = 1.0 / profile.nearness[-1] if len(profile.states) > 1 else 0.0
    object_distances, focus_distances, f_numbers = grid(configuration, nearest, objects, focuses)
    lenses = [focused_lens(configuration, d, focus_group) for d in focus_distances]
    values = []
    for i, object_distance in enumerate(object_distances):
        for f_number in f_numbers:
            cone = None
            for focus_distance, lens in zip(focus_distances, lenses, strict=True):
                # The rays of a lens that is moved as a whole do not know the focus.
                if cone is None or focus_group:
                    cone = traced_cone(lens, object_distance, f_number, rays=rays)
                row = pattern_row(profile, object_distance, focus_distance, f_number)
                decibels = compare(row, traced_rings(cone, lens.sensor, rings=_RINGS))
                values.append([object_distance, focus_distance, f_number, decibels])
        if progress:
            progress((i + 1) / len(object_distances))
    return values


def compare(row, traced):
    """PSNR of a profile's row against traced rings, as pictures."""
    energy = rings_of_row(row, traced.extent, len(traced.energy))
    return psnr(picture_of_rings(energy, PIXELS), picture_of_rings(traced.energy, PIXELS))


_RINGS = PIXELS // 2 * RINGS_PER_PIXEL
