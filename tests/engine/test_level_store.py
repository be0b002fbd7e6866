"""Levels of detail of a scene: made once, shared, kept, given up."""

import threading
from dataclasses import replace

import numpy as np
import pytest

from addon.engine.level_files import LevelFiles
from addon.engine.level_store import LevelStore
from addon.errors import RenderCancelledError
from addon.files.cache_folder import cache_folder
from addon.scene.snapshot import MeshSnapshot, next_uid


def sheet(count, name="sheet", lift=0.05):
    u, v = np.meshgrid(np.linspace(0, 1, count + 1), np.linspace(0, 1, count + 1))
    positions = np.stack([u, v, lift * np.sin(7 * u) * np.cos(5 * v)], -1).reshape(-1, 3)
    corner = np.arange((count + 1) ** 2, dtype=np.int32).reshape(count + 1, count + 1)
    a, b, c, d = (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1])
    triangles = np.concatenate(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    )
    return MeshSnapshot(
        next_uid(), name, np.float32(positions), triangles, ((0, 0, len(triangles)),)
    )


@pytest.fixture
def store(tmp_path):
    store = LevelStore(folder=tmp_path / "levels")
    yield store
    store.close()


def test_levels_are_there_after_finish_and_the_thread_is_gone(store):
    mesh = sheet(30)
    store.request([mesh], 200)
    store.finish()
    counts = [len(level.triangles) for level in store.ready(mesh.uid)]
    assert counts == pytest.approx([900, 450, 225], rel=0.1)
    assert store.memory_bytes > 0
    assert not store.busy
    assert "aplanat-levels" not in {thread.name for thread in threading.enumerate()}


def test_small_meshes_are_ready_at_once(store):
    mesh = sheet(5)
    store.request([mesh], 256)
    assert store.ready(mesh.uid) == ()
    assert not store.busy


def test_what_was_not_requested_is_not_ready(store):
    assert store.ready(12345) is None
    store.finish()


def test_equal_content_is_simplified_once(store):
    mesh = sheet(30)
    twin = replace(mesh, uid=next_uid(), name="twin")
    store.request([mesh, twin], 200)
    store.finish()
    assert store.decimations == 1
    assert store.ready(mesh.uid) is store.ready(twin.uid)


def test_the_same_shape_in_other_colors_is_simplified_once(store):
    mesh = sheet(30)
    red = np.tile(np.float32([1, 0, 0, 1]), (len(mesh.positions), 1))
    painted = replace(mesh, uid=next_uid(), name="painted", attributes={"color:": red})
    store.request([mesh, painted], 200)
    store.finish()
    assert (store.decimations, store.replays) == (1, 1)
    assert store.ready(painted.uid)[0].attributes["color:"] == pytest.approx(red[:1].repeat(
        len(store.ready(painted.uid)[0].positions), axis=0
    ))  # fmt: skip


def test_a_deforming_mesh_is_simplified_once_in_24_frames(store):
    rest = sheet(30)
    for frame in range(24):
        moved = rest.positions + np.float32([0, 0, 0.01 * frame]) * rest.positions[:, :1]
        mesh = replace(rest, uid=next_uid(), positions=np.float32(moved))
        store.request([mesh], 200)
        store.finish()
        coarsest = store.ready(mesh.uid)[-1]
        assert np.abs(coarsest.bounds - mesh.bounds).max() < 0.03
        assert len(store.ready(mesh.uid)[0].merged) == len(mesh.positions)
    assert (store.decimations, store.replays) == (1, 23)


def test_another_shape_of_the_same_triangles_is_simplified_anew(store):
    flat = sheet(30, lift=0.0)
    store.request([flat], 200)
    store.finish()
    rough = np.random.default_rng(5).normal(size=len(flat.positions)) * 0.05
    other = flat.positions.copy()
    other[:, 2] = rough
    store.request([replace(flat, uid=next_uid(), positions=other)], 200)
    store.finish()
    assert store.decimations == 2


def test_large_meshes_come_back_from_disk_bit_by_bit(store, tmp_path):
    mesh = sheet(160)
    store.request([mesh], 2000)
    store.finish()
    again = LevelStore(folder=tmp_path / "levels")
    again.request([mesh], 2000)
    again.finish()
    assert (again.decimations, again.loads) == (0, 1)
    for a, b in zip(store.ready(mesh.uid), again.ready(mesh.uid), strict=True):
        assert a.positions.tobytes() == b.positions.tobytes()
        assert a.triangles.tobytes() == b.triangles.tobytes()
        assert a.places.tobytes() == b.places.tobytes()
        assert a.merged.tobytes() == b.merged.tobytes()


