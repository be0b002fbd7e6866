"""The reader of lens files: what it reads, and every code that needs no tracing."""

import math

import pytest

from addon.errors import LensFileError
from addon.lens_io.toml.toml_reader import parse_lens, read_lens
from addon.optics.glass import AIR, AbbeGlass
from addon.optics.prescription import Diaphragm, FocusGroup, ZoomPosition
from tests.lens_io.lens_texts import SINGLET, ZOOM, changed


def read(text):
    return parse_lens(text.encode(), "test.toml")


def findings(text):
    """What is wrong with a file: (code, path) of each error, and the messages by code."""
    with pytest.raises(LensFileError) as caught:
        read(text)
    found = caught.value.findings
    return [(one.code, one.path) for one in found], {one.code: one.message for one in found}


def test_every_value_of_a_file_is_read():
    lens = read(SINGLET).prescription
    assert (lens.name, lens.focal_length, lens.f_number, lens.half_field_deg) == (
        "Singlet",
        99.65,
        4.0,
        6.0,
    )
    assert (lens.designer, lens.source, lens.year, lens.notes) == (None, None, None, None)
    assert (lens.projection, lens.image_circle_diameter) == ("rectilinear", None)
    assert lens.diaphragm == Diaphragm(6, 0.5, 0.0)
    stop, front, back = lens.surfaces
    assert (stop.radius, stop.thickness, stop.semi_diameter) == (math.inf, 2.0, 12.4565)
    assert (stop.glass, stop.is_stop, stop.id) == (AIR, True, "S1")
    assert (front.radius, front.conic) == (51.5, -0.5)
    assert front.asphere == ((4, 1e-9), (6, 2e-12))
    assert (front.glass.name, front.is_stop, front.id) == ("N-BK7", False, None)
    assert (back.radius, back.id, lens.zoom, lens.focus) == (math.inf, "BF", (), None)


def test_optional_lens_values_are_read():
    text = changed(
        SINGLET,
        'name = "Singlet"',
        'name = "Singlet"\ndesigner = "D"\nsource = "S"\nyear = 1954\nnotes = "N"\n'
        'projection = "fisheye"\nimage_circle_diameter_mm = 43',
    )
    lens = read(text).prescription
    assert (lens.designer, lens.source, lens.year, lens.notes) == ("D", "S", 1954, "N")
    assert (lens.projection, lens.image_circle_diameter) == ("fisheye", 43.0)
    assert isinstance(lens.image_circle_diameter, float)


def test_zoom_positions_are_read():
    lens = read(ZOOM).prescription
    assert lens.zoom[0] == ZoomPosition("wide", 53.45, 4.8, 5.0, {"D2": 10.0, "BF": 46.2})
    assert lens.zoom[1].stop_semi_diameter == 5.0
    assert lens.surfaces[0].glass == AbbeGlass(1.5168, 64.2)
    assert lens.configuration("long").surfaces[1].thickness == 30.0


def test_both_signs_of_infinity_are_a_plane():
    text = changed(
        SINGLET, "radius_mm = inf\nthickness_mm = 97", "radius_mm = -inf\nthickness_mm = 97"
    )
    assert read(text).prescription == read(SINGLET).prescription


def test_integers_are_accepted_for_floats():
    text = changed(SINGLET, "half_field_deg = 6.0", "half_field_deg = 6")
    assert read(text).prescription == read(SINGLET).prescription


def test_a_byte_order_mark_and_windows_line_ends_are_accepted():
    text = "\ufeff" + SINGLET.replace("\n", "\r\n")
    assert read(text).prescription == read(SINGLET).prescription


def test_focus_group_is_read_by_ids():
    lens = read(SINGLET + '\n[focus]\nfirst = "S1"\nlast = "BF"\n').prescription
    assert lens.focus == FocusGroup(1, 3)


def test_cylinder_is_read():
    text = changed(SINGLET, "radius_mm = 51.5", 'radius_mm = 51.5\ncurved_along = "y"')
    with pytest.raises(LensFileError) as caught:
        read(text)
    # A single cylinder has no power in the other meridian.
    assert [(one.code, one.path) for one in caught.value.findings] == [("E24", "surface")]
    assert "meridian x" in caught.value.findings[0].message


