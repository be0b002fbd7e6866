"""The directions of the code: who may import whom, and who may import Blender."""

import ast
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
ADDON = REPOSITORY / "addon"

# The drawing (docs/architecture.md): rooms from the bottom up, each with the rooms that it may
# import besides itself and errors. A room may only import rooms that stand above it in this list,
# so there are no circles between rooms. A room is a folder; its sub-rooms are rooms of their own.
ROOMS = {
    # Values and arithmetic: no Blender, no graphics device.
    "files": (),
    "optics": (),
    "optics.rays": ("optics",),
    "sampling": (),
    "sampling.lights": (),
    "lens_bokeh": (),
    # Settings, each declared once: name, type, bounds, default; and the presets.
    "settings": ("sampling",),
    "lens_bokeh.tables": ("optics", "optics.rays", "sampling"),
    # What a real lens does to lens samples.
    "lens_bokeh.samples": ("optics", "optics.rays", "lens_bokeh.tables"),
    # The shape of the opening, of lens samples and discs alike.
    "lens_bokeh.openings": ("sampling",),
    "lens_bokeh.look": ("lens_bokeh.openings", "lens_bokeh.tables"),
    "lens_io.glasses": ("optics", "sampling"),
    "lens_io.toml": ("optics", "optics.rays", "lens_io.glasses"),
    "lens_io.importers.draft": ("optics", "lens_io.glasses", "lens_io.toml"),
    "lens_io.importers.zemax": ("optics", "lens_io.importers.draft"),
    "lens_io.importers.codev": ("optics", "lens_io.importers.draft"),
    "lens_io.importers": (
        *("optics", "optics.rays", "lens_io.toml"),
        *("lens_io.importers.draft", "lens_io.importers.zemax", "lens_io.importers.codev"),
    ),
    "lens_io": (
        *("files", "optics", "lens_bokeh.tables"),
        *("lens_io.toml", "lens_io.importers"),
    ),
    # Drawings of lenses, with a plotting library that is imported inside functions.
    "plots": (
        *("files", "optics", "optics.rays", "sampling"),
        *("lens_bokeh.look", "lens_bokeh.openings", "lens_bokeh.tables", "lens_io"),
    ),
    "layers": ("files",),
    "snapshot": ("layers", "optics", "sampling", "lens_bokeh.look", "lens_bokeh.tables"),
    "levels.making": ("snapshot",),
    "levels": ("files", "snapshot", "levels.making"),
    # The graphics device, and passes on it.
    "device": (),
    # Node trees as GLSL.
    "passes.nodes": ("device", "snapshot"),
    "passes.surface": ("device", "sampling", "snapshot", "passes.nodes"),
    "passes.visibility": ("device", "passes.surface"),
    "passes.bokeh": ("device", "passes.surface", "passes.visibility"),
    "passes.layered": ("device", "passes.surface"),
    "passes": ("device", "sampling", "passes.surface", "passes.bokeh"),
    # Blender's data read into a snapshot.
    "scene.images": ("snapshot",),
    # Blender's skies in plain numpy.
    "scene.skies": ("sampling",),
    "scene.nodes": ("sampling", "snapshot", "scene.images", "scene.skies"),
    "scene.camera": (
        *("optics", "optics.rays", "sampling", "lens_bokeh.openings", "lens_bokeh.look"),
        "lens_bokeh.tables",
        *("lens_io", "lens_io.glasses", "settings", "snapshot", "scene.images"),
    ),
    "scene.shading": ("snapshot", "scene.images", "scene.nodes"),
    "scene.geometry": ("snapshot", "scene.camera", "scene.shading"),
    "scene": ("settings", "snapshot", "scene.camera", "scene.geometry", "scene.shading"),
    # A frame: planned, drawn, shown.
    "engine.planning": (
        *("layers", "optics", "sampling", "lens_bokeh.samples", "lens_bokeh.tables"),
        *("snapshot", "levels"),
    ),
    # Drawings that several lens samples share.
    "engine.sharing": ("device", "sampling", "passes", "levels"),
    "engine.drawing.glass": ("device", "passes", "passes.surface"),
    "engine.drawing": (
        *("device", "sampling", "sampling.lights", "passes.surface", "passes.visibility"),
        *("levels", "levels.making", "engine.sharing", "engine.drawing.glass"),
    ),
    # The scene through depth layers, in place of a drawing for each lens sample.
    "engine.layered": ("device", "layers", "passes.bokeh", "passes.layered", "passes.surface"),
    "engine.visibility": (
        *("device", "passes.nodes", "passes.surface", "passes.visibility", "passes.bokeh"),
        "engine.drawing",
    ),
    "engine.bokeh": (
        *("device", "optics", "sampling", "lens_bokeh.openings", "lens_bokeh.look"),
        *("lens_bokeh.tables", "lens_io"),
        *("passes", "passes.surface", "passes.bokeh"),
        *("engine.layered", "engine.visibility"),
    ),
    "engine.frame": (
        *("device", "sampling", "snapshot", "passes", "passes.surface", "passes.bokeh"),
        *("engine.drawing", "engine.layered", "engine.visibility", "engine.bokeh"),
    ),
    # A captured picture instead of a scene.
    "engine.refocus": (
        *(
            "files",
            "layers",
            "lens_io",
            "device",
            "sampling",
            "settings",
            "snapshot",
            "lens_bokeh.openings",
            "lens_bokeh.tables",
            "scene.camera",
        ),
        *("engine.planning", "engine.drawing", "engine.layered", "engine.frame"),
    ),
    "engine": (
        *("device", "snapshot", "lens_io", "levels", "scene", "scene.camera", "passes.surface"),
        *("engine.planning", "engine.drawing", "engine.bokeh", "engine.frame"),
    ),
    # Another engine's pictures, or ours, as depth layers.
    "capture": ("files", "sampling", "settings", "layers", "scene.camera"),
    # Blender's compositor: node groups, wiring, the traced sprite as an image.
    "compositor": (
        *("lens_bokeh.openings", "lens_bokeh.look", "scene.camera", "engine", "engine.bokeh"),
    ),
    # What a user meets.
    # Seeing and setting the focus in the 3D view.
    "ui.focus": ("device", "passes", "scene.camera", "engine"),
    "ui.jobs": ("layers", "engine", "engine.refocus"),
    "ui.previews": (
        *("lens_bokeh.openings", "lens_bokeh.look", "lens_bokeh.tables", "plots"),
        *("scene.camera", "ui.jobs"),
    ),
    "ui.operators": (
        *("optics", "sampling", "lens_io", "lens_io.importers.draft"),
        *("files", "layers", "scene", "scene.camera", "engine", "engine.refocus", "capture"),
        *("compositor", "ui.jobs"),
    ),
    "ui.properties": (*("lens_io.glasses", "settings", "engine", "ui.operators", "ui.previews"),),
    "ui.presets": ("settings", "ui.operators", "ui.properties"),
    "ui.panels": (
        *("optics", "scene", "scene.camera", "engine", "engine.refocus", "capture"),
        *("ui.jobs", "ui.operators", "ui.presets", "ui.previews"),
    ),
    "ui": (),
    "cli.words": ("files",),
    "cli.render": (
        *("files", "device", "sampling", "lens_bokeh.openings", "lens_io", "scene"),
        *("scene.camera", "settings", "engine", "cli.words"),
    ),
    "cli.lens": (
        *("files", "optics", "optics.rays", "lens_bokeh.tables", "plots", "scene.camera"),
        *("lens_io", "lens_io.toml", "lens_io.importers", "cli.words"),
    ),
    "cli.capture": (
        *("files", "device", "scene", "engine", "capture"),
        *("cli.words", "cli.render"),
    ),
    "cli.refocus": (
        *("files", "device", "layers", "lens_io", "scene.camera", "settings"),
        *("engine", "engine.refocus"),
        *("cli.words", "cli.render"),
    ),
    "cli": (
        *("files", "settings", "cli.words", "cli.render", "cli.lens"),
        *("cli.capture", "cli.refocus"),
    ),
}

