"""Glasses in lens files: their forms, the catalogue, and indices that cannot be."""

import numpy as np
import pytest

from addon.errors import GlassNotFoundError, LensFileError
from addon.lens_io.glasses.glass_catalog import catalog_glass, catalog_names, near_names
from addon.lens_io.toml.material import index_fault
from addon.lens_io.toml.toml_reader import parse_lens
from addon.optics.glass import (
    C_LINE_NM,
    D_LINE_NM,
    F_LINE_NM,
    AbbeGlass,
    ConstantGlass,
    SellmeierGlass,
    SeriesGlass,
)
from tests.lens_io.lens_texts import SINGLET, changed

N_BK7_B = (1.03961212, 0.231792344, 1.01046945)
N_BK7_C = (0.00600069867, 0.0200179144, 103.560653)


def glass_of(material):
    text = changed(SINGLET, '"N-BK7"', material)
    return parse_lens(text.encode(), "test.toml").prescription.surfaces[1].glass


def faults(material):
    """(code, path below the material) of every error, and all messages."""
    with pytest.raises(LensFileError) as caught:
        glass_of(material)
    found = caught.value.findings
    path = "surface[2].material"
    assert all(one.path.startswith(path) for one in found)
    return (
        [(one.code, one.path.removeprefix(path)) for one in found],
        "\n".join(one.message for one in found),
    )


@pytest.mark.parametrize(
    ("material", "glass"),
    [
        ("{ nd = 1.62041, vd = 60.3 }", AbbeGlass(1.62041, 60.3)),
        ("{ nd = 1.62041, vd = 60.3, dpgf = 0.002 }", AbbeGlass(1.62041, 60.3, 0.002)),
        ("{ nd = 1.529 }", ConstantGlass(1.529)),
        ("{ nd = 4, vd = 5 }", AbbeGlass(4.0, 5.0)),
        (
            f"{{ sellmeier_b = {list(N_BK7_B)}, sellmeier_c_um2 = {list(N_BK7_C)} }}",
            SellmeierGlass(N_BK7_B, N_BK7_C),
        ),
        (
            "{ series_um = [2.27, -0.01, 0.01, 2e-4, -1e-5, 1e-6] }",
            SeriesGlass((2.27, -0.01, 0.01, 2e-4, -1e-5, 1e-6)),
        ),
    ],
)
def test_every_form_of_a_material_is_read(material, glass):
    assert glass_of(material) == glass


def test_catalogue_names_are_exact_after_upper_casing():
    assert glass_of('"n-bk7"') == glass_of('"N-BK7"') == SellmeierGlass(N_BK7_B, N_BK7_C, "N-BK7")
    assert catalog_glass("SF57HTULTRA").name == "SF57HTultra"


def test_old_and_new_types_are_different_glasses():
    assert "N-SF11" in catalog_names()
    assert glass_of('"N-SF6"') != glass_of('"SF6"')
    found, message = faults('"NSF6"')
    assert found == [("E17", "")]
    assert '"N-SF6"' in message


@pytest.mark.parametrize(
    ("name", "near"),
    [("BK7", "N-BK7"), ("N-BK", "N-BK7"), ("AIR", "air"), ("Air", "air"), ("N-BK7 ", "N-BK7")],
)
def test_unknown_glasses_come_with_near_names(name, near):
    found, message = faults(f'"{name}"')
    assert found == [("E17", "")]
    assert f'"{name}"' in message
    assert f'"{near}"' in message


def test_at_most_three_near_names():
    assert len(near_names("N-LAK")) == 3
    assert near_names("?") == ()


def test_catalogue_knows_what_it_has():
    with pytest.raises(GlassNotFoundError, match="N-BK7"):
        catalog_glass("N-BK77")
    # U+017F is S after upper-casing.
    with pytest.raises(GlassNotFoundError):
        catalog_glass("ſF6")
    assert len(catalog_names()) == 123


def test_catalogue_has_the_published_index_and_abbe_number():
    # Schott: N-BK7 517642.251, N-SF11 785257.322, N-LAK33B 755523.422.
    for name, nd, vd in [("N-BK7", 1.5168, 64.17), ("N-SF11", 1.78472, 25.68)]:
        d, f, c = catalog_glass(name).index(np.array([D_LINE_NM, F_LINE_NM, C_LINE_NM]))
        # Both are published to these digits.
        assert d == pytest.approx(nd, abs=6e-6)
        assert (d - 1.0) / (f - c) == pytest.approx(vd, abs=6e-3)


