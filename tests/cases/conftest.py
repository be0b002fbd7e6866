"""The shared failing inputs, built once a run by their own script."""

import os
import subprocess
import sys

import pytest

from addon.engine.shared_resources import listen

# The builder saves nearly twenty small files, each in a second on a busy machine.
_BUILD_SECONDS = 300


@pytest.fixture(scope="session")
def shared_cases(shared):
    """The folder of the shared failing inputs; skips where it is absent."""
    folder = shared / "cases"
    if not (folder / "scenes.py").is_file():
        pytest.skip("the shared failing inputs are not beside this checkout")
    return folder


@pytest.fixture(scope="session")
def case_folder(shared_cases, tmp_path_factory):
    """A folder with every scene of ``scenes.py`` as NAME.blend, built in a process of its own."""
    folder = tmp_path_factory.mktemp("cases")
    subprocess.run(
        [sys.executable, str(shared_cases / "scenes.py"), str(folder)],
        check=True,
        stdout=subprocess.DEVNULL,
        timeout=_BUILD_SECONDS,
        env=os.environ | {"PYTHONDONTWRITEBYTECODE": "1"},
    )
    return folder


@pytest.fixture(scope="session")
def case_file(case_folder):
    """Return the path of a named case: `case_file("g-mix")`."""

    def path(name):
        file = case_folder / f"{name}.blend"
        assert file.is_file(), f"scenes.py builds no {name}"
        return file

    return path


@pytest.fixture
def open_case(aplanat_bpy, case_file):
    """Open a named case in this process and return its scene: `open_case("g-mix")`."""

    def open_file(name):
        aplanat_bpy.ops.wm.open_mainfile(filepath=str(case_file(name)))
        return aplanat_bpy.context.scene

    return open_file


@pytest.fixture
def render_default(aplanat_bpy):
    """Render the open scene with Aplanat's defaults, or at chosen samples, or by the reference.

    Returns the passes of each view layer, by its name: dicts of arrays, bottom row first.
    """

    def render(samples=None, method="ADAPTIVE"):
        scene = aplanat_bpy.context.scene
        scene.render.engine = "APLANAT"
        scene.aplanat.method = method
        if samples is not None:
            scene.aplanat.use_target_error = False
            scene.aplanat.render_samples = samples
        with listen(keep_pictures=True) as heard:
            aplanat_bpy.ops.render.render()
        if heard.error is not None:
            raise heard.error
        return {
            layer.layer: {name: found.pixels for name, found in layer.passes.items()}
            for layer in heard.layers
        }

    return render
