"""Held files stand in for real ones, and come to their place or are forgotten."""

from pathlib import Path

import pytest

from addon.files.held_files import HeldFiles, publish


def test_what_is_written_under_a_stand_in_belongs_to_the_real_folder(tmp_path):
    real = tmp_path / "out"
    with HeldFiles() as held:
        folder = Path(held.stand_in("node", f"{real}/"))
        (folder / "sub").mkdir(parents=True)
        (folder / "a.txt").write_text("a")
        (folder / "sub" / "b.txt").write_text("b")
        found = held.found("node")
        assert [(held.read_text(), place) for held, place in found] == [
            ("a", real / "a.txt"),
            ("b", real / "sub" / "b.txt"),
        ]
        assert held.found("other") == []
        assert not real.exists()
        (real / "sub").mkdir(parents=True)
        for path, place in found:
            publish(path, place)
    assert (real / "sub" / "b.txt").read_text() == "b"
    assert not folder.exists()


def test_a_stand_in_keeps_what_only_the_writer_understands(tmp_path):
    with HeldFiles() as held:
        place = held.stand_in("node", f"{tmp_path.as_posix()}/{{scene_name}}/")
        assert place.endswith(f"{tmp_path.as_posix().lstrip('/')}/{{scene_name}}/")


def test_files_that_nobody_published_go_with_the_folder(tmp_path):
    seen = []

    def fail():
        with HeldFiles() as held:
            place = held.room("picture") / "a.txt"
            place.write_text("a")
            seen.append(place)
            raise RuntimeError("in the middle")

    with pytest.raises(RuntimeError):
        fail()
    assert not seen[0].exists() and not seen[0].parent.exists()