@pytest.mark.parametrize(
    ("material", "expected", "words"),
    [
        ("{}", [("E18", "")], "empty"),
        ("{ nd = 1.5, series_um = [2, 0, 0, 0, 0, 0] }", [("E18", "")], "nd, series_um"),
        ("{ vd = 50, sellmeier_b = [1] }", [("E18", "")], "vd, sellmeier_b"),
        ("{ sellmeier_b = [1], sellmeier_c_um2 = [0, 0] }", [("E18", "")], "1 terms"),
        ("{ sellmeier_b = [], sellmeier_c_um2 = [] }", [("E18", "")], "1 to 6"),
        (f"{{ sellmeier_b = {[1] * 7}, sellmeier_c_um2 = {[0] * 7} }}", [("E18", "")], "1 to 6"),
        ("{ series_um = [2.3] }", [("E18", "")], "needs 6"),
        (f"{{ series_um = {[1] * 5000} }}", [("E18", "")], "5000"),
        ("{ vd = 50 }", [("E06", ".nd")], "nd"),
        ("{ nd = 1.5, dpgf = 0.01 }", [("E06", ".vd")], "vd"),
        ("{ sellmeier_b = [1.0] }", [("E06", ".sellmeier_c_um2")], "sellmeier_c_um2"),
        ("{ nd = 1.5, ve = 60 }", [("E05", ".ve")], "ve"),
        ("{ nd = true }", [("E07", ".nd")], "boolean"),
        ("{ series_um = 2.3 }", [("E07", ".series_um")], "array of numbers"),
        ('{ series_um = [2.3, "0", 0, 0, 0, 0] }', [("E07", ".series_um[2]")], "text"),
        ("{ series_um = [2.3, 0, nan, 0, 0, 0] }", [("E08", ".series_um[3]")], "nan"),
        ("1.5", [("E07", "")], "text or a table"),
        ("{ nd = 1.0, vd = 60 }", [("E19", ".nd")], "1.0"),
        ("{ nd = 4.01, vd = 60 }", [("E19", ".nd")], "0.587562 um"),
        ("{ nd = 1.5, vd = 4.9 }", [("E19", ".vd")], "4.9"),
        ("{ nd = 1.5, vd = 121 }", [("E19", ".vd")], "at least 5 and at most 120"),
        ("{ nd = 0.5, vd = 121 }", [("E19", ".nd"), ("E19", ".vd")], "121"),
    ],
)
def test_each_fault_of_a_material_has_its_code_and_says_why(material, expected, words):
    found, message = faults(material)
    assert found == expected
    assert words in message


@pytest.mark.parametrize(
    ("glass", "low", "high"),
    [
        # A resonance in the visible, strong or faint.
        (SellmeierGlass((1.0, 0.1), (0.01, 0.3)), 547.7, 547.8),
        (SellmeierGlass((1.0, 1e-15), (0.01, 0.3)), 547.7, 547.8),
        (SellmeierGlass((1.0, 0.1), (0.01, 0.16)), 400.0, 400.0),
        # Just beyond the violet end, and of the wrong sign: n^2 = 2.07 - 0.01 * 0.16 / 0.001 there.
        (SellmeierGlass((1.0, -0.01), (0.01, 0.159)), 400.0, 401.0),
        (SeriesGlass((0.9, 0.0, 0.0, 0.0, 0.0, 0.0)), 400.0, 400.0),
        (SeriesGlass((3.0, -4.5, 0.0, 0.0, 0.0, 0.0)), 660.0, 700.0),
        # A partial dispersion that no glass has bends the curve below 1 between the lines.
        (AbbeGlass(1.5, 60.0, 1e300), 400.0, 700.0),
        (AbbeGlass(1.001, 5.0, -20.0), 400.0, 700.0),
    ],
)
def test_glasses_without_an_index_somewhere_in_the_visible_are_found(glass, low, high):
    wavelength, index = index_fault(glass)
    assert low <= wavelength <= high
    assert index is None or index <= 1.0


def test_a_dip_between_two_samples_is_found():
    # n^2 - 1 = (L - p)^2 - e with p between two samples of a 1 nm grid, to second order in L^2.
    center = 0.5005**2
    width = (1e-4) ** 2
    # (L^2 - center)^2 / L^2 + 1 - width: a series in L^2, 1 and L^-2.
    glass = SeriesGlass((1.0 - width - 2.0 * center, 1.0, center**2, 0.0, 0.0, 0.0))
    wavelength, _ = index_fault(glass)
    assert wavelength == pytest.approx(500.5, abs=0.3)


def test_an_index_fault_is_told_with_wavelength_and_value():
    found, message = faults("{ series_um = [0.9, 0, 0, 0, 0, 0] }")
    assert found == [("E19", "")]
    assert "0.948683 at 0.4 um" in message


def test_every_glass_of_the_catalogue_can_be_used():
    for name in catalog_names():
        assert index_fault(catalog_glass(name)) == (None, None)
