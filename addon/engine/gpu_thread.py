"""The thread in which the GPU work of a final render runs.

In background mode the render thread owns the GPU context and works in it. In the user interface it
must not own it, or Blender freezes until the render ends: there the work is cut into slices of
some 50 ms, and Blender's main thread, which owns the windows' GPU contexts, runs one slice in each
cycle of its event loop (a timer) while the render thread waits.

Work is a generator whose steps are short; its return value is passed on. Callers do not see which
thread works.
"""

import queue
import threading
import time
from concurrent.futures import Future, wait

from ..device import keeping
from ..errors import RenderCancelledError

# Seconds between the checks of a waiting render whether it was stopped.
_POLL_SECONDS = 0.05
# Seconds that the main thread may take to begin the last piece of work.
_FAREWELL_SECONDS = 1.0
_IDLE_SECONDS = 0.1

_jobs = queue.SimpleQueue()
_renders = 0
_renders_lock = threading.Lock()


class _Slices:
    """A generator that is run in slices of time."""

    def __init__(self, steps, seconds):
        self._steps = steps
        self._seconds = seconds
        self.result = None

    def advance(self):
        """Run one slice; return whether the generator has ended."""
        end = time.perf_counter() + self._seconds
        while True:
            try:
                next(self._steps)
            except StopIteration as stop:
                self.result = stop.value
                return True
            if time.perf_counter() >= end:
                return False

    def close(self):
        self._steps.close()


class OwnThreadGpu:
    """Runs GPU work in the calling thread.

    Parameters
    ----------
    should_stop : callable
        Returns whether the user stopped the render; called after every slice.
    slice_seconds : float
        Duration of a slice.
    """

    def __init__(self, should_stop, slice_seconds):
        self._should_stop = should_stop
        self.slice_seconds = slice_seconds

    def __enter__(self):
        """Begin the render."""
        return self

    def __exit__(self, *exception):
        """End the render."""

    def call(self, work):
        """Run a function that takes about as long as a slice; return its result.

        Raises
        ------
        RenderCancelledError
            If the render was stopped.
        """
        result = work()
        self._raise_if_stopped()
        return result

    def run(self, steps):
        """Run a generator to its end, slice by slice.

        Parameters
        ----------
        steps : generator
            Its steps must be short compared with a slice.

        Returns
        -------
        object
            The generator's return value.

        Raises
        ------
        RenderCancelledError
            If the render was stopped; the generator has been closed.
        """
        slices = _Slices(steps, self.slice_seconds)
        try:
            while not self.call(slices.advance):
                pass
        finally:
            self.release(slices.close)
        return slices.result

    def release(self, work):
        """Call a function that gives something back; stopped or not, it is called."""
        work()

    def _raise_if_stopped(self):
        if self._should_stop():
            raise RenderCancelledError("the render was stopped")


class MainThreadGpu(OwnThreadGpu):
    """Runs GPU work in Blender's main thread."""

    def __enter__(self):
        """Make the main thread look for work in every cycle."""
        _count_renders(+1)
        return self

    def __exit__(self, *exception):
        """Let the main thread look for work less often."""
        _count_renders(-1)

    def call(self, work):
        """Run a function that takes about as long as a slice; see `OwnThreadGpu.call`."""
        job = _submit(work)
        while not wait([job], _POLL_SECONDS).done:
            # Work that has begun is waited for; it cannot be interrupted.
            if self._should_stop() and job.cancel():
                break
        self._raise_if_stopped()
        return job.result()

    def release(self, work):
        """Call a function that gives something back; stopped or not, it is called."""
        job = _submit(work)
        wait([job], _FAREWELL_SECONDS)
        if job.cancel():
            # The main thread is waiting for this render to end (Blender quits, a file opens).
            # Memory on the device may be released in any thread.
            work()
        else:
            job.result()


def gpu_of_render(should_stop, slice_seconds, in_background):
    """Return the runner of the GPU work of a render that was started in this thread.

    Parameters
    ----------
    should_stop : callable
        Returns whether the user stopped the render.
    slice_seconds : float
        Duration of a slice.
    in_background : bool
        Blender has no user interface.

    Returns
    -------
    OwnThreadGpu or MainThreadGpu
    """
    # A script's render without its own thread blocks the main thread, which owns the GPU.
    if in_background or threading.current_thread() is threading.main_thread():
        return OwnThreadGpu(should_stop, slice_seconds)
    return MainThreadGpu(should_stop, slice_seconds)


def work_off_one_job():
    """Run one slice of a waiting job, or without one release what nobody needs; a timer of Blender.

    Returns
    -------
    float
        Seconds until it wants to be called again.
    """
    try:
        job, work = _jobs.get_nowait()
    except queue.Empty:
        if _renders:
            return 0.0
        # What a session or a 3D view has left to the device, wherever it was dropped.
        keeping.let_go()
        return _IDLE_SECONDS
    if job.set_running_or_notify_cancel():
        try:
            job.set_result(work())
        # Any error is passed to the waiting render thread, which raises it again.
        except BaseException as error:
            job.set_exception(error)
    return 0.0


def _submit(work):
    job = Future()
    _jobs.put((job, work))
    return job


def _count_renders(change):
    global _renders
    with _renders_lock:
        _renders += change