# What stands in no room: the package, its exceptions, and what makes it known to Blender.
ROOF = {"", "errors", "registration"}

# Modules of Blender that only its Python has.
BLENDER = {"bpy", "bl_ui", "bl_operators", "bpy_extras", "mathutils", "addon_utils"}

# Rooms that read or drive Blender. All others work on values: nothing in them imports Blender, not
# even inside a function.
BLENDER_ROOMS = {
    *("scene", "scene.images", "scene.nodes", "scene.camera"),
    *("engine", "engine.refocus", "capture", "compositor"),
    *(
        f"ui.{name}"
        for name in ("focus", "jobs", "previews", "operators", "properties", "presets", "panels")
    ),
    *("cli", "cli.render", "cli.capture", "cli.refocus"),
}
# In a room that may, these may not: they are values or arithmetic.
BLENDER_FREE = {
    "scene.geometry.vertex_split",
    "capture.settings",
    "cli.arguments",
    "cli.capture.capture_arguments",
    "cli.command",
    "cli.render.camera_arguments",
    "cli.render.sampling_arguments",
    "engine.outcome",
    "engine.report",
    "engine.views",
}


@dataclass(frozen=True)
class Import:
    """One import statement: who, what, and whether it stands inside a function."""

    module: str
    target: str
    relative: bool
    deferred: bool


