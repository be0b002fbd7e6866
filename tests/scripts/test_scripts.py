"""The scripts of the checkout, as a person calls them."""

import subprocess
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]
SCRIPTS = ["aplanat", "bench-tracer", "build", "demo", "get-blender", "test", "zoo"]


def run(script, *arguments, cwd=REPO):
    return subprocess.run(
        [REPO / "scripts" / script, *map(str, arguments)],
        cwd=cwd,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=600,
    )


@pytest.mark.parametrize("script", SCRIPTS)
def test_help_explains_usage(script):
    done = run(script, "--help")
    assert done.returncode == 0
    assert done.stdout.lower().startswith("usage:")


@pytest.mark.parametrize("script", ["aplanat", "bench-tracer", "build", "get-blender", "zoo"])
def test_unknown_option_is_refused(script):
    done = run(script, "--no-such-option")
    assert done.returncode == 2
    assert done.stderr


def test_file_names_start_at_the_callers_folder(tmp_path):
    done = run("aplanat", "render", "no-such-file.blend", cwd=tmp_path)
    assert done.returncode == 2
    assert "no-such-file.blend" in done.stderr


def test_check_prints_nothing_where_there_is_no_blender(tmp_path):
    done = run("get-blender", "--check", "--cache", tmp_path / "nothing")
    assert done.returncode == 1
    assert done.stdout == ""
    assert not (tmp_path / "nothing").exists()


@pytest.mark.slow
def test_demo_writes_pictures_and_statistics(tmp_path):
    done = run("demo", "--folder", tmp_path, "--samples", 2, "--resolution", "96x54")
    assert done.returncode == 0, done.stderr
    for name in ("demo.blend", "demo.exr", "demo.png", "demo.json"):
        assert (tmp_path / name).stat().st_size > 0