STRUCTURAL = [
    # old text, new text, all codes and paths expected, words of the sentence
    ('format = "lens-description"\n', "", [("E03", "format")], "no format"),
    ('"lens-description"', '"lens"', [("E03", "format")], '"lens"'),
    ('"lens-description"', "7", [("E03", "format")], "7"),
    ("format_version = 1\n", "", [("E04", "format_version")], "knows: 1"),
    ("format_version = 1\n", "format_version = 2\n", [("E04", "format_version")], "found 2"),
    ("format_version = 1\n", "format_version = 1.0\n", [("E04", "format_version")], "1.0"),
    ("format_version = 1\n", "format_version = true\n", [("E04", "format_version")], "true"),
    ("format_version = 1", 'format_version = 1\n"a b" = 1', [("E05", '"a b"')], "a b"),
    ("blades", "blade", [("E05", "diaphragm.blade")], '"blades"'),
    ("conic = -0.5", "conik = -0.5", [("E05", "surface[2].conik")], '"conic"'),
    (
        "radius_mm = 51.5",
        "raduis_mm = 51.5",
        [("E05", "surface[2].raduis_mm"), ("E06", "surface[2].radius_mm")],
        '"radius_mm"',
    ),
    ('name = "Singlet"\n', "", [("E06", "lens.name")], '"name"'),
    ("f_number = 4.0\n", "", [("E06", "lens.f_number")], '"f_number"'),
    ("thickness_mm = 3.6\n", "", [("E06", "surface[2].thickness_mm")], '"thickness_mm"'),
    ('material = "N-BK7"\n', "", [("E06", "surface[2].material")], '"material"'),
    ('"Singlet"', "5", [("E07", "lens.name")], "integer 5, wanted text"),
    ("99.65", '"99"', [("E07", "lens.focal_length_mm")], "wanted a number"),
    ("51.5", "true", [("E07", "surface[2].radius_mm")], "boolean true, wanted a number"),
    ("stop = true", "stop = 1", [("E07", "surface[1].stop")], "wanted true or false"),
    ("blades = 6", "blades = 6.0", [("E07", "diaphragm.blades")], "float 6.0, wanted an integer"),
    ('"S1"', "1", [("E07", "surface[1].id")], "wanted text"),
    ("51.5", "nan", [("E08", "surface[2].radius_mm")], "radius_mm"),
    ("97.3", "inf", [("E08", "surface[3].thickness_mm")], "thickness_mm"),
    ("99.65", "9" * 400, [("E08", "lens.focal_length_mm")], "focal_length_mm"),
    ("99.65", "1e999", [("E08", "lens.focal_length_mm")], "focal_length_mm"),
    ("-0.5", "inf", [("E08", "surface[2].conic")], "conic"),
    ("1e-9", "nan", [("E08", "surface[2].asphere.a4_per_mm3")], "a4_per_mm3"),
    ("99.65", "-99.65", [("E09", "lens.focal_length_mm")], "-99.65 must be greater than 0"),
    ("6.0", "90", [("E09", "lens.half_field_deg")], "greater than 0 and less than 90"),
    ("3.6", "-3.6", [("E09", "surface[2].thickness_mm")], "-3.6 must be 0 or more"),
    ("12.4565", "0", [("E09", "surface[1].semi_diameter_mm")], "greater than 0"),
    ("0.5\n", "1.5\n", [("E09", "diaphragm.blade_curvature")], "at least 0 and at most 1"),
    ('name = "Singlet"', 'name = "S"\nyear = 1500', [("E09", "lens.year")], "1600"),
    (
        'name = "Singlet"',
        'name = "S"\nprojection = "round"',
        [("E10", "lens.projection")],
        '"rectilinear" or "fisheye"',
    ),
    ('"Singlet"', '""', [("E10", "lens.name")], "1 to 200"),
    ('"Singlet"', f'"{"x" * 201}"', [("E10", "lens.name")], "201"),
    ("conic = -0.5", 'curved_along = "z"', [("E10", "surface[2].curved_along")], '"x" or "y"'),
    ("stop = true\n", "", [("E12", "surface")], "surfaces 1 to 3"),
    ("conic = -0.5", "stop = true", [("E12", "surface")], "surfaces 1, 2"),
    ("51.5", "0", [("E13", "surface[2].radius_mm")], "use inf for a plane"),
    ("51.5", "-0.0", [("E13", "surface[2].radius_mm")], "use inf for a plane"),
    ("51.5", "8.0", [("E14", "surface[2].semi_diameter_mm")], "11.3137085 mm"),
    ("a6_per_mm5", "a5_per_mm4", [("E15", "surface[2].asphere.a5_per_mm4")], "a5_per_mm4"),
    ("a6_per_mm5", "a6_per_mm6", [("E15", "surface[2].asphere.a6_per_mm6")], "a6_per_mm5"),
    ("a6_per_mm5", "a22_per_mm21", [("E15", "surface[2].asphere.a22_per_mm21")], "a22_per_mm21"),
    ('"BF"', '"S1"', [("E20", "surface[3].id")], "surface 1"),
    ('"BF"', '"1F"', [("E20", "surface[3].id")], "1F"),
    ('"BF"', '"A2345678901234567"', [("E20", "surface[3].id")], "15"),
    ("blades = 6", "blades = 2", [("E23", "diaphragm.blades")], "2"),
    ("blades = 6", "blades = 1", [("E23", "diaphragm.blades")], "1"),
    ("blades = 6", "blades = -3", [("E23", "diaphragm.blades")], "-3"),
    ("blades = 6", "blades = 33", [("E23", "diaphragm.blades")], "33"),
]


