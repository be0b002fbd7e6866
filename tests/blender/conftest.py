"""A real Blender with the built extension installed, in background and in a window."""

import itertools
import json
import os
import shutil
import signal
import subprocess
import textwrap
import time
from contextlib import contextmanager
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]

# Runs inside Blender: executes the files that a test drops into a folder, one by one.
MAILBOX = """
import json, pathlib, traceback
import bpy

mailbox = pathlib.Path({mailbox!r})
namespace = {{"bpy": bpy}}

def read_mail():
    for letter in sorted(mailbox.glob("*.py")):
        namespace["result"] = None
        try:
            exec(compile(letter.read_text(), letter.name, "exec"), namespace)
            answer = {{"result": namespace["result"]}}
        except BaseException:
            answer = {{"error": traceback.format_exc()}}
        letter.unlink()
        part = letter.with_suffix(".part")
        part.write_text(json.dumps(answer))
        part.rename(letter.with_suffix(".json"))
    return 0.02

bpy.context.preferences.view.show_splash = False
bpy.app.timers.register(read_mail, first_interval=0.5, persistent=True)
"""


def pytest_collection_modifyitems(items):
    here = Path(__file__).parent
    for item in items:
        if here in item.path.parents:
            item.add_marker("blender")


class Blender:
    """Runs Blender with its own user folder; `tool` runs X programs where Blender runs."""

    def __init__(self, path, resources):
        self.path = str(path)
        self.resources = Path(resources)
        self.env = os.environ | {
            "BLENDER_USER_RESOURCES": str(self.resources),
            "LIBGL_ALWAYS_SOFTWARE": "1",
            # Where the checkout lies in a system folder, the private Blender still sees it.
            "APLANAT_BIND": str(REPO),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        self._root = Path(self.path).resolve().with_name("in-blender-root")

    def tool(self, *words):
        """Return the command line of an X program: in Blender's private root, or on PATH."""
        if self._root.exists():
            return [str(self._root), *words]
        if shutil.which(words[0]) is None:
            pytest.skip(f"window tests need {words[0]} on PATH, or scripts/get-blender's Blender")
        return list(words)

    def run(self, *arguments, check=True, timeout=300, env=()):
        """Run `blender -b ARGUMENTS` and return the completed process."""
        done = subprocess.run(
            [self.path, "-b", *map(str, arguments)],
            env=self.env | dict(env),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=timeout,
        )
        if check and done.returncode != 0:
            pytest.fail(
                f"blender {arguments} exited with {done.returncode}\n{done.stdout}{done.stderr}"
            )
        return done

    def run_code(self, code, *arguments, blend=None, options=(), check=True, timeout=300, env=()):
        """Run Python code in the background; it finds ARGUMENTS after `--` in `sys.argv`.

        Other options of Blender (`--gpu-backend vulkan`) go in `options`. What the code leaves in
        the global `result` comes back as `.result` (through JSON).
        """
        folder = self.resources / "scripts_of_tests"
        folder.mkdir(exist_ok=True)
        stem = folder / f"{time.monotonic_ns()}"
        answer = stem.with_suffix(".json")
        script = stem.with_suffix(".py")
        script.write_text(
            "result = None\n"
            + textwrap.dedent(code)
            + f"\nimport json; open({str(answer)!r}, 'w').write(json.dumps(result))\n"
        )
        done = self.run(
            *options,
            *([blend] if blend else []),
            "--python-exit-code",
            "1",
            "--python",
            script,
            "--",
            *arguments,
            check=check,
            timeout=timeout,
            env=env,
        )
        done.result = json.loads(answer.read_text()) if answer.exists() else None
        return done

    @contextmanager
    def window(self, display, *arguments, folder, env=()):
        """Open Blender in a window on an X display, for the length of a `with` block."""
        mailbox = Path(folder) / "mailbox"
        mailbox.mkdir(parents=True)
        startup = mailbox.with_suffix(".py")
        startup.write_text(MAILBOX.format(mailbox=str(mailbox)))
        log = mailbox.with_suffix(".log")
        with log.open("w") as out:
            process = subprocess.Popen(
                [
                    self.path,
                    *("--window-geometry", "0", "0", "1280", "800"),
                    *map(str, arguments),
                    *("--python", str(startup)),
                ],
                env=self.env | {"DISPLAY": display} | dict(env),
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=subprocess.STDOUT,
            )
            window = Window(self, display, process, mailbox, log)
            try:
                window.run("result = bpy.app.version_string", timeout=120)
                yield window
            finally:
                stop(process)


class Window:
    """A Blender in a window: runs code in it, presses keys, takes screenshots."""

    def __init__(self, blender, display, process, mailbox, log):
        self.process = process
        self.log = log
        self._blender = blender
        self._display = display
        self._mailbox = mailbox
        self._numbers = itertools.count()

    def run(self, code, timeout=60):
        """Run Python code in Blender's main thread; return what it left in `result`.

        Names persist from call to call. Use `bpy.context.temp_override` to choose an area.
        """
        letter = self._mailbox / f"{next(self._numbers):06}.py"
        part = letter.with_suffix(".new")
        part.write_text(textwrap.dedent(code))
        part.rename(letter)
        answer = letter.with_suffix(".json")
        end = time.monotonic() + timeout
        while not answer.exists():
            if self.process.poll() is not None:
                pytest.fail(f"Blender ended ({self.process.returncode}):\n{self.log.read_text()}")
            if time.monotonic() > end:
                pytest.fail(f"Blender did not answer in {timeout} s:\n{self.log.read_text()}")
            time.sleep(0.01)
        answer = json.loads(answer.read_text())
        if "error" in answer:
            pytest.fail(f"in Blender:\n{answer['error']}")
        return answer["result"]

    def wait_for(self, expression, timeout=60):
        """Wait till an expression is true in Blender; return its value."""
        end = time.monotonic() + timeout
        while not (value := self.run(f"result = {expression}", timeout)):
            if time.monotonic() > end:
                pytest.fail(f"not true after {timeout} s: {expression}\n{self.log.read_text()}")
            time.sleep(0.05)
        return value

    def xdotool(self, *words):
        """Press keys, move the mouse; see xdotool(1)."""
        self._x("xdotool", *map(str, words))

    def screenshot(self, path):
        """Write the whole screen to a PNG file and return its path."""
        self._x("import", "-window", "root", str(path))
        return Path(path)

    def _x(self, *words):
        subprocess.run(
            self._blender.tool(*words),
            env=self._blender.env | {"DISPLAY": self._display},
            check=True,
            timeout=60,
            stdin=subprocess.DEVNULL,
        )


def stop(process):
    """End a process that a test started."""
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


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
