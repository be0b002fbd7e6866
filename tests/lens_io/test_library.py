"""The library of lenses: ids, folders, paths."""

import pytest

from addon.errors import LensFileError
from addon.lens_io.library import SHIPPED_FOLDER, Library
from tests.lens_io.lens_texts import SINGLET, ZOOM


@pytest.fixture
def folders(tmp_path):
    mine, ours = tmp_path / "mine", tmp_path / "ours"
    for folder in (mine, ours):
        folder.mkdir()
    (ours / "singlet-100mm-f2.8.toml").write_text(SINGLET)
    (ours / "zoom.toml").write_text(ZOOM)
    (mine / "zoom.toml").write_text(ZOOM.replace("Two lenses", "My zoom"))
    (mine / "notes.txt").write_text("no lens")
    (mine / ".hidden.toml").write_text("no lens")
    return mine, ours


def test_ids_are_file_names_without_ending(folders):
    ids = Library(folders).ids()
    assert {"singlet-100mm-f2.8", "zoom"} <= set(ids)
    assert list(ids) == sorted(ids)
    assert not {"notes", ".hidden"} & set(ids)


def test_shipped_lenses_are_always_there():
    stems = {path.stem for path in SHIPPED_FOLDER.glob("*.toml")}
    assert set(Library().ids()) == stems


def test_the_first_folder_goes_first(folders):
    mine, ours = folders
    assert Library(folders).open("zoom").prescription.name == "My zoom"
    assert Library((ours, mine)).path_of("zoom") == ours / "zoom.toml"


def test_a_lens_is_opened_by_id_or_by_path(folders):
    library = Library(folders)
    path = folders[1] / "singlet-100mm-f2.8.toml"
    for lens in ("singlet-100mm-f2.8", path, str(path)):
        assert library.open(lens).path == path


def test_a_folder_that_is_missing_has_no_lenses(tmp_path):
    assert Library([tmp_path / "missing"]).ids() == Library().ids()


def test_an_unknown_id_comes_with_near_names(folders):
    library = Library(folders)
    for ask in (library.open, library.path_of):
        with pytest.raises(LensFileError, match="singlet-100mm-f2.8") as caught:
            ask("singlet-100mm")
        assert [one.code for one in caught.value.findings] == ["E01"]


@pytest.mark.parametrize("lens", ["missing/lens.toml", "lens.toml", "a\0b", "x" * 5000, "", "."])
def test_what_is_neither_id_nor_file_is_our_error(lens):
    with pytest.raises(LensFileError):
        Library().open(lens)
