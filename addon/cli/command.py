"""Running a command: words in, exit code out.

0 is success, 2 unusable arguments or input, 1 any other failure. A refusal is one line on stderr;
with ``--json`` the answer on stdout is one object in either case.
"""

import re
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass

from ..errors import (
    AplanatError,
    DeviceLimitError,
    DeviceUnavailableError,
    InputError,
    LensFileError,
    UnfinishedFileError,
)
from . import arguments as words_of
from .words.console import Console
from .words.json_file import json_text


@dataclass(frozen=True)
class _Command:
    """A parser of arguments and a function that finds the runner of a command; see `main`."""

    parse: Callable
    runner_of: Callable


_REFUSALS = (InputError, DeviceUnavailableError, DeviceLimitError)


def main(words, program="aplanat", parse=words_of.parse, runner_of=None):
    """Run a command in a Blender where Aplanat is registered.

    Parameters
    ----------
    words : list of str
    program : str
        How the command is called.
    parse : callable
        Words and program to arguments; see `arguments.parse`.
    runner_of : callable, optional
        From the arguments, and a function that registers Aplanat, to the function that runs the
        command; default: the commands of this package.

    Returns
    -------
    int
        The exit code. Stdout and stderr are as before.
    """
    command = _Command(parse, runner_of or _runner)
    return _run(command, words, program, lambda: None, lambda console: console.close())


def run_process(register, parse=words_of.parse, runner_of=None):
    """Run the command of `sys.argv` as this process, and end it.

    Stdout and stderr stay redirected to the end: what Blender prints while it exits is dropped.

    Parameters
    ----------
    register : callable
        Registers Aplanat; only called by commands that need Blender.
    parse, runner_of : callable
        See `main`.
    """
    command = _Command(parse, runner_of or _runner)
    sys.exit(_run(command, sys.argv[1:], "aplanat", register, lambda console: None))


def run_in_blender(words):
    """Run a command of ``blender --command aplanat``; stdout stays redirected to the end.

    Returns
    -------
    int
    """
    command = _Command(words_of.parse, _runner)
    return _run(command, words, "aplanat", lambda: None, lambda console: None)


def _run(command, words, program, prepare, finish):
    try:
        arguments = command.parse(words, program)
    except SystemExit as done:
        return done.code or 0
    except InputError as error:
        print(f"{program}: {error}", file=sys.stderr)
        if words_of.wants_json(words):
            print(json_text(_errors(error, words[0] if words else None)))
        return 2
    console = Console(arguments.verbose)
    try:
        return _carry_out(command, arguments, console, prepare)
    finally:
        finish(console)


def _carry_out(command, arguments, console, prepare):
    try:
        answer = command.runner_of(arguments, prepare)(arguments, console)
    except AplanatError as error:
        for line in _lines(error):
            console.say(line)
        refused = isinstance(error, _REFUSALS) and not isinstance(error, UnfinishedFileError)
        # Where a disk is full, Blender has nothing to add.
        if not isinstance(error, _REFUSALS):
            console.show_chatter()
        if arguments.json:
            console.answer(json_text(_errors(error, arguments.command)))
        return 2 if refused else 1
    except Exception as error:
        # A fault of ours: show everything that helps to find the cause.
        console.say(f"failed: {error!r}")
        console.err.write("".join(traceback.format_exception(error)))
        console.show_chatter()
        if arguments.json:
            console.answer(json_text(_errors(error, arguments.command)))
        return 1
    if arguments.json:
        console.answer(json_text(answer))
    return 0


def _runner(arguments, prepare):
    # A lens needs no Blender, and is told sooner than one starts.
    if arguments.command == "lens":
        from .lens.lens_command import lens as run
    else:
        prepare()
        if arguments.command == "capture":
            from .capture.capture_command import capture as run
        elif arguments.command == "refocus":
            from .refocus.refocus_command import refocus_files as run
        else:
            from .render.render_command import render as run
    return run


def _lines(error):
    if not isinstance(error, LensFileError):
        return [str(error)]
    return [
        f"{error.file_name}: {found.code} {found.path}{': ' if found.path else ''}{found.message}"
        for found in error.findings
    ]


def _errors(error, command):
    if isinstance(error, LensFileError):
        return {
            "errors": [found.as_json() for found in error.findings],
            "warnings": [found.as_json() for found in error.warnings],
        }
    name = type(error).__name__.removesuffix("Error")
    code = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()
    # A lens' findings have a path, so that a caller reads both alike.
    path = {"path": ""} if command == "lens" else {}
    told = {"code": code, **path, "message": " ".join(str(error).split())}
    return {"errors": [told], "warnings": [*getattr(error, "warnings", ())]}
