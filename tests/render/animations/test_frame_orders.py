"""A frame is the same, bit by bit, whatever this process or another rendered before it."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from addon.engine.shared_resources import resources
from addon.levels.level_store import LevelStore
from benchmarks.scenes import frame_orders

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")
# Far enough apart that collapses of one pose would not be those of another.
FRAMES = (1, 12, 24)


@pytest.fixture(scope="module")
def blend(aplanat_bpy, tmp_path_factory):
    path = tmp_path_factory.mktemp("orders") / "scene.blend"
    frame_orders.build(aplanat_bpy, lens="double-gauss-50mm-f2")
    aplanat_bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.fixture
def fresh(monkeypatch, tmp_path):
    """Begin with empty levels in memory, and a cache folder: call it with the folder's name."""

    def begin(name):
        monkeypatch.setenv("APLANAT_CACHE", str(tmp_path / name))
        monkeypatch.setattr(resources(), "levels", LevelStore())

    return begin


def in_process_of_its_own(blend, frames, cache):
    done = subprocess.run(
        [
            *(sys.executable, frame_orders.__file__, str(blend)),
            *("--frames", ",".join(map(str, frames))),
        ],
        # Dictionaries of strings have another order inside.
        env=os.environ | {"APLANAT_CACHE": str(cache), "PYTHONHASHSEED": "12345"},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    answer = json.loads(done.stdout.splitlines()[-1])
    return {int(frame): digest for frame, digest in answer["hashes"].items()}, answer["work"]


def test_orders_processes_and_caches_change_no_bit(aplanat_bpy, blend, fresh, tmp_path):
    aplanat_bpy.ops.wm.open_mainfile(filepath=str(blend))
    fresh("cold")
    forwards, work = frame_orders.render(aplanat_bpy, FRAMES)
    assert len(set(forwards.values())) == len(FRAMES)
    # Three meshes; what deforms follows the collapses of its shape at rest in every frame.
    assert work["decimations"] == 3
    again, work = frame_orders.render(aplanat_bpy, FRAMES[::-1], persistent=True)
    assert again == forwards
    assert work["decimations"] == 0
    assert any(Path(tmp_path / "cold" / "levels").iterdir())
    # Nothing in memory; on disk what the first run left.
    fresh("cold")
    warm, work = frame_orders.render(aplanat_bpy, FRAMES[1:], persistent=True)
    assert warm == {frame: forwards[frame] for frame in FRAMES[1:]}
    assert work["decimations"] < 3
    alone, _ = in_process_of_its_own(blend, FRAMES[-1:], tmp_path / "other")
    assert alone == {FRAMES[-1]: forwards[FRAMES[-1]]}
