"""What each foreign format may say, and how it is refused."""

import math

import numpy as np
import pytest

from addon.errors import InputError, LensFileError
from addon.lens_io.importers import ImportOptions, glass_option, import_bytes, import_lens
from addon.optics.glass import AbbeGlass, ConstantGlass
from addon.optics.paraxial import first_order
from tests.lens_io.importers.foreign_texts import BENCH, CODEV, LAST, ND, PBRT, RADIUS, VD, ZEMAX

ALL = {"a.dat": PBRT, "a.zmx": ZEMAX, "a.seq": CODEV, "a.txt": BENCH}


def read(text, name, **options):
    return import_bytes(text.encode(), name, ImportOptions(**options))


def refusal(text, name, **options):
    with pytest.raises(LensFileError) as caught:
        read(text, name, **options)
    return caught.value.findings


def assert_refused(text, name, code, *said, **options):
    findings = refusal(text, name, **options)
    assert {finding.code for finding in findings} == {code}, findings
    for words in said:
        assert any(words in f"{one.path} {one.message}" for one in findings), findings


def edited(text, old, new):
    assert old in text
    return text.replace(old, new, 1)


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


def test_two_stops_ask_which():
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


@pytest.mark.parametrize(
    ("old", "new", "code", "said"),
    [
        ("MODE SEQ", "MODE NSC", "I04", "NSC"),
        ("MODE SEQ\n", "", "I04", "mode"),
        ("UNIT MM", "UNIT FURLONG", "I08", "MM, CM, M, IN"),
        ("UNIT MM X W X CM MR CPMM\n", "", "I08", "unit"),
        ("TYPE STANDARD\n  CURV 0.02", "TYPE COORDBRK\n  CURV 0.02", "I03", "line"),
        ("TYPE STANDARD\n  CURV 0.02", "TYPE TOROIDAL\n  CURV 0.02", "I04", "TOROIDAL"),
        ("TYPE STANDARD\n  CURV 0.02", "TYPE ODDASPHE\n  CURV 0.02", "I04", "ODDASPHE"),
        ("GLAS ___BLANK 1", "GLAS MIRROR 0", "I02", "line"),
        ("GLAS ___BLANK 1", "GLAS BK7 0", "I05", "--glass NAME=ND,VD"),
        ("  STOP\n", "", "I06", "--stop N"),
        ("  DISZ 3.0", "  DISZ INFINITY", "I07", "infinity"),
        ("  DISZ 3.0", "  DISZ three", "I07", "three"),
        ("  DISZ 3.0\n", "", "I07", "DISZ"),
        ("SURF 2", "SURF 5", "I07", "SURF 5"),
        ("  DIAM 10 1 0 0 1", "  CLAP 2 10", "I04", "hole"),
        ("  DIAM 10 1 0 0 1", "  SQAP 2 10", "I04", "round"),
        ("  DIAM 10 1 0 0 1", "  OBDC 2 0", "I03", "off the axis"),
    ],
)
def test_zemax_refusals(old, new, code, said):
    assert_refused(edited(ZEMAX, old, new), "a.zmx", code, said)


@pytest.mark.parametrize(
    ("unit", "factor"), [("MM", 1.0), ("CM", 10.0), ("M", 1000.0), ("IN", 25.4)]
)
def test_zemax_units_scale_every_length(unit, factor):
    asphere = edited(ZEMAX, "TYPE STANDARD\n  CURV 0.02", "TYPE EVENASPH\n  CURV 0.02")
    asphere = edited(asphere, "  DISZ 4.0", "  PARM 2 1e-7\n  CONI -0.5\n  DISZ 4.0")
    lens = read(edited(asphere, "UNIT MM", f"UNIT {unit}"), "a.zmx").prescription
    plain = read(asphere, "a.zmx").prescription
    for one, other in zip(lens.surfaces, plain.surfaces, strict=True):
        assert one.radius == pytest.approx(factor * other.radius, rel=1e-12)
        assert one.thickness == pytest.approx(factor * other.thickness, rel=1e-12)
        assert one.semi_diameter == pytest.approx(factor * other.semi_diameter, rel=1e-12)
        assert one.conic == other.conic
    # The sag scales with the lens: a_4 r^4 at factor r.
    assert lens.surfaces[0].asphere == ((4, pytest.approx(1e-7 * factor**-3, rel=1e-12)),)
    assert lens.f_number == pytest.approx(plain.f_number, rel=1e-5)


