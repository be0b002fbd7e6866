"""`aplanat bench --lens`: how fast a lens is traced, and how fast and how good its profile is.

Runs without Blender, but in a checkout only: what a profile is compared with is not shipped.
"""

import time

import numpy as np

from addon.cli.lens.lens_command import open_lens
from addon.cli.words.json_file import write_json
from addon.errors import InputError
from addon.files.version import version
from addon.files.whole_file import check_writable, removed_on_signals
from addon.optics.glass import REFERENCE_WAVELENGTH_NM
from addon.optics.paraxial import first_order
from addon.optics.rays.trace import Rays, trace

_RAYS = 1_000_000
# Other work of the machine makes a run slower, never faster: the best one counts.
_RUNS = 3


def bench_lenses(arguments, console):
    """Carry out `aplanat bench --lens`; parameters and result as `reference_method.bench`."""
    with removed_on_signals():
        if arguments.output:
            check_writable(arguments.output)
        lenses = []
        for word in arguments.lens:
            prescription = open_lens(word).prescription
            for configuration in prescription.configurations():
                found = _measure(prescription, configuration, console)
                lenses.append(found)
                console.say(_line(found))
        answer = {"command": "bench", "aplanat": version(), "lenses": lenses}
        if arguments.output:
            write_json(arguments.output, answer)
    return answer


def rays_per_second(configuration, count=_RAYS, runs=_RUNS):
    """Trace an axial beam from infinity that fills the entrance pupil.

    Parameters
    ----------
    configuration : Configuration
    count : int
        Rays.
    runs : int
        Of which the best one counts.

    Returns
    -------
    float
        Rays through the whole lens per second.
    """
    pupil = first_order(configuration).enp_diameter / 2.0
    # A spiral of equal areas.
    share = (np.arange(count) + 0.5) / count
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    radius = pupil * np.sqrt(share)
    origins = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.zeros(count)], axis=-1)
    origins[:, 2] = -configuration.vertices[-1] - pupil
    rays = Rays(origins, np.broadcast_to([0.0, 0.0, 1.0], origins.shape).copy())
    seconds = []
    for _ in range(runs):
        start = time.perf_counter()
        trace(configuration, rays, REFERENCE_WAVELENGTH_NM)
        seconds.append(time.perf_counter() - start)
    return count / min(seconds)


def _measure(prescription, configuration, console):
    try:
        from ..reference.profile_bench import bench_profile
    except ImportError as error:
        raise InputError(
            "bench --lens compares with a direct trace, which only a checkout has; use"
            " scripts/aplanat there"
        ) from error
    if not configuration.of_revolution:
        raise InputError(
            f"bench --lens: '{prescription.name}' has cylinders; a profile is made for lenses of"
            " revolution"
        )
    place = f" at {configuration.label}" if configuration.label else ""
    name = prescription.name + place
    console.progress(f"{name}: tracing {_RAYS} rays")
    rate = rays_per_second(configuration)
    found = bench_profile(
        configuration,
        prescription.name,
        prescription.focus,
        progress=lambda share: console.progress(f"{name}: {share:.0%} of the grid"),
    )
    return {**found, "rays": _RAYS, "rays_per_second": rate}


def _line(found):
    place = f" at {found['zoom']}" if found["zoom"] else ""
    seconds, psnr = found["seconds"], found["psnr"]
    return (
        f"{found['lens']}{place}: {found['rays_per_second'] / 1e6:.2f} million rays a second;"
        f" profile {seconds['achromatic']:.2f} s, in colour {seconds['chromatic']:.2f} s; rows hold"
        f" their energy within {found['row_energy_error']:.1e}; PSNR median"
        f" {psnr['median']:.1f} dB, lowest {psnr['minimum']:.1f} dB"
    )
