"""No module remembers what could change a picture: what does remember stands here, with reasons."""

import ast
import textwrap

import pytest

from .module_state import census
from .test_imports import ADDON, MODULES

# What modules remember, and why no picture can tell. What belongs to one client of the engine is
# owned by its session (engine/session.py), what clients share by engine/shared_resources.py.

# A function of its arguments alone: what it returns is the same whether it was called before or
# not, and is not changed by whoever gets it. The comment above each says of what.
MEMOS = {
    "files.version": ("version",),
    "device.shader_source": ("_join", "_places", "_read", "load"),
    "engine.planning.lens_plan": ("_plan", "_rays"),
    "engine.bokeh.artist_tiles": ("artist_tiles",),
    "engine.bokeh.cylinder_tiles": ("cylinder_tiles",),
    "engine.bokeh.real_tiles": ("_beams", "tiles_work"),
    "engine.bokeh.look": (
        *("_lens_rows", "_light_on_radii", "_opening"),
        *("_profile", "_rims", "_tiles_left"),
    ),
    "engine.viewport_session": ("_type_switches",),
    "lens_bokeh.look.diffraction": ("_amplitude", "_spectrum"),
    "lens_bokeh.look.splat_profile": ("_blur",),
    "lens_bokeh.look.pupil_beams": ("_refining",),
    "lens_bokeh.look.tile_drawing": ("blur_matrix",),
    "lens_bokeh.samples.landing": ("_fit",),
    "lens_io.glasses.dispersion": ("glass_dispersion", "lens_dispersion"),
    "lens_io.glasses.glass_catalog": ("_glasses", "near_names"),
    "lens_io.importers.draft.media": (
        *("_catalog_values", "_maker_glasses", "_names_without_hyphens", "_old_glasses"),
    ),
    "lens_io.recorded_lens": ("parse",),
    "optics.media": ("_index",),
    "passes.surface.environment": ("ggx_table",),
    "sampling.spectrum": ("_matrix", "_observer"),
    "scene.camera.breathing": ("_of_lens",),
    "scene.camera.bokeh": ("_ringing_spectrum",),
    "scene.camera.chromatic": ("_aberration", "_equalizer", "_field_map", "_problems"),
    "scene.camera.distortion": ("_terms_of_lens",),
    "scene.camera.drawn_curves": ("_kept", "_lock"),
    "scene.images.color_spaces": ("_luminance_weights", "_processor", "bundled_module"),
    "scene.skies.fitted_skies": ("_hosek_table",),
    "scene.skies.multiple_scattering": ("_transmittances",),
    "snapshot.cryptomatte": ("cryptomatte_hash",),
    "ui.previews.aberration_previews": ("aberration_pictures",),
    "ui.previews.bokeh_previews": ("_speckles", "disc_pictures"),
    "ui.previews.chromatic_previews": ("shown_range",),
    "scene.nodes.value_nodes": ("_black_body_table", "_wavelength_table"),
}

# By module: why it remembers, and what.
OTHERS = {
    # Shared by sessions, with an owner.
    "engine.shared_resources": (
        "the owner of all that sessions share: made by register, closed by unregister",
        ("_resources",),
    ),
    # The graphics device, of which a process has one.
    "device.shaders": (
        "compiled shaders of the device, by their source; none may be freed before it goes",
        ("_cache",),
    ),
    "device.keeping": (
        "textures wait here for the thread that may free them, which `let_go` does",
        ("_held", "_left", "_owner"),
    ),
    "device.census": ("who counts objects of the device now, for tests", ("_in_progress",)),
    # This process.
    "engine.gpu_thread": (
        "work that waits for Blender's main thread, of which there is one; it comes with all that"
        " it needs, and its result goes to who waits for it",
        ("_jobs", "_renders", "_renders_lock"),
    ),
    "snapshot.content": (
        "counts up, so that no two parts of snapshots have the same number; pictures compare"
        " numbers and never use them",
        ("_uids",),
    ),
    "levels.making.level_collapses": (
        "lets one thread at a time into a library that has variables of its own, set anew by each",
        ("_library",),
    ),
    "files.whole_file": (
        "what a signal that ends the process removes",
        ("_unfinished", "_unfinished_folders"),
    ),
    "cli.blender_command": ("what `unregister` gives back to Blender", ("_handles",)),
    # Filled by decorators while their modules are imported, and not after that.
    "device.shader_variants": ("the makers of shaders, for tests", ("_makers",)),
    "passes.nodes.closure_nodes": ("makers of GLSL by kind of node", ("generates",)),
    "passes.nodes.image_nodes": ("makers of GLSL by kind of node", ("generates",)),
    "passes.nodes.input_nodes": ("makers of GLSL by kind of node", ("generates",)),
    "passes.nodes.pattern_nodes": ("makers of GLSL by kind of node", ("generates",)),
    "passes.nodes.value_nodes": ("makers of GLSL by kind of node", ("generates",)),
    "passes.nodes.vector_nodes": ("makers of GLSL by kind of node", ("generates",)),
    "scene.nodes.closure_nodes": ("readers by kind of node", ("reads",)),
    "scene.nodes.fibre_nodes": ("readers by kind of node", ("reads",)),
    "scene.nodes.image_nodes": ("readers by kind of node", ("reads",)),
    "scene.nodes.input_nodes": ("readers by kind of node", ("reads",)),
    "scene.nodes.pattern_nodes": ("readers by kind of node", ("reads",)),
    "scene.nodes.value_nodes": ("readers by kind of node", ("reads",)),
    "scene.nodes.vector_nodes": ("readers by kind of node", ("reads",)),
    "scene.nodes.volume_nodes": ("readers by kind of node", ("reads",)),
    # Panels.
    "ui.focus.focus_overlay": ("handles with which 3D views draw", ("_handles",)),
    "ui.jobs.background": (
        "work for panels, and what the user stopped of it",
        ("_errors", "_queue", "_stopped"),
    ),
    "ui.jobs.live_refocus": (
        "the handle with which Image editors tell that they draw",
        ("_draw_handle",),
    ),
    "ui.previews.aberration_previews": ("icons of panels", ("icons",)),
    "ui.previews.bokeh_previews": ("icons of panels", ("icons",)),
    "ui.previews.chromatic_previews": ("icons of panels", ("icons",)),
    "ui.previews.lens_thumbnails": ("icons of panels", ("icons",)),
    "ui.previews.spectrum_bar": ("colours of a panel", ("_colors",)),
    "ui.properties.camera_properties": (
        "texts of menus, which Blender does not keep, and their numbers; a file has neither",
        ("_numbers", "_texts"),
    ),
}

