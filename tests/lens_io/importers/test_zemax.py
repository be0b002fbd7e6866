"""What Zemax files may say, and how they are refused."""

import pytest

from addon.lens_io.importers import import_bytes
from addon.optics.glass import AbbeGlass
from addon.optics.paraxial import first_order
from tests.lens_io.importers.foreign_texts import LAST, ND, VD, ZEMAX
from tests.lens_io.importers.importing import assert_refused, edited, read


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