def modules():
    return {module_name(path): path for path in sorted(ADDON.rglob("*.py"))}


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
    """Return the room of a module: the folder that it lies in."""
    if (ADDON / module.replace(".", "/")).is_dir():
        return module
    return module.rpartition(".")[0]


def test_every_folder_is_a_room_and_every_room_a_folder():
    folders = {room(name) for name in MODULES} - {""}
    known = set(ROOMS)
    assert folders - known == set(), "draw the new room above and in docs/architecture.md"
    assert {name for name in known - folders if not (ADDON / name.replace(".", "/")).is_dir()} == (
        set()
    )


def test_rooms_import_downwards():
    order = list(ROOMS)
    for name, allowed in ROOMS.items():
        for other in allowed:
            assert order.index(other) < order.index(name), f"{name} would climb to {other}"


@pytest.mark.parametrize("name", sorted(ROOMS))
def test_room_imports_what_the_drawing_says(name):
    inside = [i for i in OWN if i.module not in ROOF and room(i.module) == name]
    found = {room(i.target) for i in inside if i.target not in ROOF} - {name}
    assert found <= set(ROOMS[name]), f"{name} imports {sorted(found - set(ROOMS[name]))}"
    assert set(ROOMS[name]) <= found, f"{name} no longer imports {set(ROOMS[name]) - found}"


def test_only_the_command_line_looks_up_to_the_roof():
    up = {(i.module, i.target) for i in OWN if i.target in ROOF - {"errors"} and i.module}
    # A process that is no Blender yet makes Aplanat known to it.
    assert {module for module, _ in up - {("registration", "")}} <= {"cli.__main__"}


def test_errors_imports_nothing():
    assert not [found for found in IMPORTS if found.module == "errors"]


def test_no_cycles():
    # Imports inside functions count: a circle that is put off is still one.
    graph = {name: {i.target for i in OWN if i.module == name} for name in MODULES}
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


def test_blender_is_imported_in_its_rooms_only():
    found = [i for i in IMPORTS if i.target.partition(".")[0] in BLENDER]
    for one in found:
        assert room(one.module) in BLENDER_ROOMS, f"{one.module} imports {one.target}"
        assert one.module not in BLENDER_FREE, f"{one.module} imports {one.target}"
    assert {room(one.module) for one in found} == BLENDER_ROOMS


def pure_rooms():
    """Return the rooms that no Blender is needed for, neither in them nor in what they import."""
    pure = set()
    for name, allowed in ROOMS.items():
        if name not in BLENDER_ROOMS and set(allowed) <= pure:
            pure.add(name)
    # Of scene.camera it asks only what is free of Blender, as the next test sees.
    return pure | {"cli.lens"}


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
        *(f"addon.{name}" for name in MODULES if room(name) in pure_rooms()),
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
