"""Fixtures of all tests: this process' Blender with Aplanat in it, and the shared material."""

import os
from pathlib import Path

# Small matrices are not worth a second thread, and threads that wait for a busy core spin: with all
# cores at work, a test that blurs tiles took four times as long. Read when numpy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from hypothesis import settings

# The same examples in every run, however busy the machine is.
settings.register_profile("house", derandomize=True, deadline=None)
settings.load_profile("house")

REPOSITORY = Path(__file__).resolve().parents[1]

# Folders whose tests share what takes long to make: an installed Blender, files of scenes.
_TOGETHER = ("tests/blender", "tests/cases")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Say which tests stay in one process where several run them: those of a file or a folder."""
    from xdist.scheduler import LoadScopeScheduling

    class Scheduling(LoadScopeScheduling):
        def _split_scope(self, nodeid):
            file = nodeid.split("::")[0]
            return next((name for name in _TOGETHER if file.startswith(f"{name}/")), file)

    return Scheduling(config, log)


def pytest_addoption(parser):
    parser.addoption(
        "--full",
        action="store_true",
        help="compare the shared scenes with their references at full sample counts (half an hour)",
    )
    parser.addoption(
        "--side-by-side-seconds",
        type=float,
        default=8.0,
        help="how long a viewport and final renders work at once; from 240 on, leaks are measured",
    )


@pytest.fixture(scope="session")
def shared():
    """The folder of scenes and references beside the checkout."""
    folder = REPOSITORY.parent / "shared"
    if not (folder / "scenes").is_dir():
        pytest.skip("the shared scenes and references are not beside this checkout")
    return folder


@pytest.fixture(scope="session")
def aplanat_bpy():
    """The `bpy` module with Aplanat registered, once for the whole run."""
    import bpy

    import addon

    addon.register()
    yield bpy
    addon.unregister()


@pytest.fixture
def empty_scene(aplanat_bpy):
    """An empty scene with the Standard view transform, 96 x 64 pixels."""
    bpy = aplanat_bpy
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 96, 64
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    return scene


@pytest.fixture
def camera(empty_scene, aplanat_bpy):
    """The data of a new camera: that of the empty scene, and active."""
    bpy = aplanat_bpy
    data = bpy.data.cameras.new("Camera")
    obj = bpy.data.objects.new("Camera", data)
    bpy.context.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    empty_scene.camera = obj
    return data
