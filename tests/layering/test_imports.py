"""The directions of the code: who may import whom, and who may import Blender."""

import ast
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
ADDON = REPOSITORY / "addon"

# Rooms from the bottom up; each may import what stands in its list, besides itself and errors.
# scene is split: its values (snapshot, surface_graph) know no Blender, its readers do.
ROOMS = {
    "files": set(),
    "optics": set(),
    "sampling": set(),
    "bokeh": {"optics", "sampling"},
    "lens_io": {"files", "optics", "bokeh", "sampling"},
    # Drawings of lenses, with a plotting library that is imported inside functions.
    "plots": {"files", "optics", "bokeh", "sampling", "lens_io"},
    "scene.snapshot": {"sampling", "optics", "bokeh", "scene.surface_graph"},
    "scene.surface_graph": set(),
    "device": set(),
    "passes": {"device", "sampling", "bokeh", "scene.surface_graph", "scene.snapshot"},
    "reference": {"sampling", "scene.snapshot", "optics", "bokeh"},
    "scene": {
        *("sampling", "optics", "bokeh", "lens_io"),
        *("scene.snapshot", "scene.surface_graph"),
    },
    "layers": {"sampling", "scene.snapshot"},
    "engine": {
        *("files", "device", "passes", "sampling", "optics", "bokeh"),
        *("scene", "scene.snapshot", "scene.surface_graph"),
    },
    "compositor": {"engine", "scene.snapshot"},
    "ui": {
        *("files", "optics", "bokeh", "sampling", "lens_io", "plots"),
        *("engine", "scene", "scene.snapshot"),
    },
    "cli": {
        *("files", "optics", "bokeh", "sampling", "lens_io", "plots"),
        *("engine", "scene", "device", "ui"),
        # Measuring against it, in a checkout.
        "reference",
    },
}

# Modules of Blender that only its Python has.
BLENDER = {"bpy", "bl_ui", "bl_operators", "bpy_extras", "mathutils", "addon_utils"}

# Where Blender is read or driven. Everything else works on values.
BLENDER_FACING = {
    "registration",
    "cli",
    "ui",
    "compositor",
    "scene",
    "engine.render_engine",
    "engine.final_render",
    "engine.viewport",
}
# Whole rooms that run without Blender.
PURE_ROOMS = tuple(
    f"{name}."
    for name in ("files", "optics", "bokeh", "sampling", "lens_io", "plots", "device", "passes")
)
# In a room that may, these may not: they are values or arithmetic.
BLENDER_FREE = {
    "scene.snapshot",
    "scene.surface_graph",
    "scene.brightness",
    "scene.changes",
    "scene.cryptomatte",
    "scene.vertex_split",
    "cli.arguments",
    "cli.bench_curve",
    "cli.console",
    "cli.json_file",
    "cli.lens",
    "cli.lens_arguments",
    "cli.lens_bake",
    "cli.lens_bench",
    "cli.lens_import",
    "cli.lens_info",
    "cli.lens_list",
    "cli.lens_plot",
    "cli.lens_trace",
    "cli.option_values",
    "cli.text_table",
    "cli.picture_metrics",
    "cli.command",
}


@dataclass(frozen=True)
class Import:
    """One import statement: who, what, and whether it stands inside a function."""

    module: str
    target: str
    relative: bool
    deferred: bool


def modules():
    files = sorted(path for path in ADDON.rglob("*.py") if "presets" not in path.parts)
    return {module_name(path): path for path in files}


def module_name(path):
    parts = path.relative_to(ADDON).with_suffix("").parts
    return ".".join(part for part in parts if part != "__init__")


def imports_of(module, path, known):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    package = module.split(".") if path.name == "__init__.py" else module.split(".")[:-1]
    package = [part for part in package if part]
    deferred = {
        inner
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef)
        for inner in ast.walk(function)
    }
    for node in ast.walk(tree):
        late = node in deferred
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield Import(module, alias.name, False, late)
        elif isinstance(node, ast.ImportFrom):
            if node.level == 0:
                yield Import(module, node.module, False, late)
                continue
            base = package[: len(package) - node.level + 1]
            base += node.module.split(".") if node.module else []
            for alias in node.names:
                full = ".".join([*base, alias.name])
                yield Import(module, full if full in known else ".".join(base), True, late)


