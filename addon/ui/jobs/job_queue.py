"""A queue of background jobs: one thread, one job at a time, results fetched by the caller.

A job is a function of numpy and files only; it never touches Blender. The thread ends when nothing
is left to do.
"""

import threading
from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field


@dataclass(eq=False)
class Job:
    """A piece of work.

    Parameters
    ----------
    key : hashable
        Jobs with the same key are the same job.
    label : str
        What is being made, for the user.
    work : callable
        ``work(progress, cancelled)``: tells its share done by ``progress(0..1)``, ends soon, with
        any result or error, when ``cancelled()`` is true.
    group : hashable
        Of the waiting jobs of a group only the last is kept; None: no group.
    """

    key: Hashable
    label: str
    work: Callable
    group: Hashable = None
    share: float = 0.0
    cancelled: threading.Event = field(default_factory=threading.Event)

    def _tell(self, share):
        self.share = min(max(float(share), 0.0), 1.0)


@dataclass(frozen=True, eq=False)
class Outcome:
    """The outcome of a job.

    Parameters
    ----------
    key : hashable
    result : object
        What the work returned.
    error : Exception or None
    """

    key: Hashable
    result: object = None
    error: Exception | None = None


@dataclass(frozen=True)
class Progress:
    """Progress of the queue.

    Parameters
    ----------
    label : str
        Of the current job.
    share : float
        Share done of all jobs since the queue was last empty, 0 to 1.
    left : int
        Jobs that are not done.
    """

    label: str
    share: float
    left: int


class JobQueue:
    """Jobs for one background thread, which starts with the first of them."""

    def __init__(self):
        self._lock = threading.Lock()
        self._waiting = deque()
        self._current = None
        self._outcomes = []
        self._done = 0
        self._thread = None

    def submit(self, key, label, work, urgent=False, group=None):
        """Submit a job, unless it is waiting or running.

        Parameters
        ----------
        key : hashable
        label : str
        work : callable
            See `Job`.
        urgent : bool
            Goes before all waiting jobs; a waiting one moves to the front.
        group : hashable
            Replaces the waiting jobs of its group.
        """
        with self._lock:
            current = self._current
            if current is not None and current.key == key and not current.cancelled.is_set():
                return
            waiting = next((job for job in self._waiting if job.key == key), None)
            if waiting is None:
                waiting = Job(key, label, work, group)
                if group is not None:
                    self._waiting = deque(job for job in self._waiting if job.group != group)
            elif urgent:
                self._waiting.remove(waiting)
            else:
                return
            (self._waiting.appendleft if urgent else self._waiting.append)(waiting)
            if self._thread is None:
                # A daemon: a job that does not hear of the end must not keep the program from it.
                self._thread = threading.Thread(
                    target=self._run, name="aplanat-background", daemon=True
                )
                self._thread.start()

    def progress(self):
        """Return the progress of the queue.

        Returns
        -------
        Progress or None
            None if there is nothing to do.
        """
        with self._lock:
            if self._current is None and not self._waiting:
                return None
            current = self._current or self._waiting[0]
            left = len(self._waiting) + (self._current is not None)
            share = (self._done + current.share) / (self._done + left)
            return Progress(current.label, share, left)

    def fetch(self):
        """Return the outcomes since the last call, without cancelled jobs.

        Returns
        -------
        list of Outcome
        """
        with self._lock:
            outcomes, self._outcomes = self._outcomes, []
            return outcomes

    def cancel(self):
        """Drop the waiting jobs, and tell the running one to end."""
        with self._lock:
            self._waiting.clear()
            self._outcomes = []
            if self._current is not None:
                self._current.cancelled.set()

    def close(self, seconds):
        """Cancel everything and wait for the thread to end.

        Parameters
        ----------
        seconds : float
            At most.

        Returns
        -------
        bool
            Whether it ended.
        """
        self.cancel()
        thread = self._thread
        if thread is not None:
            thread.join(seconds)
        return thread is None or not thread.is_alive()

    def _run(self):
        while job := self._next():
            result = error = None
            try:
                result = job.work(job._tell, job.cancelled.is_set)
            # Whatever it is, the thread that asked must hear of it.
            except Exception as failure:
                error = failure
            with self._lock:
                self._current = None
                self._done += 1
                if not job.cancelled.is_set():
                    self._outcomes.append(Outcome(job.key, result, error))

    def _next(self):
        with self._lock:
            if not self._waiting:
                self._thread, self._done = None, 0
                return None
            self._current = self._waiting.popleft()
            return self._current
