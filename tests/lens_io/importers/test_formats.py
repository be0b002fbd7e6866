"""What each foreign format may say, and how it is refused."""

import math

import numpy as np
import pytest

from addon.errors import InputError, LensFileError
from addon.lens_io.importers import ImportOptions, glass_option, import_bytes, import_lens
from addon.optics.glass import AbbeGlass, ConstantGlass
from addon.optics.paraxial import first_order
from tests.lens_io.importers.foreign_texts import BENCH, CODEV, LAST, ND, PBRT, RADIUS, VD, ZEMAX
from tests.lens_io.importers.importing import assert_refused, edited, read, refusal

ALL = {"a.dat": PBRT, "a.zmx": ZEMAX, "a.seq": CODEV, "a.txt": BENCH}


@pytest.mark.parametrize("name", ALL)
def test_each_format_gives_the_same_singlet(name):
    lens = read(ALL[name], name).prescription
    front, back, stop = lens.surfaces
    assert (front.radius, back.radius) == (RADIUS, -RADIUS)
    assert (front.thickness, back.thickness) == (4.0, 3.0)
    assert front.semi_diameter == back.semi_diameter == 10.0
    assert float(front.glass.index(587.5618)) == pytest.approx(ND, abs=1e-12)
    assert stop.is_stop and math.isinf(stop.radius)
    # The lensmaker's equation for a thick lens.
    power = (ND - 1) * (2 / RADIUS - (ND - 1) * 4.0 / (ND * RADIUS**2))
    assert first_order(lens.configuration()).efl == pytest.approx(1 / power, rel=1e-12)
    assert lens.name == "Singlet"


@pytest.mark.parametrize("name", ALL)
def test_content_tells_the_format_whatever_the_ending(name):
    assert read(ALL[name], "lens.unknown").prescription.surfaces
    assert read(ALL[name].replace("\n", "\r\n"), name).prescription.surfaces


@pytest.mark.parametrize("name", ["a.dat", "a.zmx", "a.seq", "a.txt", "a.xyz"])
@pytest.mark.parametrize(
    "content", [b"", b"hello world\n", b"\x00\x01\x02" * 40, b"\xff\xfe\x00\xd8"]
)
def test_other_content_is_not_this_format(name, content):
    with pytest.raises(LensFileError) as caught:
        import_bytes(content, name)
    assert [finding.code for finding in caught.value.findings] == ["I01"]


def test_files_that_cannot_be_read_or_are_too_large(tmp_path):
    large = tmp_path / "large.dat"
    large.write_bytes(b"1 1 1 1\n" * (1 << 17) + b" ")
    for path in (large, tmp_path / "absent.zmx", tmp_path):
        with pytest.raises(LensFileError) as caught:
            import_lens(path)
        assert [finding.code for finding in caught.value.findings] == ["E01"]


# pbrt


def test_thickness_dialect_is_asked_for_when_both_or_no_end_is_zero():
    rows = PBRT.replace("0 0 0 12", "0 1 0 12")
    assert_refused(rows, "a.dat", "I06", "--thickness before|after")
    after = read(rows, "a.dat", thickness="after")
    assert [s.thickness for s in after.prescription.surfaces[:2]] == [4.0, 3.0]
    before = read(rows, "a.dat", thickness="before")
    assert [s.thickness for s in before.prescription.surfaces[:2]] == [3.0, 1.0]
    assert "distance behind the lens, 1 mm (line 5)" in after.ignored


def test_an_option_does_not_overrule_the_file():
    imported = read(PBRT, "a.dat", thickness="before", stop=1)
    assert imported.prescription == read(PBRT, "a.dat").prescription
    assert [line.split(":")[0] for line in imported.ignored] == [
        *("option --thickness", "option --stop")
    ]


def test_table_without_stop_asks_for_it():
    table = "50 4 1.5 20\n-50 0 1 20\n"
    assert_refused(table, "a.dat", "I06", "--stop N", "1, 2")
    assert_refused(table, "a.dat", "I06", "asked for 3", stop=3)
    assert read(table, "a.dat", stop=2).prescription.surfaces[1].is_stop


def test_a_table_with_two_stops_asks_which():
    table = PBRT.replace("50.0 4.0", "0 5 0 30\n50.0 4.0", 1)
    assert_refused(table, "a.dat", "I06", "more than one stop", "--stop N")
    assert read(table, "a.dat", stop=4).prescription.surfaces[3].is_stop


@pytest.mark.parametrize(
    "row", ["1 2 3", "1 2 3 4 5", "1 2 x 4", "nan 1 1.5 2", "1e999 1 1.5 2", "1_0 1 1.5 2"]
)
def test_malformed_row_is_named_with_its_text(row):
    assert_refused(PBRT.replace("0 0 0 12", f"{row}\n0 0 0 12"), "a.dat", "I07", "line 5", row)


