"""A recipe as a stand-alone script, which is also the only way in which a scene is built."""

import ast
import json
import pprint
import re
from pathlib import Path

_PIECES = Path(__file__).with_name("pieces.py").read_text(encoding="utf-8")
# The source of each function by its name; the module is not imported, because that takes Blender.
_FUNCTIONS = {
    part.name: ast.get_source_segment(_PIECES, part)
    for part in ast.parse(_PIECES).body
    if isinstance(part, ast.FunctionDef)
}

_HEAD = '''"""{title}

    python {name} [FILE.blend]

in a Python with bpy and with Aplanat's checkout on PYTHONPATH, or in a Blender that has Aplanat;
the scene is saved if a file is named.
"""

import math
import sys

import bpy  # brings the two that follow
import bmesh
import mathutils
import numpy as np

if not hasattr(bpy.types.Scene, "aplanat"):
    import addon

    addon.register()
'''

_TAIL = """
if sys.argv[-1].endswith(".blend"):
    bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
"""


def script(recipe, title="A scene of the zoo.", name="SCRIPT.py"):
    """Return the text of a script that builds a recipe's scene.

    Parameters
    ----------
    recipe : dict
        See `recipe.make_recipe`.
    title : str
        First line of the script: what is wrong with the scene.
    name : str
        Of the script's file.

    Returns
    -------
    str
    """
    body = body_of(recipe)
    functions = "\n\n\n".join(_FUNCTIONS[n] for n in _needed(body, recipe))
    title = " ".join(title.replace("\\", "/").replace('"""', "'''").split())
    head = _HEAD.format(title=title, name=name)
    return f"{head}\n\n{functions}\n\n\n{body}{_TAIL}"


def body_of(recipe):
    """Return the calls that build a recipe's scene, without the functions that they call."""
    lines = [_call("scene = start", recipe.get("scene", {}))]
    lines += [_call("make_material", n, s) for n, s in recipe.get("materials", {}).items()]
    if "world" in recipe:
        lines.append(_call("make_world", "scene", recipe["world"]))
    for collection in recipe.get("collections", []):
        lines.append(f"{_variable(collection)} = {_call('make_collection', 'scene', collection)}")
    for number, spec in enumerate(recipe.get("objects", [])):
        place = spec.get("collection")
        place = _variable(place) if place in recipe.get("collections", []) else "scene.collection"
        lines.append(_call("make_object", place, number, spec))
    for number, spec in enumerate(recipe.get("lights", [])):
        lines.append(_call("make_light", "scene", number, spec))
    lines.append(_call("make_camera", "scene", recipe.get("camera", {})))
    for number, spec in enumerate(recipe.get("layers", [])):
        lines.append(_call("make_layer", "scene", number, spec))
    lines.append(_call("finish", "scene", recipe.get("settings", {})))
    return "\n".join(lines) + "\n"


def build(recipe):
    """Build a recipe's scene in this process' Blender, by running its script.

    Parameters
    ----------
    recipe : dict

    Returns
    -------
    bpy.types.Scene
    """
    namespace = {"__name__": "zoo"}
    source = script(recipe).removesuffix(_TAIL)
    exec(compile(source, "zoo script", "exec"), namespace)
    return namespace["scene"]


def _variable(collection):
    return "collection_" + collection


def _call(function, *arguments):
    texts = [
        a if isinstance(a, str) and re.match(r"scene\b|collection_", a) else _literal(a)
        for a in arguments
    ]
    line = f"{function}({', '.join(texts)})"
    if len(line) <= 100 and "\n" not in line:
        return line
    inner = "\n".join(_indented(text) + "," for text in texts)
    return f"{function}(\n{inner}\n)"


def _literal(value):
    # Through JSON, so that a recipe that was stored and read again gives the same script.
    value = json.loads(json.dumps(value))
    return pprint.pformat(value, width=94, sort_dicts=False)


def _indented(text):
    return "\n".join("    " + line for line in text.splitlines())


def _needed(body, recipe):
    """Return the names of the functions that a script calls, callers' callees first."""
    kinds = re.findall(r"'kind': '(\w+)'", repr(recipe))
    waiting = [name for name in _FUNCTIONS if re.search(rf"\b{name}\(", body)]
    waiting += [f"make_{kind.lower()}" for kind in kinds]
    found = set()
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            called = _FUNCTIONS[name]
            waiting += [n for n in _FUNCTIONS if n != name and re.search(rf"\b{n}\b", called)]
    return [name for name in _FUNCTIONS if name in found]
