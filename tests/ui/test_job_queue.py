"""Background work: in order, once, cancellable, and nothing that fails is lost."""

import threading
import time

import pytest

from addon.ui.jobs.job_queue import JobQueue

# Seconds; nothing here takes a hundredth of it.
PATIENCE = 20.0


def wait_until(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "not in time"
        time.sleep(0.005)


@pytest.fixture
def queue():
    queue = JobQueue()
    yield queue
    assert queue.close(PATIENCE)


@pytest.fixture
def gate(queue):
    """A job at work that waits to be let through."""
    begun, opened = threading.Event(), threading.Event()

    def wait(progress, cancelled):
        begun.set()
        progress(0.5)
        while not opened.is_set() and not cancelled():
            time.sleep(0.002)

    queue.submit("gate", "Gate", wait)
    begun.wait(PATIENCE)
    return opened


def finish(queue):
    wait_until(lambda: queue.progress() is None)
    return queue.fetch()


def note(done, name):
    return lambda progress, cancelled: done.append(name) or name


def test_jobs_are_done_in_order_and_urgent_ones_first(queue, gate):
    done = []
    for name in "abc":
        queue.submit(name, name, note(done, name), urgent=name == "c")
    queue.submit("b", "b", note(done, "again"), urgent=True)
    gate.set()
    outcomes = finish(queue)
    assert done == ["b", "c", "a"]
    assert [outcome.result for outcome in outcomes if outcome.key != "gate"] == done


def test_the_same_job_is_done_once(queue, gate):
    done = []
    for _ in range(5):
        queue.submit("a", "a", note(done, "a"))
    queue.submit("gate", "Gate", note(done, "gate"))
    gate.set()
    finish(queue)
    assert done == ["a"]


def test_of_a_group_that_waits_the_last_one_is_done(queue, gate):
    done = []
    for number in range(5):
        queue.submit(number, "f-number", note(done, number), group="bokeh")
    queue.submit("other", "other", note(done, "other"))
    gate.set()
    finish(queue)
    assert done == [4, "other"]


def test_a_failure_is_an_outcome_and_the_next_job_is_done(queue, gate):
    def fail(progress, cancelled):
        raise ValueError("no")

    queue.submit("bad", "bad", fail)
    queue.submit("good", "good", lambda progress, cancelled: 7)
    gate.set()
    outcomes = {outcome.key: outcome for outcome in finish(queue)}
    assert isinstance(outcomes["bad"].error, ValueError)
    assert outcomes["good"].result == 7


def test_progress_is_that_of_all_jobs(queue, gate):
    queue.submit("a", "a", lambda progress, cancelled: None)
    progress = queue.progress()
    assert (progress.label, progress.left) == ("Gate", 2)
    assert progress.share == pytest.approx(0.25)
    gate.set()
    finish(queue)
    assert queue.progress() is None


def test_cancel_ends_the_job_at_work_and_drops_what_waits(queue, gate):
    done = []
    queue.submit("a", "a", note(done, "a"))
    queue.cancel()
    assert finish(queue) == [] and done == []
    queue.submit("gate", "Gate", note(done, "once more"))
    finish(queue)
    assert done == ["once more"]


def test_the_thread_ends_with_the_work(queue):
    queue.submit("a", "a", lambda progress, cancelled: None)
    finish(queue)
    wait_until(lambda: all(t.name != "aplanat-background" for t in threading.enumerate()))
