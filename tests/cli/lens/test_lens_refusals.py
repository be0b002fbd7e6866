"""What `aplanat lens` cannot use: one line for each finding, exit code 2, no file left."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from addon.cli.command import main

REPOSITORY = Path(__file__).resolve().parents[3]

BROKEN = """
format = "lens-description"
format_version = 1
[lens]
name = "Two errors"
focal_length_mm = -50.0
f_number = 2.0
half_field_deg = 20.0
[[surface]]
radius_mm = 0.0
thickness_mm = 5.0
semi_diameter_mm = 5.0
material = "N-BK7"
[[surface]]
radius_mm = inf
thickness_mm = 5.0
semi_diameter_mm = 5.0
material = "air"
stop = true
"""


@pytest.fixture
def refused(capfd, tmp_path):
    """Run a command that must be refused; return its lines and the object of --json."""

    def run(*words):
        before = set(tmp_path.rglob("*"))
        capfd.readouterr()
        assert main([*map(str, words)]) == 2
        out, err = capfd.readouterr()
        lines = err.splitlines()
        assert all(line.startswith("aplanat: ") for line in lines), err
        assert set(tmp_path.rglob("*")) == before
        return lines, json.loads(out) if "--json" in words else out

    return run


@pytest.fixture
def broken(tmp_path):
    path = tmp_path / "broken.toml"
    path.write_text(BROKEN)
    return path


@pytest.mark.parametrize(
    "words",
    [
        ("info", "LENS"),
        ("trace", "LENS", "--field-deg", "0"),
        ("bake", "LENS", "-o", "OUT.exr"),
        ("plot", "LENS", "-o", "OUT.png"),
    ],
    ids=lambda words: words[0],
)
def test_every_error_of_a_lens_file_is_told(refused, broken, words):
    words = [
        word.replace("LENS", str(broken)).replace("OUT", str(broken.parent / "out"))
        for word in words
    ]
    lines, answer = refused("lens", *words, "--json")
    assert [error["code"] for error in answer["errors"]] == ["E09", "E13"]
    assert {tuple(error) for error in answer["errors"]} == {("code", "path", "message")}
    assert answer["errors"][0]["path"] == "lens.focal_length_mm"
    assert answer["warnings"] == []
    assert len(lines) == 2
    assert "broken.toml: E09 lens.focal_length_mm: " in lines[0]


def test_unknown_lens_names_near_ones(refused):
    lines, answer = refused("lens", "info", "tesar-50mm", "--json")
    assert len(lines) == 1 and "tessar-50mm-f2.8" in lines[0]
    assert answer["errors"][0]["code"] == "E01"


def test_missing_file_is_told(refused, tmp_path):
    lines, answer = refused("lens", "info", tmp_path / "none.toml", "--json")
    assert len(lines) == 1 and "none.toml" in lines[0]
    assert [error["code"] for error in answer["errors"]] == ["E01"]


def test_unknown_zoom_position_names_those_there_are(refused):
    lines, out = refused("lens", "info", "zoom-36-69mm-f3.5", "--zoom", "40 mm")
    assert len(lines) == 1 and "'36 mm', '50 mm', '69 mm'" in lines[0]
    assert out == ""


def test_wavelength_that_a_glass_does_not_pass_is_told(refused, tmp_path):
    # Its series makes the squared index negative in the infrared.
    text = BROKEN.replace("-50.0", "50.0").replace("radius_mm = 0.0", "radius_mm = 25.0")
    series = "material = { series_um = [2.3, -0.5, 0.0, 0.0, 0.0, 0.0] }"
    path = tmp_path / "infrared.toml"
    path.write_text(text.replace('material = "N-BK7"', series))
    lines, _ = refused("lens", "info", path, "--wavelength", "2500")
    assert len(lines) == 1 and "2500 nm" in lines[0] and "surface 1" in lines[0]


@pytest.mark.parametrize("where", ["{tmp}/none/{}", "{tmp}/file/{}", "{tmp}/{}", "/proc/{}"])
@pytest.mark.parametrize(
    "words", [("bake", "out.exr"), ("plot", "out.png"), ("import", "out.toml")]
)
def test_where_no_file_can_be_path_and_reason_are_told_before_work(refused, tmp_path, words, where):
    word, name = words
    (tmp_path / "file").write_text("")
    (tmp_path / name).mkdir()
    path = where.format(name, tmp=tmp_path)
    lines, _ = refused("lens", word, "tessar-50mm-f2.8", "-o", path)
    assert len(lines) == 1 and lines[0].startswith(f"aplanat: cannot write '{path}': ")


def test_lens_with_cylinders_has_no_table(refused, tmp_path):
    lines, answer = refused(
        "lens", "bake", "anamorphic-60mm-f2", "-o", tmp_path / "out.exr", "--json"
    )
    assert len(lines) == 1 and "cylinders" in lines[0]
    assert set(answer["errors"][0]) == {"code", "path", "message"}


def test_ambiguous_foreign_file_names_the_option(refused, tmp_path):
    path = tmp_path / "open.dat"
    # Neither end is 0: the thickness may be the gap before or after its row.
    path.write_text("30 5 1.5 20\n-30 5 1.0 20\n0 5 0 10\n")
    lines, answer = refused("lens", "import", path, "-o", tmp_path / "out.toml", "--json")
    assert [error["code"] for error in answer["errors"]] == ["I06"]
    assert "--thickness" in lines[0]
    lines, _ = refused("lens", "info", path)
    assert "aplanat lens import" in lines[0]


def test_import_makes_a_lens_file_that_loads(tmp_path, shared, capfd):
    source = shared / "lenses/import-samples/dgauss.50mm.dat"
    out = tmp_path / "out.toml"
    assert main(["lens", "import", str(source), "-o", str(out), "--json"]) == 0
    answer = json.loads(capfd.readouterr().out)
    assert answer["files"] == [str(out)]
    assert main(["lens", "info", str(out), "--json"]) == 0
    ours = json.loads(capfd.readouterr().out)
    # Read directly it is the same lens.
    assert main(["lens", "info", str(source), "--json"]) == 0
    theirs = json.loads(capfd.readouterr().out)
    assert ours["efl_mm"] == theirs["efl_mm"]


def run_process(code, folder):
    environment = os.environ | {"PYTHONPATH": str(REPOSITORY), "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(
        [sys.executable, "-P", "-W", "error", "-c", code],
        env=environment,
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
    )


def test_a_lens_is_told_without_blender_or_heavy_libraries(tmp_path):
    (tmp_path / "here.toml").write_bytes(
        (REPOSITORY / "lens_profiles/tessar-50mm-f2.8.toml").read_bytes()
    )
    code = (
        "import sys\n"
        "from addon.cli.command import main\n"
        # A relative name starts where the caller is.
        "assert main(['lens', 'info', 'here.toml', '--json']) == 0\n"
        "assert main(['lens', 'trace', 'here.toml', '--field-deg', '5', '--grid', '33']) == 0\n"
        "heavy = {'bpy', 'gpu', 'colour', 'matplotlib', 'OpenEXR', 'scipy', 'PIL'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
    )
    done = run_process(code, tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[0])["name"]
    assert done.stderr == ""


def test_names_that_are_no_text_are_told_as_json(refused):
    # As Python hands over bytes of a command line that are not UTF-8.
    lines, answer = refused("lens", "info", "tessar-50mm-f2.8", "--zoom", "\udcff", "--json")
    assert len(lines) == 1
    assert "\udcff" in answer["errors"][0]["message"]


def test_a_reader_that_leaves_early_is_no_failure():
    words = [sys.executable, "-P", "-m", "addon.cli", "lens", "list"]
    process = subprocess.Popen(
        words,
        env=os.environ | {"PYTHONPATH": str(REPOSITORY), "PYTHONDONTWRITEBYTECODE": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    process.stdout.close()
    with process.stderr:
        told = process.stderr.read()
    assert (process.wait(60), told) == (0, b"")