@pytest.mark.parametrize("damage", ["cut", "flipped", "text", "empty"])
def test_a_damaged_file_is_as_good_as_none(store, tmp_path, damage):
    mesh = sheet(160)
    store.request([mesh], 5000)
    store.finish()
    (path,) = (tmp_path / "levels").glob("*.npz")
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 0x10
    path.write_bytes(
        {
            "cut": content[: len(content) // 2],
            "flipped": content,
            "text": b"no levels",
            "empty": b"",
        }[damage]
    )
    again = LevelStore(folder=tmp_path / "levels")
    again.request([mesh], 5000)
    again.finish()
    assert (again.decimations, again.loads) == (1, 0)
    assert len(again.ready(mesh.uid)) == len(store.ready(mesh.uid))


def test_a_folder_that_cannot_be_made_does_no_harm(tmp_path):
    (tmp_path / "file").write_text("in the way")
    store = LevelStore(folder=tmp_path / "file" / "levels")
    mesh = sheet(160)
    store.request([mesh], 5000)
    store.finish()
    assert store.ready(mesh.uid)


def test_the_folder_stays_below_its_limit(tmp_path):
    store = LevelStore(folder=tmp_path, disk_limit=1_000_000)
    for lift in (0.01, 0.02, 0.03, 0.04):
        store.request([sheet(160, lift=lift, name=str(lift))], 8000)
        store.finish()
    assert 0 < sum(path.stat().st_size for path in tmp_path.iterdir()) <= 1_000_000


def test_memory_holds_what_is_requested_and_little_more(tmp_path):
    store = LevelStore(memory_limit=0, folder=tmp_path)
    first, second = sheet(30, "first"), sheet(40, "second")
    store.request([first], 200)
    store.finish()
    store.request([second], 200)
    store.finish()
    of_second = store.memory_bytes
    assert store.ready(first.uid) is None
    store.request([first, second], 200)
    store.finish()
    assert store.ready(first.uid) and store.ready(second.uid)
    assert store.memory_bytes > of_second


def test_cancelling_gives_up_and_a_later_finish_completes(store):
    meshes = [sheet(60 + i, str(i)) for i in range(6)]
    store.request(meshes, 200)
    with pytest.raises(RenderCancelledError):
        store.finish(cancelled=lambda: True)
    store.finish()
    assert all(store.ready(mesh.uid) for mesh in meshes)


def test_progress_grows_to_its_total(store):
    meshes = [sheet(60 + i, str(i)) for i in range(4)]
    seen = []
    store.request(meshes, 200)
    store.finish(progress=lambda done, total: seen.append((done, total)))
    done = [d for d, _ in seen]
    assert done == sorted(done)
    assert seen[-1] == (sum(len(mesh.triangles) for mesh in meshes),) * 2


def test_closing_ends_the_thread_before_all_is_made(store):
    store.request([sheet(200 + i, str(i)) for i in range(8)], 200)
    store.close()
    assert not store.busy
    assert store.decimations < 8


def test_rebuild_makes_the_levels_again(store):
    mesh = sheet(160)
    store.request([mesh], 5000)
    store.finish()
    old = store.ready(mesh.uid)
    store.rebuild()
    store.finish()
    assert store.decimations == 2
    assert store.ready(mesh.uid) is not old


def test_fewer_least_triangles_give_more_levels(store):
    mesh = sheet(30)
    store.request([mesh], 800)
    store.finish()
    few = store.ready(mesh.uid)
    store.request([mesh], 200)
    store.finish()
    assert len(store.ready(mesh.uid)) > len(few)


def test_an_error_in_the_thread_reaches_the_waiting_caller(store, monkeypatch):
    def fail(*_):
        raise MemoryError("too large")

    monkeypatch.setattr("addon.engine.level_store.simplify", fail)
    store.request([sheet(30)], 200)
    with pytest.raises(MemoryError):
        store.finish()


def test_the_cache_folder_can_be_chosen(monkeypatch, tmp_path):
    monkeypatch.setenv("APLANAT_CACHE", str(tmp_path))
    assert cache_folder("levels") == tmp_path / "levels"
    monkeypatch.delenv("APLANAT_CACHE")
    assert cache_folder("levels").parts[-2:] == ("aplanat", "levels")


def test_files_of_another_version_are_not_read(tmp_path, monkeypatch):
    files = LevelFiles(tmp_path, 1 << 20)
    files.write("key", ())
    assert files.read("key") == ()
    monkeypatch.setattr("addon.engine.level_files._VERSION", 0)
    assert files.read("key") is None
