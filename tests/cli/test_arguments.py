"""The words of the command line, without Blender."""

import pytest

from addon.cli.arguments import parse
from addon.errors import InputError

RENDER = ["render", "x.blend"]
CAPTURE = ["capture", "x.blend", "-o", "y.exr"]
INFO = ["lens", "info", "x"]
TRACE = ["lens", "trace", "x"]
FAN = [*TRACE, "--object-to-first-vertex-mm", "1000"]


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
        ([*RENDER, "--frames", "five"], "FIRST..LAST"),
        ([*RENDER, "--frames", "1-5,"], "FIRST..LAST"),
        ([*RENDER, "--frames", "1-5:0"], "not between"),
        ([*RENDER, "--frames", "9-5"], "comes after"),
        ([*RENDER, "--frames", "1-5", "--frame-step", "2"], "steps of its own"),
        ([*RENDER, "--frames", "1-5", "-o", "a.png"], "####"),
        ([*RENDER, "--options", "--lens 'mine"], "no closing quotation"),
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
        ([*CAPTURE[:2]], "-o"),
        ([*CAPTURE[:2], "-o", "a.png"], "must end in .exr"),
        ([*CAPTURE, "--engine", "WORKBENCH"], "invalid choice"),
        ([*CAPTURE, "--layers", "0"], "not between"),
        ([*CAPTURE, "--layers", "65"], "not between"),
        ([*CAPTURE, "--overscan", "1.5"], "not between"),
        ([*CAPTURE, "--overscan", "nan"], "not between"),
        ([*CAPTURE, "--frames", "1..3"], "####"),
        ([*CAPTURE, "--frame-step", "2"], "--frames"),
        (["bench", "--scene", "toys"], "scripts/aplanat bench"),
        (["lens"], "COMMAND"),
        (["lens", "grind"], "invalid choice"),
        ([*INFO[:2]], "LENS"),
        ([*INFO, "--wavelength", "violet"], "not a number"),
        ([*INFO, "--wavelength", "0"], "not between"),
        ([*INFO, "--wavelength", "nan"], "not between"),
        ([*INFO, "--zoom"], "--zoom"),
        (TRACE, "--object-to-first-vertex-mm --field-deg is required"),
        ([*TRACE, "--object-to-first-vertex-mm", "1", "--field-deg", "1"], "not allowed with"),
        ([*TRACE, "--object-to-first-vertex-mm", "0"], "greater than 0"),
        ([*TRACE, "--object-to-first-vertex-mm", "inf"], "greater than 0"),
        ([*TRACE, "--field-deg", "90"], "not between"),
        ([*TRACE, "--field-deg", "1", "--rho", "0,1"], "--rho belongs to"),
        ([*TRACE, "--field-deg", "1", "--planes-mm", "1"], "--planes-mm belongs to"),
        ([*TRACE, "--field-deg", "1", "--grid", "2"], "not between"),
        ([*FAN, "--grid", "9"], "--grid belongs to"),
        ([*FAN, "--rho", "0,one"], "not a number"),
        ([*FAN, "--rho", ""], "not a number"),
        ([*FAN, "--rho", "0,..,1"], "FIRST,SECOND,..,LAST"),
        ([*FAN, "--rho", "0,0.3,..,1"], "do not lead"),
        ([*FAN, "--rho", "0,0,..,1"], "do not lead"),
        ([*FAN, "--rho", "0,1e-9,..,1"], "at most"),
        ([*FAN, "--rho", "nan"], "not between"),
        (["lens", "bake", "x"], "-o/--output"),
        (["lens", "bake", "x", "-o", "x.png"], "must end in .exr"),
        (["lens", "plot", "x", "-o", "x.jpg"], "must end in .png, .svg or .pdf"),
        (["lens", "plot", "x", "-o", "x.png", "--size", "9x9"], "each side"),
        (["lens", "import", "x.dat", "-o", "x.dat"], "must end in .toml"),
        (["lens", "import", "x.dat", "-o", "x.toml", "--glass", "BK7"], "NAME=ND,VD"),
        (["lens", "import", "x.dat", "-o", "x.toml", "--stop", "0"], "not between"),
    ],
)
def test_unusable_words_are_refused_and_named(words, told):
    with pytest.raises(InputError) as caught:
        parse(words)
    assert told in str(caught.value)
    assert "\n" not in str(caught.value)