@pytest.mark.parametrize(("old", "new", "expected", "words"), STRUCTURAL)
def test_one_fault_gives_its_code_its_path_and_says_what_is_allowed(old, new, expected, words):
    found, messages = findings(changed(SINGLET, old, new))
    assert found == expected
    assert any(words in message for message in messages.values()), messages


@pytest.mark.parametrize(
    ("new", "path"),
    [
        ("lens = 1", "lens"),
        ("surface = 1", "surface"),
        ("zoom = {}", "zoom"),
        ("focus = 2", "focus"),
    ],
)
def test_a_value_in_the_place_of_a_table_is_a_wrong_type(new, path):
    found, messages = findings('format = "lens-description"\nformat_version = 1\n' + new)
    assert ("E07", path) in found
    assert "table" in messages["E07"]


def test_an_item_that_is_no_table_is_counted_and_named():
    found, _ = findings('format = "lens-description"\nformat_version = 1\nsurface = [1, {}]')
    assert ("E07", "surface[1]") in found
    assert ("E06", "surface[2].radius_mm") in found
    assert "E11" not in [code for code, _ in found]


def test_missing_surfaces_are_counted():
    text = SINGLET[: SINGLET.index("[[surface]]")]
    found, messages = findings(text)
    assert found == [("E11", "surface"), ("E12", "surface")]
    assert "0 surfaces" in messages["E11"]


def test_one_and_more_than_a_hundred_surfaces_are_refused():
    head, _, rest = SINGLET.partition("[[surface]]")
    first = rest[: rest.index("[[surface]]")]
    found, messages = findings(head + "[[surface]]" + first)
    assert found == [("E11", "surface")]
    assert "1 surface;" in messages["E11"]
    plane = '[[surface]]\nradius_mm = inf\nthickness_mm = 0\nsemi_diameter_mm = 9\nmaterial="air"\n'
    assert findings(SINGLET + plane * 98)[0] == [("E11", "surface")]
    assert read(SINGLET.replace("97.3", "0") + plane * 97).prescription.surfaces[99].thickness == 0


ZOOMED = [
    ("D2 = 30.0, ", "", [("E21", "zoom[2].thickness_mm.D2")], "D2"),
    (
        "D2 = 30.0",
        "D3 = 30.0",
        [("E21", "zoom[2].thickness_mm.D3"), ("E21", "zoom[2].thickness_mm.D2")],
        "long",
    ),
    ("D2 = 30.0", "D2 = -30.0", [("E09", "zoom[2].thickness_mm.D2")], "0 or more"),
    ("D2 = 30.0", "D2 = true", [("E07", "zoom[2].thickness_mm.D2")], "a number"),
    ("59.8", "53.45", [("E22", "zoom[2].focal_length_mm")], "53.45"),
    ("59.8", "-1", [("E09", "zoom[2].focal_length_mm")], "greater than 0"),
    ('label = "wide"\n', "", [("E06", "zoom[1].label")], "label"),
    ('label = "wide"', "label = 36", [("E07", "zoom[1].label")], "text"),
    ("stop_semi_diameter_mm = 5.0", "stop_semi = 5.0", [("E05", "zoom[2].stop_semi")], "stop_semi"),
    ("_mm = 5.0\nthick", "_mm = 0\nthick", [("E09", "zoom[2].stop_semi_diameter_mm")], "0"),
    ("thickness_mm = { D2 = 30.0, BF = 39.9 }", "", [("E06", "zoom[2].thickness_mm")], "thick"),
]


@pytest.mark.parametrize(("old", "new", "expected", "words"), ZOOMED)
def test_a_fault_of_a_zoom_position_names_it(old, new, expected, words):
    found, messages = findings(changed(ZOOM, old, new))
    assert found == expected
    assert any(words in message for message in messages.values()), messages


