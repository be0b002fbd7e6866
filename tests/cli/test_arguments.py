"""The words of the command line, without Blender."""

import pytest

from addon.cli.arguments import parse
from addon.errors import InputError

RENDER = ["render", "x.blend"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "no command"),
        (["paint"], "invalid choice"),
        (["render"], "SCENE.blend"),
        ([*RENDER, "--sharpness", "3"], "--sharpness"),
        ([*RENDER, "--sample", "3"], "--sample"),
        ([*RENDER, "-o", "out.jpg"], "must end in .exr or .png"),
        ([*RENDER, "-o", "out"], "must end in .exr or .png"),
        ([*RENDER, "-o", "a.png", "-o", "a.png"], "twice"),
        ([*RENDER, "--frame", "one"], "not a whole number"),
        ([*RENDER, "--frame", "99999999"], "not between"),
        ([*RENDER, "--frames", "5"], "FIRST..LAST"),
        ([*RENDER, "--frames", "1-5"], "FIRST..LAST"),
        ([*RENDER, "--frames", "5..1"], "comes after"),
        ([*RENDER, "--frames", "1..99999999"], "not between"),
        ([*RENDER, "--frame", "1", "--frames", "1..2"], "not allowed with"),
        ([*RENDER, "-o", "a.png", "--frames", "1..2"], "####"),
        ([*RENDER, "--resolution", "0x0"], "each side"),
        ([*RENDER, "--resolution", "1920"], "WIDTHxHEIGHT"),
        ([*RENDER, "--resolution=-4x4"], "WIDTHxHEIGHT"),
        ([*RENDER, "--resolution", "100000x100"], "each side"),
        ([*RENDER, "--samples", "0"], "not between"),
        ([*RENDER, "--samples", "-3"], "not between"),
        ([*RENDER, "--samples", "1e3"], "not a whole number"),
        ([*RENDER, "--samples", "99999999999"], "not between"),
        ([*RENDER, "--seed", "-1"], "not between"),
        ([*RENDER, "--filter", "gauss"], "invalid choice"),
        ([*RENDER, "--filter-size", "0"], "greater than 0"),
        ([*RENDER, "--filter-size", "nan"], "greater than 0"),
        ([*RENDER, "--filter-size", "9999"], "at most"),
        ([*RENDER, "--fstop", "0"], "greater than 0"),
        ([*RENDER, "--fstop", "-2"], "greater than 0"),
        ([*RENDER, "--fstop", "inf"], "greater than 0"),
        ([*RENDER, "--focus", "0"], "focus distance 0 must be greater than 0"),
        ([*RENDER, "--focus", "-1"], "greater than 0"),
        ([*RENDER, "--focus", "nan"], "greater than 0"),
        ([*RENDER, "--method", "magic"], "invalid choice"),
        (["bench", "--samples", "0"], "not between"),
    ],
)
def test_unusable_words_are_refused_and_named(words, told):
    with pytest.raises(InputError) as caught:
        parse(words)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "words",
    [
        ["lens", "list"],
        ["lens", "trace", "x", "--json"],
        ["capture", "x.blend", "-o", "y.exr"],
        ["refocus", "y.exr", "-o", "z.exr"],
        [*RENDER, "--method", "adaptive"],
        [*RENDER, "--method", "layered"],
        [*RENDER, "--lens", "tessar"],
        [*RENDER, "--subsamples", "4"],
        [*RENDER, "--layers", "8"],
    ],
)
def test_what_is_not_built_yet_names_what_brings_it(words):
    with pytest.raises(InputError, match=r"is not in version .*; it comes later, with \w+ \w+"):
        parse(words)


def test_all_words_of_render_are_understood():
    arguments = parse(
        [
            *RENDER,
            *("-o", "a_####.exr", "-o", "a_####.PNG", "--frames", "-2..3", "--camera", "C"),
            *("--resolution", "64x48", "--method", "reference", "--samples", "9", "--seed", "3"),
            *("--filter", "box", "--filter-size", "1.5", "--no-bokeh", "--no-chromatic"),
            *("--fstop", "1.4", "--focus", "2.5", "--stats", "s.json", "--json"),
        ]
    )
    assert arguments.frames == (-2, 3)
    assert arguments.resolution == (64, 48)
    assert arguments.focus == 2.5
    assert arguments.fstop == 1.4
    assert [path.name for path in arguments.output] == ["a_####.exr", "a_####.PNG"]


def test_focus_may_be_an_object():
    assert parse([*RENDER, "--focus", "Head"]).focus == "Head"


@pytest.mark.parametrize("words", [["--help"], ["render", "--help"], ["bench", "--help"]])
def test_help_is_printed(words, capsys):
    with pytest.raises(SystemExit) as ended:
        parse(words)
    assert ended.value.code == 0
    assert "usage: aplanat" in capsys.readouterr().out


def test_help_promises_only_what_is_built(capsys):
    with pytest.raises(SystemExit):
        parse(["--help"])
    text = capsys.readouterr().out
    assert "render" in text and "bench" in text
    assert "capture" not in text and "refocus" not in text


def test_version_is_the_manifests(capsys):
    from addon.cli.version import version

    with pytest.raises(SystemExit):
        parse(["--version"])
    assert capsys.readouterr().out.strip() == f"aplanat {version()}"