@pytest.mark.parametrize("row", ["30 1 0 12", "50 4 1.5 20\n0 1 0 12"])
def test_index_zero_belongs_to_a_plane_in_air(row):
    assert_refused(PBRT.replace("0 0 0 12", f"{row}\n0 0 0 12"), "a.dat", "I07", "index 0")


def test_plane_of_glass_is_no_stop():
    lens = read("0 4 1.5 20\n-50 3 1 20\n0 0 1 12\n", "a.dat").prescription
    assert [surface.is_stop for surface in lens.surfaces] == [False, False, True]
    assert math.isinf(lens.surfaces[0].radius)


# Zemax


# CODE V


# Optical-bench tables


@pytest.mark.parametrize(
    ("old", "new", "code", "said"),
    [
        ("\tAS\t", "\tXX\t", "I07", "AS, FS, CG"),
        ("2AS\tAS", "2AS\tFS", "I06", "--stop N"),
        ("\tBf\t\t11", "\td9\t\t11", "I07", "variable distances"),
        ("1\t50.0\t4.0\t1.5168", "1\t50.0\t4.0\tglass", "I07", "nd and vd"),
        ("\t20\t", "\ttwenty\t", "I07", "diameter"),
    ],
)
def test_a_fault_of_a_bench_table_is_refused_with_its_reason(old, new, code, said):
    assert_refused(edited(BENCH, old, new), "a.txt", code, said)


def test_bench_aspheres_by_the_constants_of_the_table():
    def asphere(constant):
        text = edited(BENCH, "[constants]", f"[constants]\n{constant}")
        text += "[aspherical data]\n1\t50.0\t-0.5\t1e-9\t1e-6\t0\t1e-10\n"
        return read(text, "a.txt").prescription.surfaces[0]

    assert asphere("Scaled\t50").asphere == ((4, 1e-9), (6, 1e-6), (10, 1e-10))
    assert asphere("AsphericalA2").asphere == ((2, 1e-9), (4, 1e-6), (8, 1e-10))
    assert asphere("AsphericalA2").conic == -0.5
    with pytest.raises(LensFileError, match="I04.*odd term a3"):
        asphere("AsphericalOddCount\t1")
    other = BENCH + "[aspherical data]\n1\t60.0\t0\t1e-6\n"
    assert_refused(other, "a.txt", "I07", "radius 50")


def test_bench_columns_that_focus_near_are_reported_and_left_out():
    near = edited(BENCH, f"Bf\t{LAST}", f"Bf\t{LAST}\t60.0").replace("49.1", "49.1\t48.0")
    near = edited(near, "F-Number", "d0\tInfinity\t400\nF-Number")
    imported = read(near, "a.txt")
    assert imported.prescription.zoom == ()
    assert imported.prescription.surfaces[-1].thickness == LAST
    assert any(line.startswith("columns 2 of the distances") for line in imported.ignored)


# Options and sound values


def test_options_refuse_what_means_nothing():
    for bad in ({"thickness": "middle"}, {"radii": "x"}, {"stop": 0}, {"f_number": -1.0},
                {"half_field_deg": 90.0}, {"f_number": math.nan}):  # fmt: skip
        with pytest.raises(InputError):
            ImportOptions(**bad)


def test_the_glass_option_takes_an_index_with_or_without_abbe_number():
    assert glass_option("BK7=1.5168,64.17") == ("BK7", AbbeGlass(1.5168, 64.17))
    assert glass_option("X=1.5") == ("X", ConstantGlass(1.5))
    for bad in ("BK7", "=1.5", "BK7=", "BK7=0.9", "BK7=1.5,2", "BK7=1.5,60,1", "BK7=nan"):
        with pytest.raises(InputError):
            glass_option(bad)


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("  DISZ 3.0", "  DISZ -3.0", "E09"),
        ("  DIAM 10 1", "  DIAM -10 1", "E09"),
        ("  DIAM 10 1", "  DIAM 60 1", "E14"),
        (f"0 {ND} {VD}", f"0 0.9 {VD}", "E19"),
        ("CURV -0.02", "CURV 0.06", "E24"),
    ],
)
def test_a_lens_that_is_not_possible_is_refused_with_the_line_of_its_surface(old, new, code):
    findings = refusal(edited(ZEMAX, old, new), "a.zmx")
    assert code in {finding.code for finding in findings}
    if code != "E24":
        assert all("line" in one.message for one in findings if one.path.startswith("surface["))


def test_far_too_many_surfaces_are_refused_at_once():
    for name, row in (("a.dat", "50 1 1.5 10\n"), ("a.seq", "S 1 1\n")):
        head = "" if name == "a.dat" else "RDM\nSO 0 1e10\n"
        findings = refusal(head + row * 5000, name)
        assert "E11" in {finding.code for finding in findings}


def test_notes_say_what_was_computed():
    notes = read(PBRT, "a.dat").prescription.notes
    for said in ("for tests", "Image distance", "Focal length", "f-number", "Half field"):
        assert said in notes
    assert np.isfinite(read(PBRT, "a.dat").prescription.half_field_deg)
