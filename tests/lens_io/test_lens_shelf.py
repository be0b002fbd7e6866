"""The library in memory: read once, read again on demand, never guessed."""

import os
import shutil
import threading

import pytest

from addon.errors import LensFileError
from addon.lens_io.lens_shelf import LensShelf, unused_id
from addon.lens_io.library import SHIPPED_FOLDER

SINGLET = """
format = "lens-description"
format_version = 1
[lens]
name = "{name}"
focal_length_mm = 100.0
f_number = 5.0
half_field_deg = 5.0
[[surface]]
radius_mm = 51.68
thickness_mm = 4.0
semi_diameter_mm = 10.0
material = {{ nd = 1.5168, vd = 64.17 }}
stop = true
[[surface]]
radius_mm = inf
thickness_mm = 97.4
semi_diameter_mm = 10.0
material = "air"
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "mine.toml").write_text(SINGLET.format(name="Mine"))
    (tmp_path / "broken.toml").write_text("format = 3")
    return tmp_path


@pytest.fixture
def shelf(folder):
    return LensShelf([folder])


def touch_later(path):
    found = path.stat()
    os.utime(path, ns=(found.st_atime_ns, found.st_mtime_ns + 10**9))


def test_a_lens_is_read_once(shelf):
    first = shelf.find("mine")
    assert first.name == "Mine" and first.error is None and not first.shipped
    assert shelf.find("mine") is first


def test_a_file_that_cannot_be_used_is_kept_with_its_errors(shelf):
    broken = shelf.find("broken")
    assert broken.lens is None
    assert {finding.code for finding in broken.error.findings} >= {"E03", "E04", "E06"}
    assert broken.name == "broken"


def test_an_unknown_id_is_nothing_and_near_names_are_told(shelf):
    assert shelf.find("mein") is None
    assert shelf.near_ids("mein")[0] == "mine"
    assert "broken" in shelf.near_ids("rok")
    assert shelf.near_ids("") == []
    assert shelf.near_ids("x" * 10_000) == []


def test_a_changed_file_is_read_again_only_on_reload(shelf, folder):
    first = shelf.find("mine")
    (folder / "mine.toml").write_text(SINGLET.format(name="Mine, changed"))
    touch_later(folder / "mine.toml")
    assert shelf.is_out_of_date("mine")
    assert shelf.find("mine") is first
    assert shelf.reload().changed == ("mine",)
    assert shelf.find("mine").name == "Mine, changed"
    assert not shelf.is_out_of_date("mine")


def test_reload_keeps_what_did_not_change(shelf, folder):
    first = shelf.find("mine")
    (folder / "new.toml").write_text(SINGLET.format(name="New"))
    assert "new" not in shelf.ids()
    (folder / "broken.toml").unlink()
    found = shelf.reload()
    assert (found.added, found.removed, found.changed) == (("new",), ("broken",), ())
    assert shelf.find("mine") is first
    assert shelf.find("broken") is None


def test_a_file_that_is_gone_stays_usable_until_reload(shelf, folder):
    first = shelf.find("mine")
    (folder / "mine.toml").unlink()
    assert shelf.is_out_of_date("mine")
    assert shelf.find("mine") is first
    shelf.reload()
    assert shelf.find("mine") is None


def test_a_file_from_elsewhere_is_taken_in_under_an_id_of_its_own(shelf, folder, tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    shutil.copy(folder / "mine.toml", elsewhere / "mine.toml")
    lens_id = shelf.add_file(elsewhere / "mine.toml")
    assert lens_id == "mine-2"
    assert shelf.add_file(elsewhere / "mine.toml") == lens_id
    assert shelf.add_file(folder / "mine.toml") == "mine"
    shelf.reload()
    assert shelf.find(lens_id).path == elsewhere / "mine.toml"
    with pytest.raises(LensFileError, match="E03"):
        shelf.add_file(folder / "broken.toml")


def test_shipped_lenses_are_told_apart():
    shelf = LensShelf()
    shipped = shelf.ids()
    if not shipped:
        pytest.skip("no lens ships yet")
    assert shelf.find(shipped[0]).shipped
    assert shelf.find(shipped[0]).path.parent == SHIPPED_FOLDER


def test_threads_get_the_same_lens(shelf):
    found = []
    threads = [threading.Thread(target=lambda: found.append(shelf.find("mine"))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8 and len(set(map(id, found))) == 1


def test_unused_ids_are_numbered():
    assert unused_id("a", {"b"}) == "a"
    assert unused_id("a", {"a", "a-2"}) == "a-3"