def test_utf_16_latin_1_and_utf_8_give_the_same_lens():
    text = edited(ZEMAX, "NAME Singlet", "NAME Objektiv für Ärzte")
    contents = (b"\xff\xfe" + text.encode("utf-16-le"), text.encode("latin-1"), text.encode())
    lenses = [import_bytes(content, "a.zmx").prescription for content in contents]
    assert lenses[0] == lenses[1] == lenses[2]
    assert lenses[0].name == "Objektiv für Ärzte"


def test_zemax_dummy_planes_go_and_their_distances_stay():
    dummy = edited(ZEMAX, "SURF 4", "SURF 4\n  CURV 0\n  DISZ 2.5\nSURF 5")
    imported = read(dummy, "a.zmx")
    assert len(imported.prescription.surfaces) == 3
    assert imported.prescription.surfaces[-1].thickness == LAST + 2.5
    assert any(line.startswith("dummy plane") for line in imported.ignored)


def test_zemax_catalogue_glass_ignores_the_numbers_behind_its_name():
    lens = read(edited(ZEMAX, "GLAS ___BLANK 1 0 1.5168", "GLAS N-SF11 0 0 1.5"), "a.zmx")
    assert lens.prescription.surfaces[0].glass.name == "N-SF11"


def test_another_makers_glass_counts_only_if_the_file_names_the_maker():
    text = edited(ZEMAX, f"GLAS ___BLANK 1 0 {ND} {VD}", "GLAS TAF3 0 0 1.5 40")
    assert_refused(text, "a.zmx", "I05", "TAF3")
    hoya = read(edited(text, "GCAT SCHOTT", "GCAT SCHOTT HOYA"), "a.zmx").prescription
    assert hoya.surfaces[0].glass == AbbeGlass(1.8042, 46.5)
    assert "HOYA" in hoya.notes


def test_zemax_stop_is_what_the_aperture_asks_for_unless_its_rim_is_smaller():
    def stop(text):
        lens = read(text, "a.zmx").prescription
        return lens.surfaces[2].semi_diameter, first_order(lens.configuration())

    radius, values = stop(ZEMAX)
    assert values.enp_diameter == pytest.approx(10.0, rel=1e-12)
    radius, values = stop(edited(ZEMAX, "ENPD 10", "FNUM 8 0"))
    assert values.f_number == pytest.approx(8.0, rel=1e-12)
    radius, _ = stop(edited(ZEMAX, "DIAM 6 0", "DIAM 2 1"))
    assert radius == 2.0
    radius, _ = stop(edited(ZEMAX, "ENPD 10", "FLOA"))
    assert radius == 6.0
    assert_refused(edited(ZEMAX, "ENPD 10\n", "").replace("  DIAM 6 0 0 0 1 \"\"\n", ""), "a.zmx",
                   "I06", "--f-number X")  # fmt: skip


def test_zemax_zoom_positions_rise_by_focal_length():
    # Two lenses at a changing distance; the sensor follows.
    second = ZEMAX[ZEMAX.index("SURF 1") : ZEMAX.index("SURF 3")]
    second = second.replace("SURF 2", "SURF 5").replace("SURF 1", "SURF 4")
    zoom = edited(ZEMAX, "SURF 4", second + "SURF 6") + "MNUM 3 1\n"
    for position, (gap, last) in enumerate(((20.0, 20.0), (10.0, 22.0), (5.0, 25.0)), 1):
        zoom += f"THIC 3 {position} {gap} 0 0 1\nTHIC 5 {position} {last} 0 0 1\n"
    lens = read(zoom, "a.zmx").prescription
    assert [p.thicknesses["D3"] for p in lens.zoom] == [5.0, 10.0, 20.0]
    assert [p.thicknesses["BF"] for p in lens.zoom] == [25.0, 22.0, 20.0]
    computed = [first_order(lens.configuration(label)).efl for label in lens.labels]
    assert computed == sorted(computed)
    assert [p.focal_length for p in lens.zoom] == pytest.approx(computed, rel=1e-5)
    assert_refused(zoom + "GLSS 1 2 N-BK7\n", "a.zmx", "I04", "GLSS")
    assert_refused(zoom + "THIC 9 2 1.0\n", "a.zmx", "I07", "no such surface")


# CODE V


