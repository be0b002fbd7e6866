"""Facts of known designs, as books tell them."""

import math
from dataclasses import replace

import pytest

from addon.errors import PrescriptionError
from addon.lens_io.toml.toml_reader import read_lens
from addon.optics.lens_facts import lens_facts


@pytest.fixture
def lens(shared):
    return lambda name: read_lens(shared / "lenses" / f"{name}.toml").prescription


@pytest.mark.parametrize(
    ("name", "elements", "groups"),
    [
        # Kingslake, A History of the Photographic Lens: the types' textbook constructions.
        ("cooke-triplet-50mm", 3, 3),
        ("tessar-50mm-f2.8", 4, 3),
        ("double-gauss-50mm-f2", 6, 4),
        ("planar-50mm-f1.4", 7, 6),
        ("sonnar-50mm-f1.5", 7, 3),
        ("singlet-planoconvex-100mm", 1, 1),
    ],
)
def test_elements_and_groups_of_classic_types(lens, name, elements, groups):
    facts = lens_facts(lens(name))
    assert (facts.elements, facts.groups) == (elements, groups)


def test_zoom_positions_have_facts_of_their_own(lens):
    zoom = lens("zoom-36-69mm-f3.5")
    lengths = [lens_facts(zoom, label).focal_length for label in zoom.labels]
    assert lengths == pytest.approx([p.focal_length for p in zoom.zoom], rel=0.02)
    assert lens_facts(zoom).focal_length == lengths[0]
    with pytest.raises(PrescriptionError, match="no zoom position '80 mm'"):
        lens_facts(zoom, "80 mm")


def test_the_image_circle_is_that_of_the_file_or_of_the_field(lens):
    lens = replace(lens("tessar-50mm-f2.8"), image_circle_diameter=43.3)
    assert lens_facts(lens).image_circle_diameter == 43.3
    without = lens_facts(replace(lens, image_circle_diameter=None))
    field = math.radians(lens.half_field_deg)
    assert without.half_field == field
    assert without.image_circle_diameter == pytest.approx(
        2 * without.focal_length * math.tan(field)
    )
    fisheye = lens_facts(replace(lens, image_circle_diameter=None, projection="fisheye"))
    assert fisheye.image_circle_diameter == pytest.approx(2 * without.focal_length * field)


def test_a_lens_without_cylinders_has_one_focal_length(lens):
    assert lens_facts(lens("tessar-50mm-f2.8")).horizontal_focal_length is None
