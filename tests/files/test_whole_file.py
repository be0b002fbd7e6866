"""A file is there whole or not at all, whatever ends its writing."""

import errno
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from addon.errors import OutputError, UnfinishedFileError
from addon.files import whole_file as module
from addon.files.whole_file import check_writable, reason_of, whole_file

REPOSITORY = Path(__file__).resolve().parents[2]


@pytest.fixture(params=["nameless", "named"])
def kind(request, monkeypatch):
    """Both ways of writing: with the system's nameless files, and without."""
    if request.param == "named":
        monkeypatch.setattr(module, "_open", module._NamedFile)
    elif not hasattr(os, "O_TMPFILE"):
        pytest.skip("this system has no nameless files")
    return request.param


def test_file_appears_with_its_content(kind, tmp_path):
    path = tmp_path / "a.txt"
    with whole_file(path) as place:
        Path(place).write_text("all of it")
        assert not path.exists()
    assert path.read_text() == "all of it"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_existing_file_is_replaced(kind, tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old and longer")
    with whole_file(path) as place:
        Path(place).write_text("new")
        assert path.read_text() == "old and longer"
    assert path.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_nothing_stays_after_an_exception(kind, tmp_path):
    def write_half():
        with whole_file(tmp_path / "a.txt") as place:
            Path(place).write_text("half")
            raise RuntimeError("in the middle")

    with pytest.raises(RuntimeError):
        write_half()
    assert os.listdir(tmp_path) == []


@pytest.mark.skipif(sys.platform == "win32", reason="permissions of POSIX")
@pytest.mark.parametrize("mask", [0o022, 0o027, 0o077, 0o000])
def test_file_has_the_permissions_of_the_umask(kind, tmp_path, mask):
    path = tmp_path / "a.txt"
    for content in ("new", "replaced"):
        before = os.umask(mask)
        try:
            with whole_file(path) as place:
                Path(place).write_text(content)
        finally:
            os.umask(before)
        assert path.read_text() == content
        assert path.stat().st_mode & 0o777 == 0o666 & ~mask


def test_check_leaves_nothing(kind, tmp_path):
    check_writable(tmp_path / "a.exr")
    assert os.listdir(tmp_path) == []


def test_where_no_file_can_be_the_path_and_the_reason_are_told(tmp_path):
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.exr").mkdir()
    places = [
        (tmp_path / "nowhere" / "a.exr", "nowhere' does not exist; create it"),
        (tmp_path / "folder.exr", "it is a folder; name a file"),
        (tmp_path / "file" / "a.exr", "file' is no folder"),
        (tmp_path / "file" / "deeper" / "a.exr", "Not a directory"),
        (tmp_path / f"{'a' * 300}.exr", "name too long"),
    ]
    if sys.platform == "linux":
        os.mkfifo(tmp_path / "pipe.exr")
        (tmp_path / "loop.exr").symlink_to("loop.exr")
        (tmp_path / "dangling.exr").symlink_to(tmp_path / "gone" / "a.exr")
        places += [
            (Path("/proc/a.exr"), "no file can be made in '/proc'; choose another folder"),
            (Path("/sys/a.exr"), "Permission denied"),
            (tmp_path / "pipe.exr", "a device or a pipe; name a plain file"),
            (tmp_path / "loop.exr", "a link that leads to itself"),
            (tmp_path / "dangling.exr", "gone' does not exist"),
        ]
    before = sorted(tmp_path.iterdir())
    for path, told in places:
        for use in (check_writable, lambda place: whole_file(place).__enter__()):
            with pytest.raises(OutputError) as caught:
                use(path)
            line = str(caught.value)
            assert line.startswith(f"cannot write '{path}': ") and told in line, line
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.skipif(sys.platform == "win32", reason="links of POSIX")
def test_a_link_stays_one_and_the_file_behind_it_is_written(kind, tmp_path):
    (tmp_path / "real").mkdir()
    link = tmp_path / "a.txt"
    link.symlink_to(tmp_path / "real" / "b.txt")
    for content in ("new", "replaced"):
        with whole_file(link) as place:
            Path(place).write_text(content)
        assert link.is_symlink() and (tmp_path / "real" / "b.txt").read_text() == content


def test_a_name_as_long_as_can_be_is_written_and_replaced(kind, tmp_path):
    path = tmp_path / ("a" * 251 + ".txt")
    for content in ("new", "replaced"):
        with whole_file(path) as place:
            Path(place).write_text(content)
        assert path.read_text() == content


def test_a_disk_that_is_full_leaves_nothing_and_is_told(kind, tmp_path):
    path = tmp_path / "a.txt"
    with pytest.raises(UnfinishedFileError) as caught, whole_file(path) as place:
        Path(place).write_text("half")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    assert f"'{path}'" in str(caught.value) and "No space left" in str(caught.value)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGKILL])
@pytest.mark.parametrize("writer", ["_NamelessFile", "_NamedFile"])
def test_killed_writer_leaves_nothing(writer, number, tmp_path):
    if writer == "_NamedFile" and number == signal.SIGKILL:
        pytest.skip("only nameless files survive what no program can answer")
    code = f"""
import sys, time
sys.path.insert(0, {str(REPOSITORY)!r})
from addon.files import whole_file as module
module._open = module.{writer}
with module.removed_on_signals(), module.whole_file({str(tmp_path / "a.exr")!r}) as place:
    with open(place, "wb") as file:
        file.write(bytes(100000))
        file.flush()
        print("half", flush=True)
        time.sleep(30)
"""
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    with process.stdout:
        assert process.stdout.readline() == b"half\n"
        process.send_signal(number)
        assert process.wait(10) == -number
    for _ in range(50):
        if os.listdir(tmp_path) == []:
            break
        time.sleep(0.02)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("told", "reason"),
    [
        (
            'Failed to write pixel data to image file "/proc/self/fd/13". No space left on device.',
            "Failed to write pixel data No space left on device",
        ),
        ("No space left", "No space left"),
        ("", "RuntimeError"),
    ],
)
def test_reasons_do_not_name_the_hidden_file(told, reason):
    assert reason_of(RuntimeError(told)) == reason
