"""A claim is one process' and is given back unless the file was written."""

from multiprocessing import get_context

import pytest

from addon.errors import OutputError
from addon.files.claims import Claims
from addon.files.whole_file import whole_file


def test_claimed_files_are_empty_and_given_back(tmp_path):
    paths = [tmp_path / "new" / name for name in "ab"]
    with Claims() as claims:
        assert claims.take(paths)
        assert [path.stat().st_size for path in paths] == [0, 0]
    assert list((tmp_path / "new").iterdir()) == []


def test_all_or_none_is_claimed(tmp_path):
    (tmp_path / "b").write_text("mine")
    with Claims() as claims:
        assert not claims.take([tmp_path / "a", tmp_path / "b", tmp_path / "c"])
        assert [path.name for path in tmp_path.iterdir()] == ["b"]
    assert (tmp_path / "b").read_text() == "mine"


def test_a_written_file_stays(tmp_path):
    settled, written = tmp_path / "settled", tmp_path / "written"
    with Claims() as claims:
        assert claims.take([settled, written])
        with whole_file(written) as place, open(place, "w") as file:
            file.write("done")
        claims.settle(settled)
    assert settled.exists() and written.read_text() == "done"


def test_a_claim_that_cannot_be_made_is_an_error_and_leaves_nothing(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with Claims() as claims, pytest.raises(OutputError, match="cannot write"):
        claims.take([tmp_path / "a", tmp_path / "file" / "b"])
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def _race(folder, barrier, won):
    claims = Claims()
    with claims:
        for number in range(50):
            barrier.wait(60)
            path = folder / str(number)
            if claims.take([path]):
                won.put(number)
                claims.settle(path)


def test_of_several_processes_one_gets_a_frame(tmp_path):
    context = get_context("spawn")
    barrier, won = context.Barrier(3), context.Queue()
    racers = [context.Process(target=_race, args=(tmp_path, barrier, won)) for _ in range(3)]
    for racer in racers:
        racer.start()
    numbers = sorted(won.get(timeout=60) for _ in range(50))
    for racer in racers:
        racer.join(60)
    assert numbers == list(range(50)) and won.empty()
