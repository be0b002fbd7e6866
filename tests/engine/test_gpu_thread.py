"""Handing GPU work from a render's thread to the main thread, without Blender."""

import threading
import time

import pytest

from addon.device import keeping
from addon.engine import gpu_thread
from addon.engine.gpu_thread import MainThreadGpu, OwnThreadGpu, gpu_of_render
from addon.errors import RenderCancelledError


def run_beside_a_main_loop(work, main_loop=True, seconds=20.0):
    """Run a function in a thread while this one plays Blender's main loop."""
    outcome = {}

    def render():
        try:
            outcome["result"] = work()
        except BaseException as error:
            outcome["error"] = error

    thread = threading.Thread(target=render)
    thread.start()
    end = time.monotonic() + seconds
    while thread.is_alive() and time.monotonic() < end:
        if main_loop:
            gpu_thread.work_off_one_job()
        time.sleep(0.001)
    assert not thread.is_alive()
    return outcome


def steps(done, count=5):
    try:
        for _ in range(count):
            done.append(threading.get_ident())
            yield
        return "result"
    finally:
        done.append("closed")


def render_with(gpu, work):
    def render():
        with gpu:
            return gpu.run(work)

    return render


def test_main_thread_does_the_work_slice_by_slice():
    done = []
    outcome = run_beside_a_main_loop(
        render_with(MainThreadGpu(lambda: False, slice_seconds=0.0), steps(done))
    )
    assert outcome == {"result": "result"}
    assert done == [threading.get_ident()] * 5 + ["closed"]


def test_own_thread_does_the_work():
    done = []
    with OwnThreadGpu(lambda: False, 0.05) as gpu:
        assert gpu.run(steps(done)) == "result"
    assert done == [threading.get_ident()] * 5 + ["closed"]


@pytest.mark.parametrize("kind", [OwnThreadGpu, MainThreadGpu])
def test_stopping_closes_the_work(kind):
    done = []
    gpu = kind(lambda: len(done) >= 2, slice_seconds=0.0)
    outcome = run_beside_a_main_loop(render_with(gpu, steps(done, 10**9)))
    assert isinstance(outcome["error"], RenderCancelledError)
    assert done[-1] == "closed"
    assert len(done) < 10


def test_exceptions_reach_the_thread_that_waits():
    def broken():
        raise ZeroDivisionError
        yield

    gpu = MainThreadGpu(lambda: False, 0.05)
    outcome = run_beside_a_main_loop(render_with(gpu, broken()))
    assert isinstance(outcome["error"], ZeroDivisionError)


def test_main_thread_that_waits_for_the_render_is_not_waited_for_forever():
    done = []
    start = time.monotonic()
    gpu = MainThreadGpu(lambda: time.monotonic() - start > 0.2, 0.05)
    outcome = run_beside_a_main_loop(render_with(gpu, steps(done)), main_loop=False)
    assert isinstance(outcome["error"], RenderCancelledError)
    # Asked every 50 ms, then a second of hope that the main thread takes the last piece.
    assert time.monotonic() - start < 3.0
    while gpu_thread.work_off_one_job() == 0.0:
        assert not done, "work that was taken back was done"
    assert gpu_thread.work_off_one_job() > 0.0


def test_main_thread_looks_often_only_while_a_render_runs():
    idle = gpu_thread.work_off_one_job()
    with MainThreadGpu(lambda: False, 0.05):
        assert gpu_thread.work_off_one_job() == 0.0
    assert gpu_thread.work_off_one_job() == idle > 0.0


def test_script_that_renders_in_the_main_thread_is_not_deadlocked():
    assert type(gpu_of_render(bool, 0.05, in_background=False)) is OwnThreadGpu
    assert type(gpu_of_render(bool, 0.05, in_background=True)) is OwnThreadGpu
    outcome = run_beside_a_main_loop(
        lambda: type(gpu_of_render(bool, 0.05, in_background=False)), main_loop=False
    )
    assert outcome == {"result": MainThreadGpu}


def test_what_was_dropped_is_given_back_when_the_main_thread_is_idle(monkeypatch):
    monkeypatch.setattr(keeping, "_owner", threading.get_ident())
    monkeypatch.setattr(keeping, "_held", [])
    dropped = keeping.keep(object())
    needed = object()
    held = keeping.keep(needed)
    gpu_thread.work_off_one_job()
    assert (dropped, held) == ([], [needed])
