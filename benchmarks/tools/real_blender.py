"""A real Blender in the background and in a window, driven from Python."""

import itertools
import json
import os
import shutil
import signal
import subprocess
import textwrap
import time
import unittest
from contextlib import contextmanager
from pathlib import Path

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


class ToolMissingError(unittest.SkipTest):
    """A program that windows need is not there; a test that needs it is skipped."""


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
            raise ToolMissingError(
                f"windows need {words[0]} on PATH, or scripts/get-blender's Blender"
            )
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
            raise AssertionError(
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
                raise AssertionError(
                    f"Blender ended ({self.process.returncode}):\n{self.log.read_text()}"
                )
            if time.monotonic() > end:
                raise AssertionError(
                    f"Blender did not answer in {timeout} s:\n{self.log.read_text()}"
                )
            time.sleep(0.01)
        answer = json.loads(answer.read_text())
        if "error" in answer:
            raise AssertionError(f"in Blender:\n{answer['error']}")
        return answer["result"]

    def wait_for(self, expression, timeout=60):
        """Wait till an expression is true in Blender; return its value."""
        end = time.monotonic() + timeout
        while not (value := self.run(f"result = {expression}", timeout)):
            if time.monotonic() > end:
                raise AssertionError(
                    f"not true after {timeout} s: {expression}\n{self.log.read_text()}"
                )
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
    """End a process that was started here."""
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