WHAT_TO_DO = (
    "{name} (addon/{path}, line {line}) {why}: a module may not remember what could change a"
    " picture. Let the session of the client own it (engine/session.py); what several sessions"
    " share, engine/shared_resources.py. If it is a memo of its arguments alone, or no picture can"
    " tell, say so in a comment there, and enter it in tests/layering/test_module_state.py with"
    " the reason. A table that nobody changes is written in CAPITALS."
)

SOURCES = {name: path.read_text(encoding="utf-8") for name, path in MODULES.items()}
FOUND = census({name: ast.parse(text) for name, text in SOURCES.items()})


def entered():
    memos = {f"{module}.{name}" for module, names in MEMOS.items() for name in names}
    return memos, {f"{module}.{name}" for module, (_, names) in OTHERS.items() for name in names}


def module_of(name):
    while name not in MODULES:
        name = name.rpartition(".")[0]
    return name


def test_what_modules_remember_is_known():
    memos, others = entered()
    new = [
        WHAT_TO_DO.format(
            name=name,
            path=MODULES[module_of(name)].relative_to(ADDON),
            line=state.line,
            why=state.why,
        )
        for name, state in FOUND.items()
        if name not in memos | others
    ]
    assert not new, "\n".join(new)


def test_every_entry_is_there_and_is_what_it_says():
    memos, others = entered()
    assert (memos | others) - FOUND.keys() == set(), "no longer there: take it out of the table"
    assert {name for name in others if FOUND[name].memo} == set(), "a memo: enter it as one"


def test_a_memo_says_of_what():
    for name, state in FOUND.items():
        if state.memo:
            lines = SOURCES[module_of(name)].splitlines()
            above = lines[: state.line - 1]
            # Several in a row have one comment.
            while above and "lru_cache" in above[-1] and not above[-1].startswith("@"):
                above.pop()
            assert above and above[-1].lstrip().startswith("#"), (
                f"{name}: say in a comment above line {state.line} of what it is a memo"
            )


@pytest.mark.parametrize(
    "text, names",
    [
        ("_kept = {}", ["m._kept"]),
        ("_KEPT = {}", []),
        ("_KEPT = {}\ndef f():\n    _KEPT[1] = 2", ["m._KEPT"]),
        ("_KEPT = []\ndef f():\n    _KEPT.append(1)", ["m._KEPT"]),
        ("_KEPT = []\ndef f(_KEPT):\n    _KEPT.append(1)", []),
        ("_KEPT = [1]\n_KEPT.append(2)", []),
        ("_last = None", []),
        ("_last = None\ndef f():\n    global _last\n    _last = 1", ["m._last"]),
        ("def f():\n    global _last\n    _last = 1", ["m._last"]),
        ("if True:\n    kept = []", ["m.kept"]),
        ("kept: dict = {}", ["m.kept"]),
        ("LOCK = threading.Lock()", ["m.LOCK"]),
        ("STORE = Store()\nclass Store:\n    pass", ["m.STORE"]),
        ("NONE = Value()\n@dataclass(frozen=True)\nclass Value:\n    pass", []),
        ("@cache\ndef f():\n    pass", ["m.f"]),
        ("@functools.lru_cache(maxsize=1)\ndef f():\n    pass", ["m.f"]),
        ("make = lru_cache(4)(int)", ["m.make"]),
        ("def f():\n    @cache\n    def g():\n        pass", []),
        ("class C:\n    @cache\n    def f(self):\n        pass", ["m.C.f"]),
        ("class C:\n    kept = []", ["m.C.kept"]),
        ("class C:\n    bl_options = {'UNDO'}\n    SIDES = [1, 2]", []),
        ("class C:\n    n = 0\n    @classmethod\n    def f(cls):\n        cls.n += 1", ["m.C.n"]),
        ("class C:\n    n = 0\ndef f():\n    C.n = 1", ["m.C.n"]),
        ("class C:\n    def f(self):\n        self.n = 1", []),
        ("def f():\n    f.last = 1", ["m.f.last"]),
        ("from .other import TABLE\ndef f():\n    TABLE['a'] = 1", ["m.TABLE"]),
        ("from . import m\ndef f():\n    m.last = 1", ["m.m.last"]),
        ("from . import m\ndef f():\n    m.remove(1)", []),
        ("import sys\ndef f():\n    sys.path.append(1)", []),
        ("count = float('inf')", []),
        ("PATTERN = re.compile('a')", []),
    ],
)
def test_the_census_sees(text, names):
    assert sorted(census({"m": ast.parse(textwrap.dedent(text))})) == names
