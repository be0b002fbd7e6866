"""How many lens samples to draw at a time, so that a stretch of work takes about a given time."""

import time


class Pacer:
    """Finds the number of samples that fill a time.

    Parameters
    ----------
    seconds : float
        How long a stretch may take; one sample is drawn even if it takes longer.

    Attributes
    ----------
    samples : int
        To draw next.
    """

    # A first sample compiles and uploads, so a measurement may be far off in either direction.
    _LARGEST_GROWTH = 4

    def __init__(self, seconds):
        self.seconds = seconds
        self.samples = 1

    def measured(self, samples, seconds):
        """Learn from a stretch of `samples` that took `seconds`."""
        if samples < 1:
            return
        fitting = int(self.seconds * samples / max(seconds, 1e-6))
        self.samples = max(1, min(fitting, self._LARGEST_GROWTH * samples))

    def advance(self, renderer):
        """Draw one stretch with a `FrameRenderer` and wait for the device."""
        start = time.perf_counter()
        before = renderer.samples_done
        renderer.advance(self.samples)
        renderer.wait()
        self.measured(renderer.samples_done - before, time.perf_counter() - start)