def test_a_single_zoom_position_is_refused():
    found, messages = findings(ZOOM[: ZOOM.rindex("[[zoom]]")])
    assert found == [("E22", "zoom")]
    assert "1 zoom position;" in messages["E22"]


def test_a_zoomed_stop_must_lie_on_its_surface():
    text = changed(
        ZOOM,
        "radius_mm = inf\nthickness_mm = 1.0\nsemi_diameter_mm = 5.0",
        """\
radius_mm = -6.0
thickness_mm = 1.0
semi_diameter_mm = 4.0""",
    )
    text = changed(text, "stop_semi_diameter_mm = 5.0", "stop_semi_diameter_mm = 6.5")
    assert findings(text)[0] == [("E14", "zoom[2].stop_semi_diameter_mm")]


@pytest.mark.parametrize(
    ("focus", "expected"),
    [
        ('first = "S1"', [("E06", "focus.last")]),
        ('first = "S1"\nlast = "BG"', [("E21", "focus.last")]),
        ('first = "BF"\nlast = "S1"', [("E22", "focus.last")]),
        ('first = 1\nlast = "BF"', [("E07", "focus.first")]),
        ('first = "S1"\nlast = "BF"\nmid = 1', [("E05", "focus.mid")]),
    ],
)
def test_faults_of_the_focus_group_use_the_nearest_codes(focus, expected):
    assert findings(f"{SINGLET}\n[focus]\n{focus}\n")[0] == expected


def test_one_bad_value_hides_no_other_error():
    text = SINGLET
    for old, new in [
        ('"lens-description"', '"other"'),
        ('"Singlet"', "1"),
        ("4.0", "nan"),
        ("blades = 6", "blades = 2"),
        ("51.5", "0"),
        ('"N-BK7"', '"N-BK77"'),
        ("-0.5", '"-0.5"'),
        ("a6_per_mm5", "a7_per_mm6"),
        ("97.3", "-97.3"),
        ("stop = true", ""),
        ('"BF"', '"S1"'),
    ]:
        text = changed(text, old, new)
    found, _ = findings(text)
    assert sorted(code for code, _ in found) == [
        *("E03", "E07", "E07", "E08", "E09", "E12", "E13", "E15", "E17", "E20", "E23"),
    ]


def test_faults_that_leave_the_optics_known_do_not_hide_optical_ones():
    text = changed(SINGLET, '"Singlet"', "1")
    text = changed(text, "radius_mm = 51.5", "radius_mm = -51.5\ncolour = 1")
    found, _ = findings(text)
    assert found == [("E07", "lens.name"), ("E05", "surface[2].colour"), ("E24", "surface")]


def test_warnings_of_a_refused_file_are_told_too():
    text = changed(changed(SINGLET, '"N-BK7"', "{ nd = 1.5168 }"), "blades = 6", "blades = 2")
    with pytest.raises(LensFileError) as caught:
        read(text)
    assert [one.code for one in caught.value.findings] == ["E23"]
    assert [one.code for one in caught.value.warnings] == ["W02"]


def test_the_error_names_file_code_path_and_count():
    text = changed(changed(SINGLET, "51.5", "0"), "97.3", "-1")
    with pytest.raises(LensFileError, match=r"test\.toml: E13 surface\[2\]\.radius_mm: .*1 more"):
        read(text)


def test_messages_show_no_more_of_a_file_than_fits_a_line():
    text = changed(SINGLET, '"N-BK7"', '"' + "x\\u0007\\n" * 9000 + '"')
    _, messages = findings(text)
    assert len(messages["E17"]) < 150
    assert messages["E17"].isprintable()


def test_a_file_of_nothing_but_errors_is_not_read_to_its_end():
    text = changed(SINGLET, "[lens]", "\n".join(f"k{i} = 1" for i in range(5000)) + "\n[lens]")
    with pytest.raises(LensFileError) as caught:
        read(text)
    assert len(caught.value.findings) == 1000
    assert "was not checked" in caught.value.findings[-1].message


def test_sample_lenses_load_and_the_one_warning_is_true(shared):
    noted = {}
    for path in sorted((shared / "lenses").glob("*.toml")):
        noted[path.stem] = [(one.code, one.path) for one in read_lens(path).warnings]
    assert len(noted) == 12
    # The stop of the Sonnar lies 1 mm behind the vertex of a surface whose rim reaches back 6.3 mm.
    assert noted.pop("sonnar-50mm-f1.5") == [("W04", "surface[6].thickness_mm")]
    assert set(map(tuple, noted.values())) == {()}
