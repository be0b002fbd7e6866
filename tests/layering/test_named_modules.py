"""Modules that tests name in the code that they send into a Blender of its own are there."""

import re
from pathlib import Path

from .test_imports import MODULES

FOLDER = Path(__file__).parents[1] / "blender"
# module("engine.viewport"), a module of panels, and in full where a script has no such function.
NAMED = re.compile(
    r"""\bmodule\((["'])([a-z_.]+)\1\)|\baplanat\.addon\.([a-z_.]+)["']|"(ui\.panels\.[a-z_]+)\""""
)


def test_modules_that_are_named_in_blenders_windows_exist():
    named = {
        (path.name, match.group(2) or match.group(3) or match.group(4))
        for path in FOLDER.rglob("*.py")
        for match in NAMED.finditer(path.read_text(encoding="utf-8"))
    }
    assert len(named) > 10
    assert {(file, name) for file, name in named if name not in MODULES} == set()
