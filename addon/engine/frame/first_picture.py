"""The first picture of a view: the lens before its samples.

A single drawing from the lens' middle is blurred over the whole lens, as lens samples are over
their parts of it (`subsampling`): highlights and all. What is hidden from the lens' middle is
missing: the surfaces beside it are continued there. It takes about as long as a sample, and nothing
of it remains in the samples' picture, which takes its place as soon as they cover the lens.
"""

from dataclasses import replace

from ...sampling.subsamples import FIRST_INTERVAL
from ..planning.plan import plan_frame
from ..planning.quality import largest_coc
from .pipeline import FrameRenderer

# Places on the lens besides its middle.
_PLACES = 16
# Radius of the circle of confusion below which a sample is as good as the lens, px.
_LEAST_BLUR = 0.5


def plan_first_picture(snapshot):
    """Plan the first picture of a frame.

    Parameters
    ----------
    snapshot : SceneSnapshot

    Returns
    -------
    FramePlan or None
        None where nothing is blurred.
    """
    # Of the colours of chromatic aberration one sample has but one; highlights that are not split
    # off need no search.
    camera = replace(snapshot.camera, bokeh=None, chromatic=None)
    sampling = replace(
        snapshot.sampling,
        method="ADAPTIVE",
        lens_samples=1,
        subsamples=_PLACES,
        target_error=None,
        time_limit=None,
        reuse_grid=0,
        uses_levels=snapshot.sampling.uses_levels and snapshot.sampling.method == "ADAPTIVE",
        progressive=False,
    )
    plan = plan_frame(replace(snapshot, camera=camera, sampling=sampling, passes=("Combined",)))
    blurred = plan.blurs and largest_coc(snapshot.content, plan) >= _LEAST_BLUR
    return plan if blurred else None


class FirstPicture:
    """Draws the first pictures of a view, one after the other.

    Parameters
    ----------
    buffers : SceneBuffers

    Attributes
    ----------
    renderer : FrameRenderer or None
        Of the picture of this frame; None where it has none.
    """

    def __init__(self, buffers):
        self._buffers = buffers
        self._renderer = self.renderer = None

    def draw(self, snapshot, plan):
        """Draw the first picture of a frame.

        Parameters
        ----------
        snapshot : SceneSnapshot
            The buffers must be updated to its content.
        plan : FramePlan or None
            Of `plan_first_picture`.
        """
        self.renderer = None
        if plan is None:
            return
        if self._renderer is None:
            self._renderer = FrameRenderer(plan, snapshot, self._buffers)
        else:
            self._renderer.restart(plan, snapshot)
        self.renderer = self._renderer
        self.renderer.advance(1)
        self.renderer.wait()

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
