"""The directions between the folders of the repository: tests import all, nothing imports tests."""

import ast
import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
# Our packages that a folder may import.
MAY_IMPORT = {
    "addon": set(),
    "benchmarks": {"addon", "benchmarks"},
    "scripts": {"addon", "benchmarks"},
    "findings": set(),
    "farm": set(),
    "tests": {"addon", "benchmarks", "tests"},
}
OURS = {"addon", "benchmarks", "tests", "scripts", "findings", "farm"}
# In code that runs in another process, and stands in a text.
_IN_TEXT = re.compile(r"(?:^|[\s;\"'])(?:from|import) (addon|benchmarks|tests|scripts)\b[\w.]*")
_MODULE = re.compile(r"-m[\s\"',]+(addon|benchmarks|tests)\b")


@pytest.mark.parametrize("folder", MAY_IMPORT)
def test_folders_import_one_way(folder):
    for path in (REPOSITORY / folder).rglob("*"):
        if not path.is_file() or "__pycache__" in path.parts:
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        found = set(_MODULE.findall(text)) if path.suffix != ".md" else set()
        if path.suffix == ".py":
            # The extension imports itself relatively, under whatever name Blender gives it.
            found |= {name for name in imported(text) if name in OURS}
        beyond = found - MAY_IMPORT[folder] - ({"addon"} if folder in {"addon", "farm"} else set())
        assert beyond == set(), f"{path.relative_to(REPOSITORY)} imports {sorted(beyond)}"


def imported(text):
    """Return the first names of all modules that a source imports, in texts too."""
    names = set(_IN_TEXT.findall(text))
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names.add(node.module.partition(".")[0])
    return names
