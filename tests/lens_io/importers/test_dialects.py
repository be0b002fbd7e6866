"""What other programs and people write into lens files, beyond the plain form of a format."""

import math

import pytest

from addon.errors import InputError, LensFileError
from addon.lens_io.glasses.glass_catalog import catalog_glass
from addon.lens_io.importers import ImportOptions, glass_option, import_bytes
from addon.lens_io.toml.toml_reader import parse_lens
from addon.lens_io.toml.toml_writer import lens_toml
from addon.optics.paraxial import first_order
from addon.optics.prescription import may_overlap
from addon.optics.rays.trace import Rays, trace
from tests.lens_io.importers.foreign_texts import BENCH, CODEV, ND, PBRT, RADIUS, VD, ZEMAX

# The singlet of the texts: its paraxial values by the equations of a thick lens.
POWER = (ND - 1) * (2 / RADIUS - (ND - 1) * 4.0 / (ND * RADIUS**2))
EFL = 1 / POWER


def read(text, name, **options):
    return import_bytes(text.encode(), name, ImportOptions(**options))


def edited(text, *pairs):
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def f_number(text, name):
    return first_order(read(text, name).prescription.configuration()).f_number


def refusal(text, name, **options):
    with pytest.raises(LensFileError) as caught:
        read(text, name, **options)
    return " ".join(f"{one.code} {one.path} {one.message}" for one in caught.value.findings)


def test_zemax_object_cone_angle_is_half_the_cone():
    near = edited(ZEMAX, ("ENPD 10", "OBNA 2 1"), ("  DISZ INFINITY", "  DISZ 200"))
    values = first_order(read(near, "a.zmx").prescription.configuration())
    expected = 2 * math.tan(math.radians(2)) * (200 + values.enp_z)
    assert values.enp_diameter == pytest.approx(expected, rel=1e-9)


def test_zemax_object_aperture_of_flag_0_is_a_sine():
    near = edited(ZEMAX, ("ENPD 10", "OBNA 0.03 0"), ("  DISZ INFINITY", "  DISZ 200"))
    values = first_order(read(near, "a.zmx").prescription.configuration())
    expected = 2 * math.tan(math.asin(0.03)) * (200 + values.enp_z)
    assert values.enp_diameter == pytest.approx(expected, rel=1e-9)


def test_an_object_cone_of_a_right_angle_is_refused():
    near = edited(ZEMAX, ("ENPD 10", "OBNA 90 1"), ("  DISZ INFINITY", "  DISZ 200"))
    assert "I07" in refusal(near, "a.zmx")


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (edited(ZEMAX, ("ENPD 10", "FNUM 8 1"), ("  DISZ INFINITY", "  DISZ 200")), "a.zmx"),
        (edited(CODEV, ("EPD 10", "FNO 8"), ("SO 0.0 1e10", "SO 0.0 200")), "a.seq"),
        (edited(CODEV, ("EPD 10", "NA 0.0625"), ("SO 0.0 1e10", "SO 0.0 200")), "a.seq"),
    ],
    ids=["Zemax", "CODE V", "CODE V, aperture"],
)
def test_working_f_number_is_that_of_the_near_object(text, name):
    values = first_order(read(text, name).prescription.configuration())
    # The marginal ray from the object through the pupil's edge, followed to the image.
    object_slope = values.enp_diameter / 2 / (200 + values.enp_z)
    magnification = EFL / (200 + values.ffl)
    # The aperture is meant for the wavelengths of the files, 587.6 nm; compared at 587.5618 nm.
    assert magnification / (2 * object_slope) == pytest.approx(8.0, rel=1e-5)


@pytest.mark.parametrize("row", ["FNUM 8 0", "FNUM 8 1"])
def test_for_an_object_at_infinity_both_f_numbers_are_one(row):
    assert f_number(edited(ZEMAX, ("ENPD 10", row)), "a.zmx") == pytest.approx(8.0, rel=1e-9)


@pytest.mark.parametrize(("unit", "scale"), [("METER", 1000.0), ("M", 1000.0), ("CM", 10.0)])
def test_zemax_units_by_every_name(unit, scale):
    lens = read(edited(ZEMAX, ("UNIT MM", f"UNIT {unit}")), "a.zmx").prescription
    assert first_order(lens.configuration()).efl == pytest.approx(EFL * scale, rel=1e-9)


