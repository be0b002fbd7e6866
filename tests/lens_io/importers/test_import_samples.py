"""Real files of other programs, and the lenses that they are."""

import math

import numpy as np
import pytest

from addon.errors import LensFileError
from addon.lens_io.importers import ImportOptions, glass_option, import_lens
from addon.lens_io.library import Library
from addon.lens_io.toml.toml_reader import parse_lens, read_lens
from addon.lens_io.toml.toml_writer import lens_toml
from addon.optics.glass import REFERENCE_WAVELENGTH_NM, Air
from addon.optics.paraxial import first_order


@pytest.fixture(scope="module")
def samples(shared):
    return shared / "lenses" / "import-samples"


@pytest.fixture(scope="module")
def lens(shared):
    return lambda name: read_lens(shared / "lenses" / f"{name}.toml").prescription


def codes(path, options=None):
    with pytest.raises(LensFileError) as refusal:
        import_lens(path, options)
    return [finding.code for finding in refusal.value.findings]


def assert_same_geometry(imported, wanted, scale=1.0, last=True):
    # Curvatures of a file have 16 digits.
    same = {"rel": 1e-12}
    assert len(imported.surfaces) == len(wanted.surfaces)
    pairs = list(zip(imported.surfaces, wanted.surfaces, strict=True))
    for one, other in pairs:
        assert one.radius == pytest.approx(scale * other.radius, **same)
        assert one.semi_diameter == pytest.approx(scale * other.semi_diameter, **same)
        assert one.is_stop == other.is_stop
        assert one.conic == other.conic
        assert dict(one.asphere) == other.asphere or one.asphere == other.asphere
        assert isinstance(one.glass, Air) == isinstance(other.glass, Air)
    for one, other in pairs if last else pairs[:-1]:
        assert one.thickness == pytest.approx(scale * other.thickness, **same)


def assert_same_index(imported, wanted, tolerance):
    for one, other in zip(imported.surfaces, wanted.surfaces, strict=True):
        index = [float(s.glass.index(REFERENCE_WAVELENGTH_NM)) for s in (one, other)]
        assert index[0] == pytest.approx(index[1], abs=tolerance)


@pytest.mark.parametrize(
    ("name", "scale"), [("dgauss.50mm.dat", 1.0), ("dgauss.dat", 2.0)], ids=["after", "before"]
)
def test_both_dialects_of_pbrt_tables_are_the_double_gauss(samples, lens, name, scale):
    imported = import_lens(samples / name)
    wanted = lens("double-gauss-50mm-f2")
    assert_same_geometry(imported.prescription, wanted, scale, last=False)
    # nd of the lens file is the table's index; only the dispersion was assigned.
    assert_same_index(imported.prescription, wanted, 1e-12)
    values = first_order(wanted.configuration())
    got = imported.prescription
    # The table has no image distance: the paraxial focus. Nominal values have six digits.
    assert got.surfaces[-1].thickness == pytest.approx(scale * values.bfl, rel=1e-9)
    assert got.focal_length == pytest.approx(scale * values.efl, rel=1e-5)
    assert got.f_number == pytest.approx(values.f_number, rel=1e-5)
    # "22deg HFOV" in its comment; the corner is where a quarter of the light is left.
    assert got.half_field_deg == pytest.approx(22.0, abs=1.0)
    assert "22deg HFOV" in got.notes
    assert "paraxial focus" in got.notes
    assert {warning.code for warning in imported.warnings} == {"W02"}


def test_zemax_file_of_a_patent_is_the_aspheric_lens(samples, lens):
    imported = import_lens(samples / "aspheric-30mm-f2.zmx")
    wanted = lens("aspheric-30mm-f2")
    assert_same_geometry(imported.prescription, wanted)
    # The lens file has N-SF11 for SF11: their nd differ by 6e-8.
    assert_same_index(imported.prescription, wanted, 1e-7)
    assert imported.prescription.surfaces[5].glass.name == "SF11"
    wanted_values = vars(first_order(wanted.configuration()))
    got_values = vars(first_order(imported.prescription.configuration()))
    for name, value in wanted_values.items():
        # As far as 6e-8 of one index goes.
        assert got_values[name] == pytest.approx(value, abs=2e-5), name
    # The edge of the picture is at 13.6 mm in the file, 24 degrees in the lens.
    assert imported.prescription.half_field_deg == pytest.approx(24.0, abs=0.3)
    assert not imported.warnings
    assert any(line.startswith("FLAP (lines 75") for line in imported.ignored)


def test_catalogue_file_names_its_unknown_glass_and_reads_when_told(samples):
    path = samples / "catalogue-lens-utf16.zmx"
    assert set(codes(path)) == {"I05"}
    with pytest.raises(LensFileError, match=r"line 49.*'BK7'.*N-BK7.*--glass NAME=ND,VD"):
        import_lens(path)
    bk7 = dict([glass_option("BK7=1.5168,64.17")])
    imported = import_lens(path, ImportOptions(glasses=bk7)).prescription
    # A maker's name for the pair: 22 mm free aperture; the pair is symmetric.
    stop = imported.surfaces[0]
    assert stop.is_stop and stop.semi_diameter == pytest.approx(11.0, rel=1e-12)
    radii = [surface.radius for surface in imported.surfaces]
    assert radii == [-radius for radius in reversed(radii)]
    # The file focuses at its last surface: the focus of its middle wavelength, 587.6 nm; 5e-3 mm
    # allow for best focus and for the given BK7.
    assert imported.surfaces[-1].thickness == pytest.approx(
        first_order(imported.configuration()).bfl, abs=0.5
    )


