"""The writer is the inverse of the reader."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from addon.lens_io.library import SHIPPED_FOLDER
from addon.lens_io.toml.toml_reader import parse_lens, read_lens
from addon.lens_io.toml.toml_writer import lens_toml
from addon.optics.glass import AbbeGlass, ConstantGlass, SellmeierGlass, SeriesGlass
from addon.optics.prescription import Diaphragm, FocusGroup
from tests.lens_io.lens_texts import SINGLET, ZOOM


def read(text):
    return parse_lens(text.encode(), "test.toml").prescription


@pytest.mark.parametrize("text", [SINGLET, ZOOM])
def test_what_is_written_reads_back_equal(text):
    lens = read(text)
    assert read(lens_toml(lens)) == lens


def test_sample_and_shipped_lenses_read_back_equal(shared):
    paths = [*(shared / "lenses").glob("*.toml"), *SHIPPED_FOLDER.glob("*.toml")]
    assert len(paths) >= 12
    for path in paths:
        lens = read_lens(path).prescription
        assert read(lens_toml(lens)) == lens, path.name


def test_a_sample_lens_is_written_as_it_stands_in_its_file(shared):
    for name in ("zoom-36-69mm-f3.5", "aspheric-30mm-f2", "singlet-planoconvex-100mm"):
        path = shared / "lenses" / f"{name}.toml"
        assert lens_toml(read_lens(path).prescription) == path.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "glass",
    [
        ConstantGlass(1.5),
        AbbeGlass(1.6, 60.0),
        AbbeGlass(1.6, 60.0, 0.01),
        SellmeierGlass((1.1, 0.1), (0.01, 100.0)),
        SeriesGlass((2.3, -0.01, 0.01, 1e-4, -1e-5, 1e-6)),
    ],
)
def test_every_form_of_glass_is_kept(glass):
    lens = read(SINGLET)
    lens = replace(
        lens, surfaces=(lens.surfaces[0], replace(lens.surfaces[1], glass=glass), lens.surfaces[2])
    )
    assert read(lens_toml(lens)) == lens


def test_a_catalogue_name_stands_only_for_the_catalogues_figures():
    lens = read(SINGLET)
    glass = lens.surfaces[1].glass
    assert 'material = "N-BK7"' in lens_toml(lens)
    other = replace(glass, b=(1.1, *glass.b[1:]))
    surfaces = (lens.surfaces[0], replace(lens.surfaces[1], glass=other), lens.surfaces[2])
    text = lens_toml(replace(lens, surfaces=surfaces))
    assert "N-BK7" not in text
    assert read(text).surfaces[1].glass == replace(other, name=None)


def test_everything_a_prescription_can_hold_is_kept():
    lens = read(ZOOM)
    surfaces = list(lens.surfaces)
    surfaces[0] = replace(surfaces[0], conic=-1.5, asphere=((2, 1e-7), (20, -1e-25)), id="F1")
    lens = replace(
        lens,
        surfaces=tuple(surfaces),
        designer="Ernst Käfer",
        source='"quoted" \\ back\nline\ttab\x00\x7f\u2028',
        year=1901,
        notes="π",
        projection="fisheye",
        image_circle_diameter=43.3,
        diaphragm=Diaphragm(9, 0.25, -12.0),
        focus=FocusGroup(1, 2),
    )
    assert read(lens_toml(lens)) == lens


def test_focus_surfaces_without_an_id_get_one():
    lens = replace(read(SINGLET), focus=FocusGroup(2, 3))
    again = read(lens_toml(lens))
    assert again.focus == lens.focus
    assert [surface.id for surface in again.surfaces] == ["S1", "S2", "BF"]


def test_numbers_of_other_types_are_written_as_floats():
    lens = read(SINGLET)
    surface = replace(lens.surfaces[2], thickness=np.float64(97.3), semi_diameter=13)
    text = lens_toml(replace(lens, surfaces=(*lens.surfaces[:2], surface)))
    assert "thickness_mm = 97.3\nsemi_diameter_mm = 13.0" in text


# nd and vd of real glasses: the index stays above 1 in the visible.
numbers = st.floats(allow_nan=False, allow_infinity=False)


@given(
    name=st.text(min_size=1, max_size=200),
    notes=st.text(),
    conic=st.floats(-1e3, 0.0),
    thickness=st.floats(0.0, 1e6),
    rotation=numbers,
    nd=st.floats(1.3, 2.2),
    vd=st.floats(20.0, 95.0),
)
def test_any_text_and_number_reads_back_equal(name, notes, conic, thickness, rotation, nd, vd):
    lens = read(SINGLET)
    stop, front, back = lens.surfaces
    lens = replace(
        lens,
        name=name,
        notes=notes,
        diaphragm=Diaphragm(5, 0.1, rotation),
        surfaces=(
            replace(stop, thickness=thickness),
            replace(front, conic=conic, glass=AbbeGlass(nd, vd)),
            back,
        ),
    )
    assert read(lens_toml(lens)) == lens
