"""What CODE V sequences may say, and how they are refused."""

import pytest

from tests.lens_io.importers.foreign_texts import CODEV, ND, VD
from tests.lens_io.importers.importing import assert_refused, edited, read


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