MODULES = modules()
IMPORTS = [found for name, path in MODULES.items() for found in imports_of(name, path, MODULES)]
OWN = [found for found in IMPORTS if found.relative]


def room(module):
    if module in ROOMS:
        return module
    return module.partition(".")[0]


def test_every_module_has_a_room():
    rooms = {room(name) for name in MODULES if name and "." in name}
    assert rooms <= set(ROOMS), "describe the new room above: what it may import, and why"


@pytest.mark.parametrize("name", sorted({room(n) for n in MODULES if "." in n}))
def test_room_imports_only_from_below(name):
    allowed = ROOMS[name] | {name, "errors", ""}
    wrong = {
        f"{found.module} imports {found.target}"
        for found in OWN
        if room(found.module) == name and "." in found.module and room(found.target) not in allowed
    }
    assert not wrong


def test_errors_imports_nothing():
    assert not [found for found in IMPORTS if found.module == "errors"]


def test_no_cycles():
    graph = {
        name: {i.target for i in OWN if i.module == name and not i.deferred} for name in MODULES
    }
    done, path = set(), []

    def visit(module):
        assert module not in path, " -> ".join([*path[path.index(module) :], module])
        if module in done:
            return
        path.append(module)
        for target in sorted(graph.get(module, ())):
            if target != module:
                visit(target)
        path.pop()
        done.add(module)

    for module in MODULES:
        visit(module)


def test_own_modules_are_imported_relatively():
    # Blender renames the package: an absolute name would not be found there.
    assert not [found for found in IMPORTS if found.target.partition(".")[0] == "addon"]


def test_gpu_is_imported_in_device_only_and_inside_functions():
    found = [i for i in IMPORTS if i.target.partition(".")[0] == "gpu"]
    assert found
    for one in found:
        assert one.module.startswith("device."), f"{one.module} imports gpu"
        assert one.deferred, f"{one.module} imports gpu at its top: it would need a Blender"


def test_blender_is_imported_at_the_rim_only():
    for found in IMPORTS:
        if found.target.partition(".")[0] not in BLENDER:
            continue
        name = found.module
        assert name in BLENDER_FACING or name.partition(".")[0] in BLENDER_FACING, (
            f"{name} imports {found.target}"
        )
        assert name not in BLENDER_FREE, f"{name} imports {found.target}"


def test_lists_of_this_test_name_modules_that_exist():
    for name in BLENDER_FREE:
        assert name in MODULES, name


def test_no_module_is_a_drawer():
    drawers = {"utils", "util", "helpers", "helper", "misc", "common"}
    assert not [name for name in MODULES if drawers & set(name.split("."))]


@pytest.mark.parametrize(
    "module",
    [
        "addon",
        "addon.errors",
        *(f"addon.{name}" for name in MODULES if name.startswith(PURE_ROOMS)),
        *(f"addon.{name}" for name in sorted(BLENDER_FREE)),
    ],
)
def test_module_is_free_of_blender(module):
    # By the statements of all modules it reaches: quicker than a process for each.
    start = module.removeprefix("addon").removeprefix(".")
    reached, waiting = set(), [start]
    while waiting:
        name = waiting.pop()
        if name in reached:
            continue
        reached.add(name)
        for found in IMPORTS:
            if found.module == name and not found.deferred:
                assert found.target.partition(".")[0] not in BLENDER | {"gpu"}, (
                    f"{module} reaches {name}, which imports {found.target}"
                )
                if found.relative:
                    waiting.append(found.target)


def test_root_and_addon_import_without_blender():
    # A process of its own, where Blender's modules cannot be found.
    code = (
        "import sys\n"
        "for name in ('bpy', 'gpu', 'mathutils'): sys.modules[name] = None\n"
        f"sys.path.insert(0, {str(REPOSITORY)!r})\n"
        "import addon, addon.errors, addon.snapshot.scene, addon.engine.planning.plan\n"
        "import importlib.util as u\n"
        f"spec = u.spec_from_file_location('root', {str(REPOSITORY / '__init__.py')!r})\n"
        "sys.modules['root'] = u.module_from_spec(spec)\n"
        "spec.loader.exec_module(sys.modules['root'])\n"
        "assert sys.modules['root'].register\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
