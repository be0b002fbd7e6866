"""Lenses of the user's own: every file that comes in is a lens description afterwards."""

from dataclasses import replace

import pytest

from addon.errors import LensFileError, OutputError
from addon.lens_io.importers import ImportOptions
from addon.lens_io.lens_shelf import LensShelf
from addon.lens_io.library import SHIPPED_FOLDER
from addon.lens_io.toml.toml_reader import read_lens
from addon.lens_io.user_lenses import copy_into, id_for, import_into, remove

LENS = SHIPPED_FOLDER / "tessar-50mm-f2.8.toml"


@pytest.fixture
def samples(shared):
    return shared / "lenses" / "import-samples"


def test_a_lens_description_is_taken_in_as_it_is(tmp_path):
    folder = tmp_path / "new" / "lenses"
    added = import_into(folder, LENS, ())
    assert (added.id, added.name) == (LENS.stem, read_lens(LENS).prescription.name)
    assert added.path.read_bytes() == LENS.read_bytes()


@pytest.mark.parametrize(
    "name", ["aspheric-30mm-f2.zmx", "dgauss.50mm.dat", "double-gauss-rdm-n.seq"]
)
def test_a_foreign_file_becomes_a_lens_description(samples, tmp_path, name):
    options = ImportOptions(half_field_deg=20.0)
    added = import_into(tmp_path, samples / name, (), options)
    assert added.path.suffix == ".toml"
    assert LensShelf([tmp_path]).find(added.id).lens.prescription.name == added.name


def test_an_id_in_use_gets_a_number_and_the_same_file_is_not_doubled(tmp_path):
    first = import_into(tmp_path, LENS, ("other",))
    assert import_into(tmp_path, LENS, (first.id,)).path == first.path
    first.path.write_bytes(first.path.read_bytes() + b"\n# changed\n")
    assert import_into(tmp_path, LENS, (first.id,)).id == f"{LENS.stem}-2"
    # A file system may not tell upper from lower case.
    assert import_into(tmp_path / "b", LENS, (LENS.stem.upper(),)).id == f"{LENS.stem}-2"


def test_a_file_that_cannot_be_used_leaves_nothing(samples, tmp_path):
    with pytest.raises(LensFileError, match="I02"):
        import_into(tmp_path / "lenses", samples / "reject-mirror.zmx", ())
    broken = tmp_path / "broken.toml"
    broken.write_text("format = 1")
    with pytest.raises(LensFileError):
        import_into(tmp_path / "lenses", broken, ())
    with pytest.raises(LensFileError):
        import_into(tmp_path / "lenses", tmp_path / "nowhere.zmx", ())
    assert not (tmp_path / "lenses").exists()


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="file"):
        import_into(tmp_path / "file" / "lenses", LENS, ())


def test_a_copy_has_a_name_and_id_of_its_own_and_keeps_comments(tmp_path):
    original = tmp_path / "mine.toml"
    original.write_bytes(b"# where it is from\n" + LENS.read_bytes())
    copy = copy_into(tmp_path, original, ("mine",))
    assert copy.id == "mine-copy"
    old, new = read_lens(original).prescription, read_lens(copy.path).prescription
    assert new == replace(old, name=f"{old.name} (copy)")
    assert copy.path.read_bytes().startswith(b"# where it is from\n")


def test_a_copy_of_an_unusual_file_is_written_anew(tmp_path):
    original = tmp_path / "mine.toml"
    text = LENS.read_text(encoding="utf-8")
    name = read_lens(LENS).prescription.name
    original.write_text(text.replace(f'"{name}"', f'"""{name}"""'), encoding="utf-8")
    copy = copy_into(tmp_path, original, ())
    assert read_lens(copy.path).prescription.name == f"{name} (copy)"


def test_a_removed_lens_is_gone(tmp_path):
    added = import_into(tmp_path, LENS, ())
    remove(added.path)
    assert not added.path.exists()
    remove(added.path)
    with pytest.raises(OutputError, match="cannot delete"):
        remove(tmp_path)


@pytest.mark.parametrize(
    ("text", "lens_id"),
    [
        ("Summicron 50", "summicron-50"),
        ("dgauss.50mm", "dgauss.50mm"),
        ("../../etc/passwd", "etc-passwd"),
        ("Größe", "größe"),
        ("***", "lens"),
        ("x" * 300, "x" * 80),
    ],
)
def test_ids_are_plain(text, lens_id):
    assert id_for(text) == lens_id
