"""Focus, depth and f-number to patterns, against tracing every ray."""

import json

import numpy as np
import pytest

from addon.errors import FocusError, InputError
from addon.lens_bokeh.tables.mapping import equivalent_image_distance, frame_table, pattern_row
from addon.lens_bokeh.tables.profile import PatternRow, make_profile
from addon.lens_io.toml.toml_reader import read_lens
from benchmarks.reference.profile_bench import bench_profile, compare, psnr_grid
from benchmarks.reference.traced_bokeh import RingPattern, rings_of_row


@pytest.fixture(scope="module")
def lens_of(shared):
    return lambda name: read_lens(shared / f"lenses/{name}.toml").prescription.configuration()


@pytest.fixture(scope="module")
def gauss(lens_of):
    return make_profile(lens_of("double-gauss-50mm-f2"), chromatic=False)


@pytest.mark.parametrize(
    "name",
    [
        "double-gauss-50mm-f2",
        "petzval-51mm-f1.4",
        "sonnar-50mm-f1.5",
        "retrofocus-35mm-f2.5",
        "zoom-36-69mm-f3.5",
        "aspheric-30mm-f2",
        "telephoto-180mm-f2.8",
        "fisheye-16mm-f2.8",
    ],
)
def test_patterns_are_those_of_a_direct_trace(lens_of, name):
    lens = lens_of(name)
    profile = make_profile(lens, chromatic=False)
    # A part of the whole grid of 8 x 6 x 3, with fewer rays.
    values = [v[-1] for v in psnr_grid(lens, profile, rays=1 << 15, objects=4, focuses=2)]
    assert np.median(values) >= 45.0
    assert min(values) >= 30.0


def test_bench_tells_times_energies_and_patterns(lens_of):
    told = bench_profile(
        lens_of("singlet-planoconvex-100mm"), "s", rays=1 << 14, objects=2, focuses=2
    )
    assert set(told["seconds"]) == {"achromatic", "chromatic", "frame_table", "row"}
    assert told["row_energy_error"] < 1e-4
    assert len(told["psnr"]["values"]) == 2 * 2 * 3
    assert json.loads(json.dumps(told, allow_nan=False)) == told


def as_rings(row):
    rings = 1024
    return RingPattern(row.extent, rings_of_row(row, row.extent, rings))


def test_frame_table_sampled_like_a_shader_gives_the_pattern(gauss):
    for focus, f_number in ((2000.0, 2.03), (np.inf, 4.0)):
        table = frame_table(gauss, focus, f_number, rows=256, radii=256)
        for distance in (400.0, 1200.0, 2600.0, 20000.0):
            row = pattern_row(gauss, distance, focus, f_number)
            extent, density = table.sample(distance)
            # A hundredth of a table's row, at most.
            assert extent == pytest.approx(row.extent, rel=0.01)
            found = PatternRow(extent, density, row.brought)
            assert found.energy == pytest.approx(1.0, abs=1e-4)
            assert compare(found, as_rings(row)) > 35.0


def test_blur_is_signed_zero_in_focus_and_linear_in_vergence(gauss):
    table = frame_table(gauss, 2000.0, 2.03, rows=32, radii=32)

    def blur(distance):
        return table.blur[0] + table.blur[1] / (distance + table.pupil_offset)

    assert blur(2000.0) == pytest.approx(0.0, abs=1e-12)
    assert blur(1000.0) < 0.0 < blur(4000.0)
    # What rays do: the pattern's extent is the blur where aberrations are small.
    small = frame_table(gauss, 2000.0, 22.0, rows=8, radii=8)
    row = pattern_row(gauss, 500.0, 2000.0, 22.0)
    expected = small.blur[0] + small.blur[1] / (500.0 + small.pupil_offset)
    assert row.extent == pytest.approx(-expected, rel=1e-3)


def test_rows_of_the_frame_table_have_energy_one(gauss):
    table = frame_table(gauss, 1500.0, 2.8, rows=24, radii=64)
    areas = np.pi * np.diff(np.linspace(0.0, 1.0, 65) ** 2)
    np.testing.assert_allclose(np.einsum("r,krc->kc", areas, table.density), 1.0, atol=1e-5)


def test_equivalent_focus_has_the_same_circle_of_confusion(gauss):
    focal = gauss.states[0].first_order.efl

    def coc(distance, focus):
        return focal / (focus - focal) * (distance - focus) / distance

    for distance, focus in ((400.0, 900.0), (3000.0, 700.0), (8000.0, 8001.0)):
        image, scale = equivalent_image_distance(gauss, distance, focus)
        equivalent = image * focal / (image - focal)
        assert scale == pytest.approx(coc(distance, focus))
        assert coc(1000.0, equivalent) == pytest.approx(coc(distance, focus))


def test_reference_object_in_focus_is_its_own_row(gauss):
    focal = gauss.states[0].first_order.efl
    image, scale = equivalent_image_distance(gauss, 1000.0, 1000.0)
    assert scale == 0.0
    assert image == pytest.approx(1000.0 * focal / (1000.0 - focal))


def test_infinite_distances_are_distances(gauss):
    row = pattern_row(gauss, np.inf, np.inf, 2.03)
    assert 0.0 < row.extent < 0.1
    _, scale = equivalent_image_distance(gauss, np.inf, 2000.0)
    assert np.isfinite(scale)


def test_objects_nearer_than_the_map_keep_growing(gauss):
    extents = [pattern_row(gauss, d, 2000.0, 2.8).extent for d in (120.0, 70.0, 60.0, 50.0)]
    assert np.all(np.diff(extents) > 0.0)


def test_objects_inside_the_lens_are_refused(gauss):
    with pytest.raises(InputError, match="entrance pupil"):
        pattern_row(gauss, -100.0, 2000.0, 2.8)


def test_focus_inside_the_focal_length_is_refused(gauss):
    for function in (
        lambda: frame_table(gauss, 30.0, 2.8),
        lambda: pattern_row(gauss, 1e3, 30.0, 2),
    ):
        with pytest.raises(FocusError, match="focal length"):
            function()
