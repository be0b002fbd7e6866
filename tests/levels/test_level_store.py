"""Levels of detail of a scene: made once, shared, kept, given up."""

import threading
from dataclasses import replace

import numpy as np
import pytest

from addon.errors import RenderCancelledError
from addon.files.cache_folder import cache_folder
from addon.levels import level_making
from addon.levels.level_files import LevelFiles
from addon.levels.level_store import LevelStore
from addon.snapshot.content import MeshSnapshot, next_uid


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


@pytest.fixture
def handle(store):
    with store.open() as handle:
        yield handle


def made(folder, mesh, least_triangles):
    """Return the levels of a mesh in a new store, and the work that they took."""
    store = LevelStore(folder=folder)
    with store.open() as handle:
        handle.request([mesh], least_triangles)
        handle.finish()
        return handle.ready(mesh.uid), handle.work


def assert_same_levels(found, expected):
    assert len(found) == len(expected)
    for a, b in zip(found, expected, strict=True):
        assert a.slots == b.slots
        assert a.attributes.keys() == b.attributes.keys()
        arrays = [
            (getattr(a, n), getattr(b, n)) for n in ("positions", "triangles", "places", "merged")
        ]
        arrays += [(a.attributes[key], b.attributes[key]) for key in a.attributes]
        for x, y in arrays:
            assert x.dtype == y.dtype and x.shape == y.shape and x.tobytes() == y.tobytes()


def test_levels_are_there_after_finish_and_the_thread_is_gone(store, handle):
    mesh = sheet(30)
    handle.request([mesh], 200)
    handle.finish()
    counts = [len(level.triangles) for level in handle.ready(mesh.uid)]
    assert counts == pytest.approx([900, 450, 225], rel=0.1)
    assert store.memory_bytes > 0
    assert not store.busy
    assert "aplanat-levels" not in {thread.name for thread in threading.enumerate()}


def test_small_meshes_are_ready_at_once(store, handle):
    mesh = sheet(5)
    handle.request([mesh], 256)
    assert handle.ready(mesh.uid) == ()
    assert not store.busy


def test_what_was_not_requested_is_not_ready(store, handle):
    assert handle.ready(12345) is None
    handle.finish()


def test_equal_content_is_simplified_once(store, handle):
    mesh = sheet(30)
    twin = replace(mesh, uid=next_uid(), name="twin")
    handle.request([mesh, twin], 200)
    handle.finish()
    assert store.work.decimations == 1
    assert handle.ready(mesh.uid) is handle.ready(twin.uid)


def test_the_same_shape_in_other_colors_is_simplified_once(store, handle):
    mesh = sheet(30)
    red = np.tile(np.float32([1, 0, 0, 1]), (len(mesh.positions), 1))
    painted = replace(mesh, uid=next_uid(), name="painted", attributes={"color:": red})
    handle.request([mesh, painted], 200)
    handle.finish()
    assert (store.work.decimations, store.work.replays) == (1, 1)
    assert handle.ready(painted.uid)[0].attributes["color:"] == pytest.approx(red[:1].repeat(
        len(handle.ready(painted.uid)[0].positions), axis=0
    ))  # fmt: skip


def test_a_deforming_mesh_is_simplified_once_in_24_frames(store, handle):
    rest = sheet(30)
    for frame in range(24):
        moved = rest.positions + np.float32([0, 0, 0.01 * frame]) * rest.positions[:, :1]
        mesh = replace(
            rest,
            uid=next_uid(),
            positions=np.float32(moved),
            rest=rest.positions if frame else None,
        )
        handle.request([mesh], 200)
        handle.finish()
        coarsest = handle.ready(mesh.uid)[-1]
        assert np.abs(coarsest.bounds - mesh.bounds).max() < 0.03
        assert len(handle.ready(mesh.uid)[0].merged) == len(mesh.positions)
    assert (store.work.decimations, store.work.replays) == (1, 23)


def test_another_shape_of_the_same_triangles_is_simplified_anew(store, handle):
    flat = sheet(30, lift=0.0)
    handle.request([flat], 200)
    handle.finish()
    rough = np.random.default_rng(5).normal(size=len(flat.positions)) * 0.05
    other = flat.positions.copy()
    other[:, 2] = rough
    handle.request([replace(flat, uid=next_uid(), positions=other, rest=flat.positions)], 200)
    handle.finish()
    assert store.work.decimations == 2


def test_large_meshes_come_back_from_disk_bit_by_bit(store, handle, tmp_path):
    mesh = sheet(160)
    handle.request([mesh], 2000)
    handle.finish()
    again, work = made(tmp_path / "levels", mesh, 2000)
    assert (work.decimations, work.loads) == (0, 1)
    assert_same_levels(again, handle.ready(mesh.uid))


@pytest.mark.parametrize("damage", ["cut", "flipped", "text", "empty"])
def test_a_damaged_file_is_as_good_as_none(store, handle, tmp_path, damage):
    mesh = sheet(160)
    handle.request([mesh], 5000)
    handle.finish()
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
    again, work = made(tmp_path / "levels", mesh, 5000)
    assert (work.decimations, work.loads) == (1, 0)
    assert_same_levels(again, handle.ready(mesh.uid))