@pytest.mark.parametrize("word", ["inf", "INF", "Infinity", "1e10"])
def test_codev_object_at_infinity_by_every_word(word):
    lens = read(edited(CODEV, ("SO 0.0 1e10", f"SO 0 {word}")), "a.seq").prescription
    assert lens == read(CODEV, "a.seq").prescription


def test_codev_plane_by_an_endless_radius_only_where_radii_are_told():
    plane = edited(CODEV, ("S 0.0 45", "S inf 45"))
    assert math.isinf(read(plane, "a.seq").prescription.surfaces[2].radius)
    assert "I07" in refusal(edited(plane, ("RDM;", "RDM N;")), "a.seq")


@pytest.mark.parametrize(
    "row", ["CIR CLR 9", "CIR L'rim' 9", "CIR L'my rim' CLR 9", "CIR S1 CLR 9"]
)
def test_codev_circles_with_qualifiers_and_labels(row):
    lens = read(edited(CODEV, ("  CIR 10", f"  {row}")), "a.seq").prescription
    assert [surface.semi_diameter for surface in lens.surfaces[:2]] == [9.0, 10.0]


@pytest.mark.parametrize("row", ["CIR EDG 9", "CIR L'edge' EDG 9"])
def test_codev_edges_are_no_clear_apertures(row):
    read_lens = read(edited(CODEV, ("  CIR 10", f"  CIR 10\n  {row}")), "a.seq")
    assert read_lens.prescription.surfaces[0].semi_diameter == 10.0
    assert any("CIR EDG" in line for line in read_lens.ignored)


@pytest.mark.parametrize("row", ["CUY UMY -0.1", "THI HMY 0", "RDY PIK S1", "THI PIK S1"])
def test_codev_solves_leave_the_value_of_the_s_line_and_are_named(row):
    solved = read(edited(CODEV, ("  STO", f"  {row}\n  STO")), "a.seq")
    assert solved.prescription.surfaces == read(CODEV, "a.seq").prescription.surfaces
    assert any(" ".join(row.split()[:2]) in line for line in solved.ignored)


@pytest.mark.parametrize("row", ["THI S1 5", "CUY S2 0.01", "RDY 20"])
def test_codev_edits_that_are_no_solves_are_still_refused(row):
    assert "I04" in refusal(edited(CODEV, ("  STO", f"  STO\n  {row}")), "a.seq")


def test_codev_conic_and_asphere_need_no_word_for_the_shape():
    told = edited(CODEV, ("  CIR 10", "  CIR 10\n  ASP\n  K -0.8\n  A 1e-6"))
    plain = edited(CODEV, ("  CIR 10", "  CIR 10\n  K -0.8\n  A 1e-6"))
    lens = read(plain, "a.seq").prescription
    assert lens == read(told, "a.seq").prescription
    assert lens.surfaces[0].conic == -0.8 and lens.surfaces[0].asphere == ((4, 1e-6),)


@pytest.mark.parametrize(
    ("shape", "row"), [("SPH", "K -0.8"), ("SPH", "A 1e-6"), ("CON", "A 1e-6")]
)
def test_codev_shapes_that_contradict_their_constants_are_refused(shape, row):
    text = edited(CODEV, ("  CIR 10", f"  CIR 10\n  {shape}\n  {row}"))
    assert shape in refusal(text, "a.seq")


def test_codev_title_of_another_zoom_position_is_no_name():
    text = edited(CODEV, ("TITLE 'Singlet'", "TIT 'Singlet'\nTIT Z2 'at 70 mm'"))
    assert read(text, "a.seq").prescription.name == "Singlet"
    text = edited(CODEV, ("TITLE 'Singlet'", "TIT Z1 'at 35 mm'\nTIT Z2 'at 70 mm'"))
    assert read(text, "a.seq").prescription.name == "at 35 mm"


