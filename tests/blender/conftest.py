"""A real Blender with the built extension installed, in background and in a window."""

import subprocess
from pathlib import Path

import pytest

from benchmarks.tools.real_blender import Blender, stop

REPO = Path(__file__).resolve().parents[2]


def pytest_collection_modifyitems(items):
    here = Path(__file__).parent
    for item in items:
        if here in item.path.parents:
            item.add_marker("blender")


@pytest.fixture(scope="session")
def extension_zip(tmp_path_factory):
    """Build the extension for this platform once per session."""
    out = tmp_path_factory.mktemp("extension")
    done = subprocess.run(
        [REPO / "scripts/build", "--current", "-o", out], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return Path(done.stdout.split()[-1])


@pytest.fixture(scope="session")
def bare_blender(tmp_path_factory):
    """Return a real Blender with an empty user folder, or skip."""
    done = subprocess.run(
        ["bash", "-c", 'source "$1/scripts/environment.sh" && find_blender', "-", REPO],
        capture_output=True,
        text=True,
    )
    if done.returncode != 0:
        pytest.skip(f"no real Blender 5.2 (scripts/get-blender makes one) {done.stderr.strip()}")
    return Blender(done.stdout.strip(), tmp_path_factory.mktemp("blender-user"))


@pytest.fixture(scope="session")
def blender(bare_blender, extension_zip):
    """Return a real Blender with Aplanat installed and enabled."""
    bare_blender.run(
        "--command", "extension", "install-file", "-r", "user_default", "--enable", extension_zip
    )
    return bare_blender


@pytest.fixture(scope="session")
def display(bare_blender):
    """Start an X server with software OpenGL; return its name for DISPLAY."""
    server = subprocess.Popen(
        bare_blender.tool(
            "Xvfb", "-displayfd", "1", "-screen", "0", "1280x800x24", "+extension", "GLX"
        ),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    with server.stdout:
        number = server.stdout.readline().strip()
        assert number, "Xvfb did not start"
        yield f":{number}"
        stop(server)


@pytest.fixture
def window(blender, display, tmp_path):
    """Open Blender with Aplanat in a window for one test."""
    with blender.window(display, folder=tmp_path / "window") as window:
        yield window