def test_a_folder_that_cannot_be_made_does_no_harm(tmp_path):
    (tmp_path / "file").write_text("in the way")
    levels, _ = made(tmp_path / "file" / "levels", sheet(160), 5000)
    assert levels


def test_the_folder_stays_below_its_limit(tmp_path):
    handle = LevelStore(folder=tmp_path, disk_limit=1_000_000).open()
    for lift in (0.01, 0.02, 0.03, 0.04):
        handle.request([sheet(160, lift=lift, name=str(lift))], 8000)
        handle.finish()
    assert 0 < sum(path.stat().st_size for path in tmp_path.iterdir()) <= 1_000_000


def test_memory_holds_what_is_requested_and_little_more(tmp_path):
    store = LevelStore(memory_limit=0, folder=tmp_path)
    handle = store.open()
    first, second = sheet(30, "first"), sheet(40, "second")
    handle.request([first], 200)
    handle.finish()
    handle.request([second], 200)
    handle.finish()
    of_second = store.memory_bytes
    assert handle.ready(first.uid) is None
    handle.request([first, second], 200)
    handle.finish()
    assert handle.ready(first.uid) and handle.ready(second.uid)
    assert store.memory_bytes > of_second


def test_cancelling_gives_up_and_a_later_finish_completes(store, handle):
    meshes = [sheet(60 + i, str(i)) for i in range(6)]
    handle.request(meshes, 200)
    with pytest.raises(RenderCancelledError):
        handle.finish(cancelled=lambda: True)
    assert handle.progress == (0, 0)
    handle.finish()
    assert all(handle.ready(mesh.uid) for mesh in meshes)


def test_progress_grows_to_its_total(store, handle):
    meshes = [sheet(60 + i, str(i)) for i in range(4)]
    seen = []
    handle.request(meshes, 200)
    handle.finish(progress=lambda done, total: seen.append((done, total)))
    done = [d for d, _ in seen]
    assert done == sorted(done)
    assert seen[-1] == (sum(len(mesh.triangles) for mesh in meshes),) * 2


def test_closing_ends_the_thread_before_all_is_made(store, handle):
    handle.request([sheet(200 + i, str(i)) for i in range(8)], 200)
    store.close()
    assert not store.busy
    assert store.work.decimations < 8


def test_rebuild_makes_the_levels_again_with_nothing_from_memory_or_disk(store, handle, tmp_path):
    mesh = sheet(160)
    handle.request([mesh], 5000)
    handle.finish()
    old, before = handle.ready(mesh.uid), store.generation
    # Of a mesh that no scene shows any more, and that this process knows nothing of.
    made(tmp_path / "levels", sheet(170), 5000)
    store.rebuild()
    assert handle.ready(mesh.uid) is None
    handle.finish()
    assert (store.work.decimations, store.work.loads) == (2, 0)
    assert handle.ready(mesh.uid) is not old
    assert_same_levels(handle.ready(mesh.uid), old)
    assert store.generation == before + 1
    assert len(list((tmp_path / "levels").iterdir())) == 1


def test_what_is_made_while_all_is_rebuilt_is_made_again(store, handle, monkeypatch):
    begun, go_on = threading.Event(), threading.Event()
    simplify = level_making.simplify

    def slow(*arguments):
        begun.set()
        go_on.wait(10)
        return simplify(*arguments)

    monkeypatch.setattr(level_making, "simplify", slow)
    mesh = sheet(30)
    handle.request([mesh], 200)
    assert begun.wait(10)
    store.rebuild()
    go_on.set()
    handle.finish()
    assert handle.ready(mesh.uid)
    # The first ends without levels, or they are not kept.
    assert store.work.decimations <= 2 and handle.progress[0] == handle.progress[1]


def test_fewer_least_triangles_give_more_levels(store, handle):
    mesh = sheet(30)
    handle.request([mesh], 800)
    handle.finish()
    few = handle.ready(mesh.uid)
    handle.request([mesh], 200)
    handle.finish()
    assert len(handle.ready(mesh.uid)) > len(few)


def test_an_error_in_the_thread_reaches_the_waiting_caller(store, handle, monkeypatch):
    def fail(*_):
        raise MemoryError("too large")

    monkeypatch.setattr(level_making, "simplify", fail)
    handle.request([sheet(30)], 200)
    with pytest.raises(MemoryError):
        handle.finish()


def test_the_cache_folder_can_be_chosen(monkeypatch, tmp_path):
    monkeypatch.setenv("APLANAT_CACHE", str(tmp_path))
    assert cache_folder("levels") == tmp_path / "levels"
    monkeypatch.delenv("APLANAT_CACHE")
    assert cache_folder("levels").parts[-2:] == ("aplanat", "levels")


def test_files_of_another_version_are_not_read(tmp_path, monkeypatch):
    files = LevelFiles(tmp_path, 1 << 20)
    files.write("key", (), 0.75)
    assert files.read("key") == ((), 0.75)
    monkeypatch.setattr("addon.levels.level_files._VERSION", 0)
    assert files.read("key") is None