def test_pbrt_table_with_the_focal_length_in_a_row():
    lens = read(edited(PBRT, ("# Singlet\n", "# Singlet\n49.14\n")), "a.dat").prescription
    plain = read(PBRT, "a.dat").prescription
    assert lens.surfaces == plain.surfaces
    assert lens.focal_length == 49.14


def test_pbrt_lone_numbers_further_down_are_still_refused():
    text = PBRT.rstrip("\n") + "\n49.14\n"
    assert "49.14" in refusal(text, "a.dat")


@pytest.mark.parametrize("spaces", [2, 3, 4])
def test_bench_table_whose_tabs_became_spaces(spaces):
    text = BENCH.replace("\t", " " * spaces)
    assert read(text, "a.txt").prescription == read(BENCH, "a.txt").prescription


def test_bench_table_of_aligned_columns_is_refused_with_the_reason():
    text = BENCH.replace("\t", "  ").replace("[lens data]\n1  ", "[lens data]\n1     ")
    text = text.replace("2  -50.0", "2   -50.0")
    assert "no tabs" in refusal(text, "a.txt")


def bench_with_stop(
    overlap, place="AS\t{overlap}\t\t4\n1\t20\t4\t1.5168\t10\t64.2\n2\t-50\t15\t\t10"
):
    return BENCH[: BENCH.index("1\t50")] + place.format(overlap=overlap).replace(
        "AS\t", "0\tAS\t", 1
    )


def test_bench_stop_behind_the_vertex_that_follows_it():
    read_lens = read(bench_with_stop(-0.4), "a.txt").prescription
    stop, front, _ = read_lens.surfaces
    assert stop.thickness == -0.4 and may_overlap(read_lens.surfaces, 1)
    # A ray along (0, sin a, cos a) through the middle of the opening is the chief ray: it meets
    # the front surface where it was before it got to the opening.
    configuration = read_lens.configuration()
    traced = trace(
        configuration, Rays([[0.0, 0.0, 0.0]], [[0.0, 0.1, math.sqrt(0.99)]]), 587.5618, record=True
    )
    assert traced.passed.all()
    y, z = traced.hits[1, 0, 1:]
    assert z < 0.0 and y == pytest.approx(0.1 / math.sqrt(0.99) * z, rel=1e-9)
    # On the sphere of the front surface, whose vertex lies 0.4 in front of the opening.
    assert math.hypot(y, z + 0.4 - front.radius) == pytest.approx(front.radius, rel=1e-12)
    # The written file is the same lens.
    assert parse_lens(lens_toml(read_lens).encode(), "a.toml").prescription == read_lens


def test_a_stop_deeper_than_the_bulge_is_refused():
    # The front surface has a sag of 0.635 mm at its rim of 5 mm.
    assert "E09" in refusal(bench_with_stop(-0.8), "a.txt")


@pytest.mark.parametrize(
    ("name", "successor"),
    [
        ("BK7", "N-BK7"),
        ("BAK4", "N-BAK4"),
        ("S-BSM16", "N-SK16"),
        ("H-K9L", "N-BK7"),
        ("SK16", "N-SK16"),
    ],
)
def test_glasses_of_other_lists_are_offered_their_successor_of_the_same_index(name, successor):
    text = edited(CODEV, (f"{ND}:{VD}", f"{name}_SCHOTT"))
    said = refusal(text, "a.seq")
    assert "I05" in said and f"={successor}" in said
    option = dict([glass_option(f"{name}={successor}")])
    lens = read(text, "a.seq", glasses=option).prescription
    assert lens.surfaces[0].glass == catalog_glass(successor)


@pytest.mark.parametrize("name", ["LAF2", "KZFSN4", "NOSUCH"])
def test_glasses_whose_index_no_glass_has_are_offered_nothing(name):
    said = refusal(edited(CODEV, (f"{ND}:{VD}", f"{name}_SCHOTT")), "a.seq")
    assert "to take that one" not in said and "--glass NAME=ND,VD" in said


def test_a_glass_option_may_name_a_glass_of_the_catalogue():
    assert glass_option("MINE=n-sf11") == ("MINE", catalog_glass("N-SF11"))
    with pytest.raises(InputError, match="MINE=N-NOSUCH"):
        glass_option("MINE=N-NOSUCH")
