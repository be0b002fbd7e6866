"""Checks that trace the lens: E16, E24, E25 and the warnings."""

from dataclasses import replace

import numpy as np
import pytest

from addon.errors import LensFileError
from addon.lens_io.toml.optical_checks import light_passes
from addon.lens_io.toml.toml_reader import parse_lens
from tests.lens_io.lens_texts import SINGLET, ZOOM, changed

# f = 100 mm by N-BK7's index at the d line, a plane-convex lens: R = 100 (n - 1).
POWERLESS = changed(SINGLET, "radius_mm = 51.5", "radius_mm = inf").replace(
    "conic = -0.5\nasphere = { a4_per_mm3 = 1e-9, a6_per_mm5 = 2e-12 }\n", ""
)


def errors(text):
    with pytest.raises(LensFileError) as caught:
        parse_lens(text.encode(), "test.toml")
    found = caught.value.findings
    return [(one.code, one.path) for one in found], "\n".join(one.message for one in found)


def warnings(text):
    found = parse_lens(text.encode(), "test.toml").warnings
    return [(one.code, one.path) for one in found], "\n".join(one.message for one in found)


def test_a_consistent_lens_has_no_warning():
    assert warnings(SINGLET) == ([], "")
    assert warnings(ZOOM) == ([], "")


def test_e16_names_the_radius_where_the_sag_overflows():
    text = changed(SINGLET, "a6_per_mm5 = 2e-12", "a20_per_mm19 = 1e295")
    found, message = errors(text)
    assert found == [("E16", "surface[2].asphere")]
    # 1e295 r^20 reaches the largest float, 1.797e308, at r = (1.797e13)^(1/20) = 4.5995 mm.
    assert "at 4.599" in message
    assert "12.7 mm" in message


def test_e24_tells_that_there_is_no_power():
    found, message = errors(POWERLESS)
    assert found == [("E24", "surface")]
    assert "no power" in message


def test_e24_tells_a_negative_focal_length():
    found, message = errors(changed(SINGLET, "51.5", "-51.5"))
    assert found == [("E24", "surface")]
    assert "-99.65" in message


def test_e24_tells_figures_that_are_too_large():
    text = changed(SINGLET, "conic = -0.5", "conic = -1.0")
    text = changed(text, "a4_per_mm3 = 1e-9", "a2_per_mm1 = 1e308, a4_per_mm3 = 0.0")
    text = changed(text, "12.7", "0.1")
    found, message = errors(text)
    assert ("E24", "surface") in found
    assert "finite" in message or "large" in message


TELECENTRIC = """\
format = "lens-description"
format_version = 1

[lens]
name = "Telecentric in object space"
focal_length_mm = 100.0
f_number = 10.0
half_field_deg = 5.0

[[surface]]
radius_mm = 100.0
thickness_mm = 0.0
semi_diameter_mm = 10.0
material = { nd = 2.0, vd = 60.0 }

[[surface]]
radius_mm = inf
thickness_mm = 100.0
semi_diameter_mm = 10.0
material = "air"

[[surface]]
radius_mm = inf
thickness_mm = 0.0
semi_diameter_mm = 5.0
material = "air"
stop = true
"""


def test_e25_tells_a_stop_without_finite_image_in_object_space():
    # A thin lens of f = R / (n - 1) = 100 mm, the stop in its rear focal plane.
    found, message = errors(TELECENTRIC)
    assert found == [("E25", "surface[3]")]
    assert "surface 3" in message
    assert parse_lens(changed(TELECENTRIC, "100.0\nsemi", "90.0\nsemi").encode(), "x").prescription


def test_e25_tells_where_the_axial_ray_is_lost():
    # At the edge of a sphere of 12.5 mm light is bent by 44 deg, and meets the plane behind it
    # beyond the critical angle of 41 deg.
    text = changed(SINGLET, "radius_mm = 51.5", "radius_mm = 12.5").replace("12.7", "12.5")
    text = changed(text, "thickness_mm = 3.6", "thickness_mm = 12.5").replace("-0.5", "0.0")
    text = changed(text, "asphere = { a4_per_mm3 = 1e-9, a6_per_mm5 = 2e-12 }\n", "")
    found, message = errors(text)
    assert found == [("E25", "surface[3]")]
    assert "12.4565 mm" in message
    assert "surface 3" in message


def test_e25_tells_a_stop_that_is_closed():
    found, message = errors(changed(SINGLET, "12.4565", "1e-300"))
    assert found == [("E25", "surface[1]")]
    assert "1e-300" in message


def test_zoom_positions_are_checked_each_with_its_values():
    # 200 mm apart, the two lenses are an afocal-like pair of negative focal length.
    found, message = errors(changed(ZOOM, "D2 = 30.0", "D2 = 300.0"))
    assert found == [("E24", "zoom[2]")]
    assert "zoom" not in message
    found, _ = warnings(changed(ZOOM, "focal_length_mm = 59.8", "focal_length_mm = 62.0"))
    assert found == [("W01", "zoom[2].focal_length_mm")]
    found, _ = warnings(changed(ZOOM, "f_number = 4.15", "f_number = 4.5"))
    assert found == [("W03", "zoom[2].f_number")]
    found, _ = warnings(changed(ZOOM, "stop_semi_diameter_mm = 5.0", "stop_semi_diameter_mm = 4.8"))
    assert found == [("W03", "zoom[2].f_number")]
    found, _ = warnings(changed(ZOOM, "BF = 39.9", "BF = 45.0"))
    assert found == [("W05", "zoom[2].thickness_mm.BF")]
    found, _ = warnings(changed(ZOOM, "half_field_deg = 4.0", "half_field_deg = 60.0"))
    assert found == [("W06", "zoom[2].half_field_deg")]


