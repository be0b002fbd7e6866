"""Rays per second of Aplanat's tracer and of optiland's, the same rays in the same run.

Run by scripts/bench-tracer, which brings optiland. Both trace a beam from infinity that fills the
entrance pupil, through every surface with its rim to the image plane, on one thread; optiland with
its numpy backend and without records. Making the rays is timed for Aplanat only.
The two must agree on every ray, else the rates mean nothing.
"""

import argparse
import json
import os
import platform
import sys
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

import numpy as np  # noqa: E402  (after the number of threads is set)

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from addon.lens_io.library import Library  # noqa: E402
from addon.optics.glass import REFERENCE_WAVELENGTH_NM  # noqa: E402
from addon.optics.media import indices  # noqa: E402
from addon.optics.paraxial import first_order  # noqa: E402
from addon.optics.rays.trace import Rays, trace  # noqa: E402

# Heights in the image plane may differ by this, mm: rounding over a dozen surfaces.
AGREEMENT = 1.0e-9


def main():
    """Time both tracers and print the ratio."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--lens", default="double-gauss-50mm-f2", help="id or file of a lens")
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--field-deg", type=float, default=0.0)
    parser.add_argument("--repeats", type=int, default=5, help="the best one counts")
    options = parser.parse_args()

    configuration = Library().open(options.lens).prescription.configuration()
    origins, direction = beam(configuration, options.rays, options.field_deg)
    optic = optiland_lens(configuration)

    ours, theirs = [], []
    for _ in range(options.repeats):
        seconds, places, passed = run_aplanat(configuration, origins, direction)
        ours.append(seconds)
        seconds, their_places, their_passed = run_optiland(optic, origins, direction)
        theirs.append(seconds)

    difference = float(np.abs(places - their_places)[passed & their_passed].max())
    disagreeing = int(np.count_nonzero(passed != their_passed))
    rates = [options.rays / min(ours), options.rays / min(theirs)]
    report = {
        "lens": options.lens,
        "rays": options.rays,
        "field_deg": options.field_deg,
        "passed": int(np.count_nonzero(passed)),
        "aplanat_rays_per_second": round(rates[0]),
        "optiland_rays_per_second": round(rates[1]),
        "ratio": round(rates[0] / rates[1], 2),
        "largest_height_difference_mm": difference,
        "rays_passing_one_only": disagreeing,
        "optiland": optiland_version(),
        "numpy": np.__version__,
        "python": platform.python_version(),
    }
    print(json.dumps(report, indent=2))
    return 0 if difference <= AGREEMENT and disagreeing == 0 else 1


def beam(configuration, count, field_deg):
    """Origins spread evenly over the paraxial entrance pupil, and the direction of all rays."""
    values = first_order(configuration)
    random = np.random.default_rng(20)
    radius = 0.5 * values.enp_diameter * np.sqrt(random.random(count))
    turn = 2.0 * np.pi * random.random(count)
    z = np.full(count, values.enp_z)
    field = np.radians(field_deg)
    origins = np.stack([radius * np.cos(turn), radius * np.sin(turn), z], axis=-1)
    return origins, np.array([0.0, np.sin(field), np.cos(field)])


def run_aplanat(configuration, origins, direction):
    """Return the seconds of processor time of our tracer, and where its rays land."""
    start = time.process_time()
    rays = Rays(origins, np.broadcast_to(direction, origins.shape))
    traced = trace(configuration, rays, REFERENCE_WAVELENGTH_NM)
    places = traced.at_plane(configuration.sensor)
    seconds = time.process_time() - start
    return seconds, places, traced.passed


def optiland_lens(configuration):
    """Return a configuration as a lens of optiland."""
    import optiland.backend
    from optiland.materials import IdealMaterial
    from optiland.optic import Optic

    optiland.backend.set_backend("numpy")
    optic = Optic()
    optic.surfaces.add(index=0, thickness=np.inf)
    media = indices(configuration, REFERENCE_WAVELENGTH_NM)
    for number, surface in enumerate(configuration.surfaces, 1):
        if surface.asphere or surface.curved_along:
            raise SystemExit("this comparison is for spheres and conics only")
        optic.surfaces.add(
            index=number,
            radius=surface.radius,
            conic=surface.conic,
            thickness=surface.thickness,
            material=IdealMaterial(n=media[number]),
            is_stop=surface.is_stop,
            aperture=2.0 * surface.semi_diameter,
        )
    optic.surfaces.add(index=len(configuration.surfaces) + 1)
    return optic


def run_optiland(optic, origins, direction):
    """Return the seconds of processor time of optiland, and where its rays land."""
    from optiland.rays import RealRays

    count = len(origins)
    wavelength = np.full(count, REFERENCE_WAVELENGTH_NM / 1000.0)
    directions = [np.full(count, component) for component in direction]
    rays = RealRays(*origins.T.copy(), *directions, np.ones(count), wavelength)
    start = time.process_time()
    # Without the object, whose surface would only check where the rays start.
    optic.surfaces.trace(rays, skip=1, record=False)
    seconds = time.process_time() - start
    return seconds, np.stack([rays.x, rays.y], axis=-1), np.asarray(rays.i) > 0.0


def optiland_version():
    """Return the version of optiland."""
    from importlib.metadata import version

    return version("optiland")


if __name__ == "__main__":
    sys.exit(main())
