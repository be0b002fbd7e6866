"""Profiles in EXR files."""

import os

import numpy as np
import pytest

from addon.errors import InputError, OutputError
from addon.lens_bokeh.tables.mapping import pattern_row
from addon.lens_bokeh.tables.profile import make_profile, profile_table
from addon.lens_io.profile_file import StoredProfile, load_profile, save_profile
from addon.lens_io.toml.toml_reader import read_lens
from addon.optics.prescription import FocusGroup


@pytest.fixture(scope="module")
def lens(shared):
    return read_lens(shared / "lenses/tessar-50mm-f2.8.toml").prescription.configuration()


@pytest.fixture(scope="module")
def stored(lens):
    profile = make_profile(lens, name="Tessar", wavelengths_nm=[450.0, 550.0, 620.0])
    return StoredProfile(profile, profile_table(profile, rows=32, radii=48))


@pytest.fixture
def path(tmp_path, stored):
    place = tmp_path / "tessar.exr"
    save_profile(place, stored, lens_id="tessar", content_hash="abc")
    return place


def same(one, other):
    assert one.name == other.name and one.label == other.label
    assert one.f_number == other.f_number
    np.testing.assert_array_equal(one.color, other.color)
    np.testing.assert_array_equal(one.wavelengths_nm, other.wavelengths_nm)
    np.testing.assert_array_equal(one.nearness, other.nearness)
    for state, twin in zip(one.states, other.states, strict=True):
        assert state.first_order == twin.first_order
        for name, value in vars(state.ray_map).items():
            np.testing.assert_array_equal(value, getattr(twin.ray_map, name), err_msg=name)


def test_profile_and_table_are_read_back_equal(path, stored):
    found = load_profile(path)
    same(found.profile, stored.profile)
    np.testing.assert_array_equal(found.table.density, stored.table.density)
    # Planes are kept in single precision.
    np.testing.assert_allclose(found.table.planes, stored.table.planes, rtol=1e-6)
    row, twin = (pattern_row(s.profile, 900.0, 2000.0, 4.0) for s in (found, stored))
    np.testing.assert_array_equal(row.density, twin.density)


def test_lens_with_a_focus_group_is_read_back_equal(lens, tmp_path):
    profile = make_profile(lens, chromatic=False, focus_group=FocusGroup(1, 2))
    assert len(profile.states) > 1
    save_profile(tmp_path / "a.exr", StoredProfile(profile))
    same(load_profile(tmp_path / "a.exr").profile, profile)


def test_file_says_what_it_is(path):
    words = load_profile(path).words
    assert words["lens"] == "Tessar" and words["lensId"] == "tessar" and words["lensHash"] == "abc"
    assert words["wavelengths_nm"] == "450, 550, 620"
    assert float(words["objectDistance_mm"]) == 1000.0


def test_any_reader_finds_rows_of_energy_one(path):
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        part = next(part for part in file.parts if part.name() == "table")
        red = np.asarray(part.channels["R"].pixels, float)
    columns = red.shape[1]
    areas = np.pi * np.diff(np.arange(columns + 1) ** 2) / columns**2
    np.testing.assert_allclose(red @ areas, 1.0, atol=1e-4)


def test_further_parts_travel_along(tmp_path):
    pictures = {"pupil.0": np.arange(24, dtype=np.float32).reshape(2, 3, 4)}
    save_profile(tmp_path / "a.exr", StoredProfile(None, None, {"pupil": "yes"}, pictures))
    found = load_profile(tmp_path / "a.exr")
    assert found.profile is None and found.words["pupil"] == "yes"
    np.testing.assert_array_equal(found.pictures["pupil.0"], pictures["pupil.0"])


def test_damaged_files_are_refused(path):
    whole = path.read_bytes()
    rng = np.random.default_rng(7)
    for content in (
        b"",
        b"not an EXR file at all",
        whole[: len(whole) // 2],
        whole[:-10],
        *(_with_flip(whole, int(rng.integers(len(whole)))) for _ in range(12)),
    ):
        path.write_bytes(content)
        try:
            load_profile(path)
        except InputError:
            continue
        # A flip in a word that says nothing about numbers is no damage.
        assert len(content) == len(whole)


def _with_flip(content, place):
    return content[:place] + bytes([content[place] ^ 0x10]) + content[place + 1 :]


def test_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"nothing\.exr"):
        load_profile(tmp_path / "nothing.exr")


def test_other_exr_files_are_refused(tmp_path):
    import OpenEXR

    pixels = np.zeros((4, 4), np.float32)
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"Y": pixels}).write(str(tmp_path / "a.exr"))
    with pytest.raises(InputError):
        load_profile(tmp_path / "a.exr")


def test_folder_that_does_not_exist_leaves_nothing(tmp_path, stored):
    with pytest.raises(OutputError):
        save_profile(tmp_path / "no" / "a.exr", stored)
    assert os.listdir(tmp_path) == []