def test_values_that_a_zoom_position_replaces_are_not_checked():
    text = changed(ZOOM, "focal_length_mm = 54.0", "focal_length_mm = 10.0")
    text = changed(text, "thickness_mm = 10.0", "thickness_mm = 300.0")
    assert warnings(changed(text, "f_number = 5.4", "f_number = 1.0")) == ([], "")


@pytest.mark.parametrize(("nominal", "expected"), [(97.75, 0), (97.65, 1), (101.60, 0), (101.8, 1)])
def test_w01_beyond_two_per_cent_of_the_nominal_focal_length(nominal, expected):
    # The singlet has 99.6517 mm.
    found, message = warnings(changed(SINGLET, "99.65", str(nominal)))
    assert found == [("W01", "lens.focal_length_mm")] * expected
    assert ("99.6517" in message and str(nominal) in message) or not expected


def test_w02_names_the_surface_of_a_glass_without_dispersion():
    found, message = warnings(changed(SINGLET, '"N-BK7"', "{ nd = 1.5168 }"))
    assert found == [("W02", "surface[2].material")]
    assert "surface 2" in message


@pytest.mark.parametrize(("nominal", "expected"), [(3.9, 0), (3.87, 1), (4.12, 0), (4.13, 1)])
def test_w03_beyond_three_per_cent_of_the_nominal_f_number(nominal, expected):
    found, message = warnings(changed(SINGLET, "f_number = 4.0", f"f_number = {nominal}"))
    assert found == [("W03", "lens.f_number")] * expected
    assert ("3.99999" in message and str(nominal) in message) or not expected


def test_w04_tells_by_how_much_rims_overlap():
    # Two spheres back to back; at 10 mm the sag of 50 mm is 50 - sqrt(2400) = 1.0102 mm.
    text = changed(SINGLET, "51.5", "50.0").replace("conic = -0.5\n", "")
    text = changed(text, "asphere = { a4_per_mm3 = 1e-9, a6_per_mm5 = 2e-12 }\n", "")
    text = changed(
        text,
        "thickness_mm = 3.6\nsemi_diameter_mm = 12.7",
        """\
thickness_mm = 0.5
semi_diameter_mm = 10.0""",
    )
    found, message = warnings(text)
    assert ("W04", "surface[2].thickness_mm") in found
    assert "surfaces 2 and 3" in message
    assert "0.5102 mm" in message


def test_rims_that_touch_do_not_overlap():
    text = changed(SINGLET, "thickness_mm = 2.0", "thickness_mm = 0.0")
    assert warnings(text) == ([], "")


def test_w05_unless_the_last_distance_is_not_given():
    found, message = warnings(changed(SINGLET, "97.3", "92.0"))
    assert found == [("W05", "surface[3].thickness_mm")]
    assert "97.2783" in message
    assert warnings(changed(SINGLET, "97.3", "0.0")) == ([], "")
    assert warnings(changed(SINGLET, "97.3", "93.0")) == ([], "")


def test_w06_names_the_field_at_which_no_light_passes():
    # A tube: the stop, 12.5 mm, and a rim of 12.7 mm 200 mm behind it: closed beyond 7.2 deg.
    text = changed(SINGLET, "thickness_mm = 2.0", "thickness_mm = 200.0")
    assert warnings(changed(text, "half_field_deg = 6.0", "half_field_deg = 10.0"))[0] == []
    found, message = warnings(changed(text, "half_field_deg = 6.0", "half_field_deg = 10.5"))
    assert found == [("W06", "lens.half_field_deg")]
    assert "7.35 deg" in message
    assert "10.5 deg" in message


def test_a_beam_thinner_than_the_rays_of_the_search_is_found():
    # The edge of two discs far apart: at 7.17 deg a sliver of 0.002 mm is left.
    text = changed(SINGLET, "thickness_mm = 2.0", "thickness_mm = 200.0")
    lens = parse_lens(text.encode(), "test.toml").prescription.configuration()
    stop, *rest = lens.surfaces
    edge = np.degrees(np.arctan2(12.4565 + 12.7, 200.0 + 1.6))
    assert light_passes(lens, edge - 0.01)
    assert not light_passes(lens, edge + 0.01)
    pinhole = replace(lens, surfaces=(stop, *rest[:1], replace(rest[1], semi_diameter=1e-3)))
    assert light_passes(pinhole, 1.0)


def test_cylinders_are_checked_in_both_meridians():
    text = changed(SINGLET, "radius_mm = 51.5", 'radius_mm = 51.5\ncurved_along = "y"')
    text = changed(
        text,
        "radius_mm = inf\nthickness_mm = 97.3",
        """\
radius_mm = -51.5
curved_along = "x"
thickness_mm = 97.3""",
    )
    # Crossed cylinders: power in both meridians, in y the focal length of the singlet.
    assert [one for one in warnings(text)[0] if one[0] != "W05"] == []
