"""The first picture of a view: the lens before its samples.

A single drawing from the lens' middle is blurred over the whole lens, as lens samples are over
their parts of it (`subsampling`): highlights and all. What is hidden from the lens' middle is
missing: the surfaces beside it are continued there. It takes about as long as a sample, and nothing
of it remains in the samples' picture, which takes its place as soon as they cover the lens.
"""

import time

from ...sampling.subsamples import FIRST_INTERVAL
from .pacing import Coarseness
from .pipeline import FrameRenderer


class FirstPicture:
    """Draws the first pictures of a view, one after the other.

    Parameters
    ----------
    buffers : SceneBuffers

    Attributes
    ----------
    renderer : FrameRenderer or None
        Of the picture of this frame; None where it has none.
    pixels : Coarseness
        The size of its pixels.
    """

    def __init__(self, buffers):
        self._buffers = buffers
        self._renderer = self.renderer = None
        self.pixels = Coarseness()

    def draw(self, snapshot, plan, seconds=0.0, *stage):
        """Draw the first picture of a frame.

        Parameters
        ----------
        snapshot : SceneSnapshot
            The buffers must be updated to its content.
        plan : FramePlan or None
            Of `planning.plan.plan_first_picture`.
        seconds : float
            That it may take; `pixels` follow. 0 is any time.
        *stage : callable
            As that of `FrameRenderer.advance`.
        """
        self.renderer = None
        if plan is None:
            return
        start, is_new = time.perf_counter(), self._renderer is None
        if is_new:
            self._renderer = FrameRenderer(plan, snapshot, self._buffers)
        else:
            self._renderer.restart(plan, snapshot)
        self.renderer = self._renderer
        self.renderer.advance(1, *stage)
        self.renderer.wait()
        if not is_new:
            # The first of all compiles and uploads.
            self.pixels.measured(time.perf_counter() - start, seconds)

    def is_better_than(self, samples):
        """Whether it shows more of the lens than the samples of a frame so far.

        Parameters
        ----------
        samples : FrameRenderer
        """
        if self.renderer is None or samples.finished():
            return False
        return samples.bokeh_drafted or samples.samples_done < FIRST_INTERVAL

    def release(self):
        """Release its resources on the device; it cannot be used afterwards."""
        if self._renderer is not None:
            self._renderer.release()
        self._renderer = self.renderer = None
