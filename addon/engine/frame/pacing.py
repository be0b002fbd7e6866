"""Pacing: lens samples to draw at a time, and the size of pixels, so that it takes a given time."""

import time
from contextlib import contextmanager


class Pacer:
    """Adapts the number of samples of a batch to a duration.

    Parameters
    ----------
    seconds : float
        Duration of a batch; one sample is drawn even if it takes longer.

    Attributes
    ----------
    samples : int
        Number of samples of the next batch.
    """

    # A first sample compiles and uploads, so a measurement may be far off in either direction.
    _LARGEST_GROWTH = 4

    def __init__(self, seconds):
        self.seconds = seconds
        self.samples = 1

    def measured(self, samples, seconds):
        """Adapt to a batch of `samples` that took `seconds`."""
        if samples < 1:
            return
        fitting = int(self.seconds * samples / max(seconds, 1e-6))
        self.samples = max(1, min(fitting, self._LARGEST_GROWTH * samples))

    def advance(self, renderer, *stage):
        """Draw one batch with a `FrameRenderer`, whose `advance` gets `stage`; wait for the end."""
        start = time.perf_counter()
        before = renderer.samples_done
        renderer.advance(self.samples, *stage)
        renderer.wait()
        self.measured(renderer.samples_done - before, time.perf_counter() - start)


class Coarseness:
    """Finds how large the pixels of a picture must be for it to take a given time.

    Attributes
    ----------
    side : int
        Side of a pixel of the next picture, in pixels of the finest one: 1, 2 or 4.
    """

    _LARGEST = 4
    # Share of the time that larger pixels have to leave at most, or they are not worth their looks:
    # the time goes into the geometry.
    _WORTH = 0.67

    def __init__(self):
        self.side = 1
        self._finer = self._settled = None

    def measured(self, seconds, wanted):
        """Choose the next side by the time of a picture.

        Parameters
        ----------
        seconds : float
            That the picture with this side took.
        wanted : float
            That a picture may take; 0 is any time, with the finest pixels.
        """
        finer, self._finer = self._finer, None
        if not wanted:
            self.side, self._settled = 1, None
        elif finer is not None and seconds > self._WORTH * finer:
            self.side //= 2
            self._settled = finer
        elif self._settled is not None and 0.5 < seconds / self._settled < 2.0:
            return
        elif seconds > wanted and self.side < self._LARGEST:
            self.side *= 2
            self._finer, self._settled = seconds, None
        elif 4.0 * seconds <= wanted and self.side > 1:
            self.side //= 2


class StageTimes:
    """The time that the stages of redraws take, for a line of text.

    Parameters
    ----------
    wait : callable
        Waits until the device has finished.
    """

    def __init__(self, wait):
        self._wait = wait
        self._seconds = {}
        self._began = time.perf_counter()

    @contextmanager
    def stage(self, name):
        """Measure a `with` block as a part of a stage; stages within count on their own, too."""
        start = time.perf_counter()
        yield
        self._wait()
        self._seconds[name] = self._seconds.get(name, 0.0) + time.perf_counter() - start

    @property
    def text(self):
        """Redraws of this kind in a second, and the share of each stage."""
        whole = max(time.perf_counter() - self._began, 1e-6)
        parts = [f"{name} {seconds / whole:.0%}" for name, seconds in self._seconds.items()]
        return f"{1.0 / whole:.1f} redraws/s: {', '.join(parts)}"
