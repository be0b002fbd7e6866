"""Profiles are made once, and again when the lens is another one."""

import os
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from addon.errors import RenderCancelledError
from addon.lens_io import profile_cache as module
from addon.lens_io.profile_cache import content_hash, profile, profile_folder, prune, pupil_tables
from addon.lens_io.toml.toml_reader import read_lens

REPOSITORY = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def lens(shared):
    return read_lens(shared / "lenses/singlet-planoconvex-100mm.toml").prescription


@pytest.fixture
def made(monkeypatch):
    """What was made, and not found."""
    calls = []
    make = module.make_profile
    monkeypatch.setattr(
        module, "make_profile", lambda *a, **k: calls.append(k["chromatic"]) or make(*a, **k)
    )
    return calls


def get(lens, folder, **options):
    return profile(lens, folder=folder, chromatic=False, **options)


def test_second_time_it_is_read(lens, tmp_path, made):
    first, second = get(lens, tmp_path), get(lens, tmp_path)
    assert made == [False]
    np.testing.assert_array_equal(first.states[0].ray_map.values, second.states[0].ray_map.values)


def test_color_is_another_file(lens, tmp_path, made):
    get(lens, tmp_path)
    profile(lens, folder=tmp_path)
    profile(lens, folder=tmp_path)
    assert made == [False, True]


def test_changed_lens_is_made_again(lens, tmp_path, made):
    get(lens, tmp_path)
    surfaces = list(lens.surfaces)
    surfaces[0] = replace(surfaces[0], thickness=surfaces[0].thickness + 1e-9)
    get(replace(lens, surfaces=tuple(surfaces)), tmp_path)
    assert made == [False, False]


def test_name_and_notes_do_not_count(lens):
    assert content_hash(lens) == content_hash(replace(lens, name="Other", notes="new"))


def test_zoom_positions_differ(shared):
    zoom = read_lens(shared / "lenses/zoom-36-69mm-f3.5.toml").prescription
    assert len({content_hash(zoom, label) for label in zoom.labels}) == len(zoom.labels)
    assert content_hash(zoom) == content_hash(zoom, zoom.labels[0])


def test_new_version_is_made_again(lens, tmp_path, made, monkeypatch):
    get(lens, tmp_path)
    monkeypatch.setattr(module, "CONTENT_VERSION", module.CONTENT_VERSION + 1)
    get(lens, tmp_path)
    assert len(made) == 2


@pytest.mark.parametrize("damage", ["empty", "half", "other", "flipped"])
def test_damaged_file_is_made_again(lens, tmp_path, made, damage):
    get(lens, tmp_path)
    (path,) = tmp_path.glob("*.exr")
    whole = path.read_bytes()
    middle = len(whole) // 2
    content = {
        "empty": b"",
        "half": whole[:middle],
        "other": b"something else",
        "flipped": whole[:middle] + bytes([whole[middle] ^ 255]) + whole[middle + 1 :],
    }[damage]
    path.write_bytes(content)
    get(lens, tmp_path)
    get(lens, tmp_path)
    assert len(made) == 2


def test_folder_that_cannot_be_written_only_costs_time(lens, tmp_path, made):
    (tmp_path / "file").write_text("in the way")
    get(lens, tmp_path / "file" / "folder")
    get(lens, tmp_path / "file" / "folder")
    assert len(made) == 2


def test_cancelling_leaves_nothing(lens, tmp_path):
    with pytest.raises(RenderCancelledError):
        get(lens, tmp_path, cancelled=lambda: True)
    assert os.listdir(tmp_path) == []


def test_progress_ends_at_one_also_when_found(lens, tmp_path):
    for _ in range(2):
        told = []
        get(lens, tmp_path, progress=told.append)
        assert told[-1] == 1.0 and told == sorted(told)


def test_oldest_files_go_first_and_others_stay(tmp_path):
    for age, name in enumerate(["a.exr", "thumb-b.npy", "c.exr", "keep.txt"]):
        (tmp_path / name).write_bytes(bytes(100))
        os.utime(tmp_path / name, (1000 + age, 1000 + age))
    old, young = tmp_path / ".a.part", tmp_path / ".b.part"
    old.touch(), young.touch()
    os.utime(old, (time.time() - 1e6,) * 2)
    prune(tmp_path, largest=250)
    assert sorted(os.listdir(tmp_path)) == [".b.part", "c.exr", "keep.txt", "thumb-b.npy"]


def test_reading_makes_a_file_young(lens, tmp_path):
    get(lens, tmp_path)
    (path,) = tmp_path.glob("*.exr")
    os.utime(path, (1000, 1000))
    get(lens, tmp_path)
    assert path.stat().st_mtime > 1000


def test_many_writers_at_once_leave_one_good_file(shared, tmp_path):
    code = (
        "import sys\n"
        f"sys.path.insert(0, {str(REPOSITORY)!r})\n"
        "from pathlib import Path\n"
        "from addon.lens_io.profile_cache import profile\n"
        "from addon.lens_io.toml.toml_reader import read_lens\n"
        "lens = read_lens(Path(sys.argv[1])).prescription\n"
        "profile(lens, folder=Path(sys.argv[2]), chromatic=False)\n"
    )
    lens = shared / "lenses/singlet-planoconvex-100mm.toml"
    command = [sys.executable, "-W", "error", "-c", code, str(lens), str(tmp_path)]
    running = [subprocess.Popen(command, stderr=subprocess.PIPE) for _ in range(4)]
    for one in running:
        _, errors = one.communicate(timeout=120)
        assert one.returncode == 0, errors.decode()
    assert len(os.listdir(tmp_path)) == 1


def test_profiles_have_a_folder_of_their_own(monkeypatch, tmp_path):
    monkeypatch.setenv("APLANAT_CACHE", str(tmp_path))
    assert profile_folder() == tmp_path / "profiles"


def test_off_axis_pupil_is_kept_too(lens, tmp_path, monkeypatch):
    first = pupil_tables(lens, folder=tmp_path)
    # Nothing is made, so nothing is written.
    monkeypatch.setattr(module, "save_profile", None)
    second = pupil_tables(lens, folder=tmp_path)
    np.testing.assert_array_equal(first.tables, second.tables)