@pytest.mark.parametrize(
    ("old", "new", "code", "said"),
    [
        ("RDM;", "", "I06", "--radii radius|curvature"),
        ("DIM M", "DIM F", "I08", "M, C, I"),
        ("  CIR 10", "  CIR 10; XDE 0.5", "I03", "XDE"),
        ("  CIR 10", "  CIR 10; ADE 5", "I03", "ADE"),
        ("  CIR 10", "  REFL", "I02", "mirror"),
        (f"{ND}:{VD}", "REFL", "I02", "mirror"),
        (f"{ND}:{VD}", "BK7_SCHOTT", "I05", "N-BK7"),
        ("  CIR 10", "  CYL", "I04", "CYL"),
        ("  CIR 10", "  CIR OBS 3", "I04", "hole"),
        ("  STO\n", "", "I06", "--stop N"),
        ("  CIR 10", "  SPH\n  A 1e-5", "I07", "SPH"),
        ("  CIR 10", "  CIR ten", "I07", "ten"),
        ("TITLE 'Singlet'", "TITLE 'Singlet", "I07", "quote"),
        ("SI 0.0 0.0\n", "", "I07", "SI"),
        ("GO", "SCA 2", "I04", "SCA"),
    ],
)
def test_codev_refusals(old, new, code, said):
    assert_refused(edited(CODEV, old, new), "a.seq", code, said)


@pytest.mark.parametrize(
    ("word", "nd", "vd"),
    [
        ("517.642", 1.517, 64.2),
        ("516800.641700", 1.5168, 64.17),
        ("1.5168:64.17", 1.5168, 64.17),
        ("TAF3_HOYA", 1.8042, 46.5),
        ("JLAK14_HIKARI", 1.6968, 55.52),
    ],
)
def test_codev_glasses_by_code(word, nd, vd):
    glass = read(edited(CODEV, f"{ND}:{VD}", word), "a.seq").prescription.surfaces[0].glass
    assert (glass.nd, glass.vd) == pytest.approx((nd, vd), abs=1e-12)


@pytest.mark.parametrize("word", ["NBK7_SCHOTT", "N-BK7_SCHOTT", "nbk7_schott", "NBK7"])
def test_codev_catalogue_names_drop_the_hyphen(word):
    glass = read(edited(CODEV, f"{ND}:{VD}", word), "a.seq").prescription.surfaces[0].glass
    assert glass.name == "N-BK7"


def test_codev_curvatures_are_one_over_the_radii():
    curved = (
        edited(CODEV, "RDM;", "RDM N;").replace("S 50.0", "S 0.02").replace("S -50.0", "S -0.02")
    )
    assert read(curved, "a.seq").prescription == read(CODEV, "a.seq").prescription


def test_codev_lines_go_on_and_hold_several_commands():
    joined = CODEV.replace("S 50.0 4.0", "S 50.0 & ! first surface\n 4.0").replace(
        "\n  CIR", "; CIR"
    )
    assert read(joined.lower(), "a.seq").prescription.surfaces == (
        read(CODEV, "a.seq").prescription.surfaces
    )


def test_codev_asphere_letters_are_even_orders_and_scale_with_the_unit():
    asphere = edited(CODEV, "  CIR 10", "  CIR 1; ASP; K -1.5; A 1e-5; B 1e-7; J 1e-16")
    lens = read(edited(asphere, "DIM M", "DIM C"), "a.seq").prescription
    assert lens.surfaces[0].conic == -1.5
    # a_n in cm^(1 - n) to mm.
    wanted = {4: 1e-8, 6: 1e-12, 20: 1e-35}
    assert dict(lens.surfaces[0].asphere) == pytest.approx(wanted, rel=1e-12)


def test_codev_zoom_is_reported_not_read():
    imported = read(edited(CODEV, "GO", "ZOO 3\nZOO THI S3 1 2 3"), "a.seq")
    assert "ZOO: zoom positions are not read (lines 16, 17)" in imported.ignored


def test_codev_rims_without_cir_let_the_beams_of_its_fields_through():
    lens = read(CODEV.replace("  CIR 10\n", ""), "a.seq").prescription
    assert "as traced" in lens.notes
    # The stop is behind the lens: the beam of 8 degrees needs about its radius and the tangent
    # of the field times the distance to the pupil more than the stop.
    for surface in lens.surfaces[:2]:
        assert 5.0 < surface.semi_diameter < 6.5
    bare = CODEV.replace("  CIR 10\n", "").replace("YAN 0.0 8.0\n", "")
    assert_refused(bare, "a.seq", "I06", "--half-field DEG")
    assert read(bare, "a.seq", half_field_deg=8.0).prescription.surfaces == lens.surfaces


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
def test_bench_refusals(old, new, code, said):
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


def test_glass_option():
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
