"""Bytes to a TOML document: what cannot be read is said, and nothing takes long."""

import os
import time

import pytest

from addon.errors import LensFileError
from addon.lens_io.toml.toml_reader import parse_lens, read_lens
from tests.lens_io.lens_texts import SINGLET

# Small files take milliseconds; a file of the largest size may take this long. Processor time is
# measured, so that what else a machine does is not counted.
LONGEST_S = 2.0


def refusal(content):
    with pytest.raises(LensFileError) as caught:
        parse_lens(content, "test.toml")
    (found,) = caught.value.findings
    assert found.path == ""
    return found.code, found.message


def unreadable(path):
    with pytest.raises(LensFileError) as caught:
        read_lens(path)
    (found,) = caught.value.findings
    assert (found.code, found.path, caught.value.file_name) == ("E01", "", str(path))
    return found.message


def test_a_file_is_read_and_its_path_kept(tmp_path):
    path = tmp_path / "singlet.toml"
    path.write_text(SINGLET)
    assert read_lens(path).path == path
    assert read_lens(str(path)).prescription.name == "Singlet"


def test_files_that_cannot_be_read_say_why(tmp_path):
    assert "no such file" in unreadable(tmp_path / "missing.toml")
    assert "folder" in unreadable(tmp_path)
    assert "name" in unreadable("a\0b.toml")
    assert "too long" in unreadable(tmp_path / ("x" * 5000))


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_pipe_is_refused_rather_than_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    assert "regular file" in unreadable(tmp_path / "pipe.toml")


def test_content_that_is_not_utf8_is_refused():
    assert refusal(SINGLET.encode("utf-16"))[0] == "E01"
    code, message = refusal(SINGLET.encode() + b"\n# caf\xe9\n")
    assert code == "E01"
    assert "0xe9" in message


def test_one_mebibyte_is_allowed_and_not_a_byte_more(tmp_path):
    comment = b"#" * ((1 << 20) - len(SINGLET.encode()))
    assert parse_lens(SINGLET.encode() + comment, "test.toml").prescription
    code, message = refusal(SINGLET.encode() + comment + b"#")
    assert code == "E01"
    assert "1 MiB" in message
    path = tmp_path / "large.toml"
    path.write_bytes(b"\xff" * (5 << 20))
    assert "1 MiB" in unreadable(path)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("a = \n", "line 1, column 5"),
        ("a = 1\r\nb = 1\r\nc = = 2\r\n", "line 3, column 5"),
        ("a = 1\nb", "line 2, column 2"),
        ('a = """\n x', "line 2, column 3"),
        ("a = 1\na = 2", "line 2, column 6"),
        ("a = [" * 50, "line 1, column"),
        ("a = 1\nb = " + "[" * 3000 + "]" * 3000, "line 2, column 45"),
        ("b = " + "{a = " * 3000, "line 1, column"),
        ("a." * 30_000 + "a = 1", "line 1, column 1"),
        ("[x]\n" + '"a" . ' * 30_000 + "a = 1", "line 2, column 1"),
        ("a = 1\nb = -" + "1" * 5000, "line 2, column 5"),
        ("\0", "line 1, column 1"),
    ],
)
def test_what_is_not_toml_is_refused_with_line_and_column(text, place):
    code, message = refusal(text.encode())
    assert code == "E02"
    assert place in message


@pytest.mark.parametrize(
    "text",
    [
        '"""' + '\\"""' * 200_000,
        "'''" + "''" * 400_000,
        "a = [" + "[]," * 300_000 + "]",
        "x" * 1_000_000,
        "a" + " " * 1_000_000,
        ("a" + " " * 50) * 20_000,
        '"' * 1_000_000,
        "a = " + "1_" * 400_000,
        "[[surface]]\n" * 80_000,
        "".join(f"{'a.' * 18}b{i} = 1\n" for i in range(20_000)),
        "".join(f"surfaca{i} = 1\n" for i in range(60_000)),
        "[[surface]]\nmaterial = {" + ",".join(f"ne{i} = 1" for i in range(80_000)) + "}",
        "".join(f'[[surface]]\nid = "{i}"\n' for i in range(20_000))
        + "[[zoom]]\nthickness_mm = {"
        + ",".join(f"x{i} = 1" for i in range(40_000))
        + "}",
        "[[surface]]\n[surface.asphere]\n" + "".join(f"a{i}_per = 1\n" for i in range(60_000)),
        '[[surface]]\nmaterial = "' + "N-BK" * 200_000 + '"',
    ],
    ids=lambda text: text[:20].strip(),
)
def test_files_made_to_exhaust_a_parser_are_refused_in_time(text):
    start = time.process_time()
    with pytest.raises(LensFileError):
        parse_lens(text.encode(), "test.toml")
    assert time.process_time() - start < LONGEST_S


def test_dots_and_brackets_in_texts_and_comments_are_no_nesting():
    text = SINGLET.replace('"Singlet"', '"""' + "a." * 50 + "[" * 100 + '"""')
    text = text.replace("[lens]", "# " + "[" * 100 + "a." * 100 + "\n[lens]")
    assert len(parse_lens(text.encode(), "test.toml").prescription.name) == 200