def test_subsamples_belong_to_the_adaptive_method():
    arguments = parse([*RENDER, "--method", "adaptive", "--samples", "32", "--subsamples", "4"])
    assert (arguments.method, arguments.samples, arguments.subsamples) == ("adaptive", 32, 4)
    with pytest.raises(InputError, match="the reference method has none"):
        parse([*RENDER, "--method", "reference", "--subsamples", "4"])


def test_all_words_of_render_are_understood():
    arguments = parse(
        [
            *RENDER,
            *("-o", "a_####.exr", "-o", "a_####.PNG", "--frames", "-2..3", "--camera", "C"),
            *("--resolution", "64x48", "--method", "reference", "--samples", "9", "--seed", "3"),
            *("--filter", "box", "--filter-size", "1.5", "--no-bokeh", "--no-chromatic"),
            *("--fstop", "1.4", "--focus", "2.5", "--stats", "s.json", "--json"),
            *("--distortion", "lens"),
        ]
    )
    assert list(arguments.frames.numbers(2)) == [-2, 0, 2]
    assert arguments.resolution == (64, 48)
    assert arguments.focus == 2.5
    assert arguments.fstop == 1.4
    assert arguments.distortion == "lens"
    assert [path.name for path in arguments.output] == ["a_####.exr", "a_####.PNG"]


@pytest.mark.parametrize(
    ("text", "frames"),
    [
        ("5", [5]),
        ("7-7", [7]),
        ("1-5", [1, 2, 3, 4, 5]),
        ("1-10:3", [1, 4, 7, 10]),
        ("-5--3", [-5, -4, -3]),
        ("20, 10-12", [10, 11, 12, 20]),
        ("1..3,8", [1, 2, 3, 8]),
    ],
)
def test_a_list_of_frames_is_exactly_those_frames(text, frames):
    # As Open Job Description and Flamenco write chunks; a scene's own step skips none of them.
    assert list(parse([*RENDER, "--frames", text]).frames.numbers(2)) == frames


def test_one_word_may_bring_further_options():
    options = "--strict --lens 'my lens.toml' --level-bias -1"
    arguments = parse([*RENDER, "--options", options, "--seed", "3"])
    assert (arguments.strict, arguments.lens, arguments.seed) == (True, "my lens.toml", 3)
    assert arguments.level_bias == -1.0
    assert parse([*RENDER, "--options="]).strict is False


def test_focus_may_be_an_object():
    assert parse([*RENDER, "--focus", "Head"]).focus == "Head"


def test_lists_of_numbers_may_be_negative_or_a_progression():
    arguments = parse([*FAN, "--rho", "0,0.05,..,1", "--planes-mm", "-1,2.5"])
    assert arguments.rho == pytest.approx([i / 20 for i in range(21)], abs=1e-15)
    assert arguments.planes_mm == (-1.0, 2.5)
    assert parse([*FAN, "--rho", "-1,-0.5,..,1"]).rho == (-1.0, -0.5, 0.0, 0.5, 1.0)


@pytest.mark.parametrize(
    "words",
    [
        ["--help"],
        ["render", "--help"],
        ["capture", "--help"],
        ["refocus", "--help"],
        ["capture", "--help"],
        ["lens", "--help"],
        *(["lens", word, "--help"] for word in ("list", "info", "trace", "bake", "plot", "import")),
    ],
)
def test_help_is_printed(words, capsys):
    with pytest.raises(SystemExit) as ended:
        parse(words)
    assert ended.value.code == 0
    assert "usage: aplanat" in capsys.readouterr().out


def test_help_lists_every_command(capsys):
    with pytest.raises(SystemExit):
        parse(["--help"])
    text = capsys.readouterr().out
    assert all(word in text for word in ("render", "capture", "refocus", "lens", "bench"))


def test_version_is_the_manifests(capsys):
    from addon.files.version import version

    with pytest.raises(SystemExit):
        parse(["--version"])
    assert capsys.readouterr().out.strip() == f"aplanat {version()}"


def test_aberrations_are_told_apart_by_their_names_and_bounded():
    words = ["render", "a.blend", "-o", "a.png", "--aberration", "field-curvature=-2"]
    found = parse([*words, "--aberration", "swirl=0.5"])
    assert found.aberration == [("field_curvature", -2.0), ("swirl", 0.5)]
    for wrong in ("blur=1", "swirl=2", "coma=much", "coma"):
        with pytest.raises(InputError, match="aberration"):
            parse([*words[:4], "--aberration", wrong])
