"""Lens files that failed: the values that a paraxial sum by hand gives for them."""

from pathlib import Path

import pytest

from addon.lens_io.any_lens_file import read_any_lens
from addon.optics.paraxial import first_order

FOLDER = Path(__file__).resolve().parents[3] / "shared" / "cases" / "lenses"

pytestmark = pytest.mark.skipif(
    not FOLDER.is_dir(), reason="the folder shared/cases beside the checkout is not there"
)

# File: focal length, back focus from the last glass, f-number; None where it is not told.
VALUES = {
    "k1-cone-angle-tenth.zmx": (49.213, None, 144.6),
    "k1-cone-angle.zmx": (49.213, None, 2.40),
    "k2-working-fnum.zmx": (49.213, None, 4.10),
    "k2-image-space-fnum.zmx": (49.213, None, 8.0),
    "k3-optiland-so-inf.seq": (34.855, 33.347, 4.357),
    "k4-iset-focal-row.dat": (76.067, 71.055, None),
    "k5-unit-meter.zmx": (1020.26, 1015.25, 10.2),
    "k6-codev-solve-cir-clr.seq": (116.679, 111.640, 5.834),
    "k7-bench-spaces.txt": (76.067, None, None),
    "k8-bench-negative-stop.txt": (3.787, 2.926, None),
    "k9-no-asp-line.seq": (30.264, 26.920, 3.026),
}


@pytest.mark.parametrize("name", VALUES)
def test_lens_file_has_the_right_values(name):
    efl, bfl, f_number = VALUES[name]
    configuration = read_any_lens(FOLDER / name).prescription.configuration()
    values = first_order(configuration)
    behind = configuration.vertices[-1] - configuration.rear_vertex
    # To the digits that are told: half of the third place, or of the second above 1000 mm.
    digits = 5.1e-3 if efl > 1000.0 else 5.1e-4
    assert values.efl == pytest.approx(efl, abs=digits)
    assert bfl is None or values.bfl + behind == pytest.approx(bfl, abs=digits)
    assert f_number is None or values.f_number == pytest.approx(f_number, rel=3e-3)


def test_the_solve_is_named_in_a_warning():
    warnings = read_any_lens(FOLDER / "k6-codev-solve-cir-clr.seq").warnings
    assert any("CUY UMY" in found.message for found in warnings)


@pytest.mark.parametrize(
    ("name", "overlap"), [("k7-bench-spaces.txt", 1.5), ("k8-bench-negative-stop.txt", -0.25)]
)
def test_the_stop_stands_where_the_table_says(name, overlap):
    surfaces = read_any_lens(FOLDER / name).prescription.surfaces
    stop = next(number for number, surface in enumerate(surfaces) if surface.is_stop)
    before = stop - 1 if stop else stop
    assert surfaces[before].thickness == pytest.approx(overlap)
