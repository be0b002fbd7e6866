"""Pacing: the number of lens samples to draw at a time, so that a batch takes a given time."""

import time


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

    def advance(self, renderer):
        """Draw one batch with a `FrameRenderer` and wait for the device."""
        start = time.perf_counter()
        before = renderer.samples_done
        renderer.advance(self.samples)
        renderer.wait()
        self.measured(renderer.samples_done - before, time.perf_counter() - start)
