"""`aplanat lens info` and `trace` against the values of independent software."""

import json

import pytest

from addon.cli.command import main
from tests.cli.running import runner

# The wavelengths of the referee by its keys, which have six digits.
WAVELENGTHS = {"587.562": 587.5618, "486.133": 486.1327, "656.273": 656.2725}


@pytest.fixture
def aplanat(capfd):
    """Run the command line in this process, without Blender."""

    return runner(main, capfd)


@pytest.fixture(scope="module")
def referee(shared):
    return json.loads((shared / "lenses/referee.json").read_text())["lenses"]


def settings(referee, lens):
    """Yield zoom options, wavelength and the referee's values for each of a lens' settings."""
    for configuration in referee[lens]["configs"]:
        zoom = ("--zoom", configuration["label"]) if configuration["label"] else ()
        for key, values in configuration["wavelengths"].items():
            wavelength = WAVELENGTHS.get(key, float(key))
            yield zoom, wavelength, configuration, values


LENSES = (
    "aspheric-30mm-f2",
    "double-gauss-50mm-f2",
    "fisheye-16mm-f2.8",
    "singlet-planoconvex-100mm",
    "zoom-36-69mm-f3.5",
)


@pytest.mark.parametrize("lens", LENSES)
def test_info_tells_the_referees_first_order_values(aplanat, shared, referee, lens):
    file = shared / f"lenses/{lens}.toml"
    for zoom, wavelength, configuration, values in settings(referee, lens):
        done = aplanat("lens", "info", file, "--json", "--wavelength", wavelength, *zoom)
        assert done.code == 0, done.err
        answer = done.answer
        assert answer["label"] == configuration["label"]
        assert answer["wavelength_nm"] == wavelength
        # As many digits as the referee has: seven for lengths, eight for indices.
        for key, value in values["first_order"].items():
            assert answer[key] == pytest.approx(value, rel=0, abs=1e-7), key
        assert answer["index"] == pytest.approx(values["index"], rel=0, abs=1e-8)


@pytest.mark.parametrize("lens", LENSES)
def test_trace_tells_the_referees_fan(aplanat, shared, referee, lens):
    file = shared / f"lenses/{lens}.toml"
    # What the two packages of the referee agree to.
    tolerance = 1e-5 if lens.startswith("aspheric") else 1e-6
    for zoom, wavelength, configuration, values in settings(referee, lens):
        fan = values["axis_fan"]
        planes = ",".join(map(str, configuration["plane_distance_mm"]))
        distance = configuration["object_to_first_vertex_mm"]
        done = aplanat(
            *("lens", "trace", file, "--json", "--object-to-first-vertex-mm", distance, *zoom),
            *("--wavelength", wavelength, "--planes-mm", planes, "--rho", "0,0.05,..,1"),
        )
        assert done.code == 0, done.err
        assert done.answer["blocked_at_surface"] == fan["blocked_at_surface"]
        assert done.answer["rho"] == pytest.approx([i / 20 for i in range(21)], abs=1e-15)
        assert_equal(done.answer["tan_slope"], fan["tan_slope"], tolerance)
        for heights, expected in zip(done.answer["heights_mm"], fan["heights_mm"], strict=True):
            assert_equal(heights, expected, tolerance)


def assert_equal(values, expected, tolerance):
    assert [value is None for value in values] == [value is None for value in expected]
    known = [pair for pair in zip(values, expected, strict=True) if pair[1] is not None]
    assert all(abs(value - wanted) <= tolerance for value, wanted in known)


def test_default_planes_are_the_referees(aplanat, shared, referee):
    configuration = referee["double-gauss-50mm-f2"]["configs"][0]
    done = aplanat(
        *("lens", "trace", shared / "lenses/double-gauss-50mm-f2.toml", "--json"),
        *("--object-to-first-vertex-mm", configuration["object_to_first_vertex_mm"]),
    )
    expected = configuration["plane_distance_mm"]
    assert done.answer["plane_distance_mm"] == pytest.approx(expected, abs=1e-6)
    assert len(done.answer["heights_mm"]) == 5


@pytest.mark.parametrize("lens", ["double-gauss-50mm-f2", "fisheye-16mm-f2.8"])
def test_trace_tells_the_referees_vignetting(aplanat, shared, referee, lens):
    found = referee[lens]["configs"][0]["vignetting"]
    for expected in (found["axis"], found["field_0.7"], found["field_1"]):
        done = aplanat(
            *("lens", "trace", shared / f"lenses/{lens}.toml", "--json"),
            *("--field-deg", expected.get("field_deg", 0.0), "--grid", "301"),
        )
        # 0.3 % of the referee's own grid, and 0.2 % of ours.
        for key in ("area_passing_mm2", "fraction_of_paraxial_pupil"):
            assert done.answer[key] == pytest.approx(expected[key], rel=5e-3), key


def test_rays_that_fail_are_null(aplanat, shared):
    done = aplanat(
        *("lens", "trace", shared / "lenses/double-gauss-50mm-f2.toml", "--json"),
        *("--object-to-first-vertex-mm", "1000", "--rho", "0,1,9"),
    )
    assert done.code == 0
    assert done.answer["blocked_at_surface"][2] is None
    assert done.answer["tan_slope"][2] is None
    assert [plane[2] for plane in done.answer["heights_mm"]] == [None] * 5
    assert done.answer["blocked_at_surface"][:2] == [0, 0]


def test_a_shipped_lens_is_known_by_its_id(aplanat):
    listed = aplanat("lens", "list", "--json").answer["lenses"]
    assert len(listed) >= 18
    for entry in listed:
        assert entry["errors"] == [] and entry["shipped"], entry
        assert len(entry["focal_length_mm"]) == max(len(entry["zoom"]), 1)
    answer = aplanat("lens", "info", listed[0]["id"], "--json").answer
    assert answer["name"] == listed[0]["name"]
    assert answer["source"]


def test_without_json_tables_for_people_are_printed(aplanat):
    text = aplanat("lens", "list").out
    assert "tessar-50mm-f2.8" in text
    text = aplanat("lens", "info", "tessar-50mm-f2.8").out
    assert "focal length" in text and "entrance pupil at" in text and "stop" in text
    text = aplanat("lens", "trace", "tessar-50mm-f2.8", "--field-deg", "10", "--grid", "51").out
    assert "area that passes" in text
