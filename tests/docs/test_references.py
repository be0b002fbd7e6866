"""Modules, names and files that docstrings and comments mention exist."""

import ast
import io
import re
import tokenize
from functools import cache
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
ADDON, SHADERS = REPO / "addon", REPO / "gpu_shaders"
SOURCES = [path for top in ("addon", "benchmarks") for path in sorted((REPO / top).rglob("*.py"))]
MODULES = {
    ".".join(path.relative_to(REPO).with_suffix("").parts).removesuffix(".__init__"): path
    for path in SOURCES
}
GLSL = sorted(SHADERS.rglob("*.glsl"))
ROOMS = {path.name for path in ADDON.iterdir() if path.is_dir()}

# `a.b.Name` in backquotes; a path with a slash that ends in a file of ours.
DOTTED = re.compile(r"(?<!`)`([A-Za-z_]\w*(?:\.[A-Za-z_]\w*)+)`(?!`)")
# Without them, as types of parameters have it: two dots or more.
TYPE = re.compile(r"(?<![\w/.`])([a-z_]+(?:\.\w+){2,})(?![\w/`])")
PATH = re.compile(r"(?<![\w/.])([\w.]+(?:/[\w.-]+)*\.(?:glsl|py|md))\b")


@cache
def names_in(path):
    """Return the names that a module defines or imports, and the attributes that it sets."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            found.add(node.attr)
        elif isinstance(node, ast.alias):
            found.add((node.asname or node.name).partition(".")[0])
    return frozenset(found)


@cache
def texts(path):
    """Return line and text of the comments and docstrings of a Python file or a shader."""
    source = path.read_text(encoding="utf-8")
    if path.suffix == ".glsl":
        lines = enumerate(source.splitlines(), 1)
        return [(number, line.partition("//")[2]) for number, line in lines if "//" in line]
    return [
        (token.start[0], token.string)
        for token in tokenize.generate_tokens(io.StringIO(source).readline)
        if token.type == tokenize.COMMENT or token.string.startswith('"""')
    ]


def is_named(dotted, module):
    """Whether dotted parts are a module, or names in one, seen from the root, addon or a module."""
    parts = dotted.split(".")
    around = module.split(".")
    for depth in range(len(around) + 1):
        base = around[:depth] or ["addon"]
        for cut in range(len(parts), 0, -1):
            path = MODULES.get(".".join([*base, *parts[:cut]])) or (
                MODULES.get(".".join(parts[:cut])) if parts[0] in ("addon", "benchmarks") else None
            )
            if path and all(name in names_in(path) for name in parts[cut:]):
                return True
    return False


CLASSES = {
    node.name
    for path in SOURCES
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    if isinstance(node, ast.ClassDef)
}
ALL_NAMES = frozenset().union(*(names_in(path) for path in SOURCES))


def test_dotted_names_in_docstrings_lead_to_code():
    wrong = []
    for module, path in MODULES.items():
        for line, text in texts(path):
            for dotted in [*DOTTED.findall(text), *TYPE.findall(text)]:
                first, *rest = dotted.split(".")
                if first in ROOMS or first in ("addon", "benchmarks"):
                    if dotted.endswith((".py", ".md", ".json")):
                        continue
                    good = is_named(dotted, module)
                elif first in CLASSES:
                    good = all(name in ALL_NAMES for name in rest)
                else:
                    continue
                if not good:
                    wrong.append(f"{path.relative_to(REPO)}:{line}: {dotted}")
    assert not wrong


def test_files_in_comments_exist():
    shaders = {str(path.relative_to(SHADERS)) for path in GLSL}
    wrong = []
    for path in [*SOURCES, *GLSL]:
        for line, text in texts(path):
            for name in PATH.findall(text):
                if "/" not in name and not name.endswith(".glsl"):
                    continue
                roots = (REPO, ADDON, SHADERS, path.parent, REPO / "benchmarks")
                if name in ("lib/name.glsl", "sha.glsl") or any((r / name).exists() for r in roots):
                    continue
                if not any(f"/{shader}".endswith(f"/{name}") for shader in shaders):
                    wrong.append(f"{path.relative_to(REPO)}:{line}: {name}")
    assert not wrong
