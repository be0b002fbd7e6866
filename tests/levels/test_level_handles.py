"""Viewports and final renders ask for levels of detail at once: none is in another's way."""

import gc
import threading
import time

import pytest

from addon.errors import RenderCancelledError
from addon.levels import level_making
from addon.levels.level_store import LevelStore

from .test_level_store import sheet


@pytest.fixture
def store(tmp_path):
    store = LevelStore(folder=tmp_path / "levels")
    yield store
    store.close()


class Gate:
    """Holds the work on meshes of one name until it is opened."""

    def __init__(self, monkeypatch, name):
        self._name = name
        self._simplify = level_making.simplify
        self.begun, self.opened = threading.Event(), threading.Event()
        monkeypatch.setattr(level_making, "simplify", self.simplify)

    def simplify(self, mesh, least_triangles, check, seams):
        if mesh.name == self._name:
            self.begun.set()
            while not self.opened.wait(0.01):
                check(0)
        return self._simplify(mesh, least_triangles, check, seams)


@pytest.fixture
def gate(monkeypatch):
    gate = Gate(monkeypatch, "slow")
    yield gate
    gate.opened.set()


def wait_until(condition):
    end = time.monotonic() + 20.0
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


def test_a_request_takes_nothing_from_another_handle(store):
    final, viewport = store.open(), store.open()
    mine, theirs = sheet(40), sheet(30)
    final.request([mine], 200)
    viewport.request([theirs], 300)
    final.finish()
    viewport.finish()
    assert final.ready(mine.uid) and final.ready(theirs.uid) is None
    assert viewport.ready(theirs.uid) and viewport.ready(mine.uid) is None


def test_handles_with_other_least_triangles_have_their_own_levels(store):
    fine, coarse = store.open(), store.open()
    mesh = sheet(30)
    fine.request([mesh], 200)
    coarse.request([mesh], 800)
    fine.finish()
    coarse.finish()
    assert len(fine.ready(mesh.uid)) > len(coarse.ready(mesh.uid)) > 0


def test_what_one_handle_had_made_is_there_for_the_next(store):
    mesh = sheet(30)
    with store.open() as first:
        first.request([mesh], 200)
        first.finish()
    with store.open() as second:
        second.request([sheet(30)], 200)
        second.finish()
        assert second.work.decimations == 0
    assert store.work.decimations == 1


def test_an_error_stays_with_the_handle_that_asked(store, monkeypatch):
    simplify = level_making.simplify

    def fail(mesh, *arguments):
        if mesh.name == "bad":
            raise MemoryError("too large")
        return simplify(mesh, *arguments)

    monkeypatch.setattr(level_making, "simplify", fail)
    viewport, final = store.open(), store.open()
    viewport.request([sheet(30, "bad"), sheet(31, "good")], 200)
    wait_until(lambda: not store.busy)
    assert isinstance(viewport.error, MemoryError)
    assert viewport.progress[0] == viewport.progress[1]
    mesh = sheet(40)
    final.request([mesh], 200)
    final.finish()
    assert final.ready(mesh.uid) and final.error is None
    with pytest.raises(MemoryError):
        viewport.finish()
    # What is not asked for any more has no error.
    viewport.request([mesh], 200)
    viewport.finish()
    assert viewport.error is None


def test_who_waits_comes_before_who_does_not(store, gate):
    viewport, final = store.open(), store.open()
    crowd = [sheet(20 + i, str(i)) for i in range(12)]
    viewport.request([sheet(10, "slow"), *crowd], 50)
    assert gate.begun.wait(10)
    mesh = sheet(60)
    final.request([mesh], 200)
    waiting = threading.Thread(target=final.finish)
    waiting.start()
    wait_until(lambda: final._client.waits)
    gate.opened.set()
    waiting.join(20)
    assert final.ready(mesh.uid)
    assert any(viewport.ready(other.uid) is None for other in crowd)


def test_after_a_cancel_nothing_is_left_to_do_and_the_other_handle_goes_on(store, gate):
    final, viewport = store.open(), store.open()
    final.request([sheet(30, "slow"), sheet(40)], 200)
    assert gate.begun.wait(10)
    mesh = sheet(35)
    viewport.request([mesh], 200)
    with pytest.raises(RenderCancelledError):
        final.finish(cancelled=lambda: True)
    assert final.progress == (0, 0)
    # What only the cancelled one needed is given up, though its gate never opens.
    viewport.finish()
    assert viewport.ready(mesh.uid)
    assert store.progress == viewport.progress == (len(mesh.triangles),) * 2


def test_closing_a_handle_ends_the_work_for_it(store, gate):
    handle = store.open()
    handle.request([sheet(30, "slow")], 200)
    assert gate.begun.wait(10)
    handle.close()
    wait_until(lambda: not store.busy)
    assert store.progress == (0, 0)


def test_a_handle_that_is_lost_closes_itself(store, gate):
    handle = store.open()
    handle.request([sheet(30, "slow")], 200)
    assert gate.begun.wait(10)
    del handle
    gc.collect()
    wait_until(lambda: not store.busy)
    assert store.progress == (0, 0)


def test_levels_in_use_by_any_handle_are_kept(tmp_path):
    store = LevelStore(memory_limit=0, folder=tmp_path)
    viewport, final = store.open(), store.open()
    mesh = sheet(30)
    viewport.request([mesh], 200)
    viewport.finish()
    kept = viewport.ready(mesh.uid)
    for count in (31, 32, 33):
        final.request([sheet(count)], 200)
        final.finish()
    assert viewport.ready(mesh.uid) is kept
    viewport.close()
    final.close()
    assert store.memory_bytes == 0


def test_eight_threads_ask_wait_cancel_and_rebuild_at_once(store):
    meshes = [sheet(14 + i, str(i)) for i in range(10)]
    expected = {}
    with store.open() as handle:
        handle.request(meshes, 50)
        handle.finish()
        expected = {m.uid: [len(level.triangles) for level in handle.ready(m.uid)] for m in meshes}
    failures = []

    def client(number):
        try:
            for turn in range(12):
                with store.open() as handle:
                    mine = [meshes[(number + turn + k) % len(meshes)] for k in range(4)]
                    handle.request(mine, 50)
                    if (number + turn) % 5 == 0:
                        store.rebuild()
                    if (number + turn) % 3 == 0:
                        with pytest.raises(RenderCancelledError):
                            asked = iter([False, True])
                            handle.finish(cancelled=lambda asked=asked: next(asked, True))
                            raise RenderCancelledError("done before it was asked")
                        assert handle.progress[0] == handle.progress[1]
                    handle.finish()
                    for mesh in mine:
                        levels = handle.ready(mesh.uid)
                        # Another thread may rebuild between the two calls.
                        if levels is not None:
                            assert [len(level.triangles) for level in levels] == expected[mesh.uid]
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=client, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert not failures and not any(thread.is_alive() for thread in threads)
    wait_until(lambda: not store.busy)
    assert store.progress == (0, 0)