def test_mirrors_are_refused(samples):
    assert set(codes(samples / "reject-mirror.zmx")) == {"I02"}


def test_double_gauss_with_curvatures_is_the_100_mm_lens_that_its_aperture_says(samples):
    imported = import_lens(samples / "double-gauss-rdm-n.seq")
    got = imported.prescription
    values = first_order(got.configuration())
    # Title: "Double Gauss F/2", EPD 50: EFL 100. The image distance is a paraxial solve (PIM).
    assert values.efl == pytest.approx(100.0, abs=0.05)
    # The file's middle wavelength is 587.6 nm, not the reference.
    assert values.enp_diameter == pytest.approx(50.0, rel=2e-6)
    assert got.surfaces[-1].thickness == pytest.approx(values.bfl, abs=1e-3)
    assert got.half_field_deg == pytest.approx(14.0, abs=1e-6)
    assert [s.glass.name for s in got.surfaces if not isinstance(s.glass, Air)] == [
        *("N-SSK2", "N-SK2", "F5", "F5", "N-SK16", "N-SK16")
    ]
    assert got.surfaces[5].is_stop and math.isinf(got.surfaces[5].radius)
    ignored = " ".join(imported.ignored)
    for keyword in ("CCY", "THC", "WTW", "WTF", "VUY", "VLY", "DER", "PIM", "GO", "INI"):
        assert f"{keyword} (line" in ignored
    assert "Semi-diameters that the file does not tell" in got.notes
    assert "-0.400269 mm behind the image surface" in got.notes
    assert not imported.warnings


def test_sequence_without_rdm_needs_the_option(samples, lens):
    path = samples / "cooke-triplet-no-rdm.seq"
    assert codes(path) == ["I06"]
    with pytest.raises(LensFileError, match=r"--radii radius\|curvature"):
        import_lens(path)
    got = import_lens(path, ImportOptions(radii="radius")).prescription
    wanted = lens("cooke-triplet-50mm")
    # Same radii and glasses; this variant has its stop at surface 1 and other thicknesses.
    radii = [s.radius for s in wanted.surfaces if not s.is_stop]
    assert [s.radius for s in got.surfaces] == pytest.approx(radii, rel=1e-5)
    names = [getattr(s.glass, "name", None) for s in wanted.surfaces if not s.is_stop]
    assert [getattr(s.glass, "name", None) for s in got.surfaces] == names
    assert got.surfaces[0].is_stop
    # EPD 10 at the first surface; EFL 50 is the exercise's.
    assert got.surfaces[0].semi_diameter == pytest.approx(5.0, rel=1e-12)
    assert first_order(got.configuration()).efl == pytest.approx(50.0, abs=0.5)


def test_no_vignetting_within_rims_that_were_computed(samples):
    from addon.optics.rays.vignetting import vignetting

    lens = import_lens(
        samples / "cooke-triplet-no-rdm.seq", ImportOptions(radii="radius")
    ).prescription.configuration()
    for field in (0.0, 7.0, 14.0):
        # The grid of the two areas resolves 1 %.
        assert vignetting(lens, field, grid=201).unvignetted_fraction == pytest.approx(
            1.0, abs=0.01
        )


def test_curvatures_are_no_lens_where_radii_are_meant(samples):
    path = samples / "cooke-triplet-no-rdm.seq"
    assert all(code.startswith("E") for code in codes(path, ImportOptions(radii="curvature")))


@pytest.mark.parametrize("name", ["dgauss.dat", "aspheric-30mm-f2.zmx", "double-gauss-rdm-n.seq"])
def test_an_imported_lens_is_written_and_read_back(samples, name):
    prescription = import_lens(samples / name).prescription
    assert parse_lens(lens_toml(prescription).encode(), name).prescription == prescription


@pytest.mark.parametrize("path", ["double-gauss-50mm-f2", "aspheric-30mm-f2", "zoom-36-69mm-f3.5"])
def test_bench_tables_are_the_shipped_lenses(path, request):
    table = request.path.parent / "samples" / f"{path}.bench.txt"
    got = import_lens(table)
    wanted = Library().open(path).prescription
    assert_same_geometry(got.prescription, wanted)
    # nd and vd as tables print them stand for the catalogue glass of one lens.
    assert_same_index(got.prescription, wanted, 1e-6)
    assert len(got.prescription.zoom) == len(wanted.zoom)
    for one, other in zip(got.prescription.zoom, wanted.zoom, strict=True):
        assert one.thicknesses == other.thicknesses
        assert one.focal_length == other.focal_length
        assert one.f_number == other.f_number
        assert one.stop_semi_diameter == pytest.approx(
            other.stop_semi_diameter or np.nan, rel=1e-12
        )
    assert not got.ignored
    assert not got.warnings
