"""Frames with bokeh for `aplanat bench --bokeh`: passes, counts and times of the steps."""

from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace

import numpy as np

from addon.engine.frame.pipeline import FrameRenderer
from addon.engine.planning.plan import plan_frame
from addon.engine.visibility.stage import BokehVisibility

from ..benches.frames import BenchScene, timed

PASSES = ("Combined", "Defocus", "Bokeh")


@dataclass(frozen=True, eq=False)
class BokehFrame:
    """A frame that was drawn with its highlights apart.

    Parameters
    ----------
    passes : dict of str to ndarray of shape (height, width, 4)
        `PASSES`, top row first.
    seconds : dict of str to float
        ``prepare``, ``bokeh`` and of it ``search``, ``merge``, ``visibility`` and ``splat``;
        ``frame`` for all of it, levels of detail not counted.
    highlights : dict of str to int
        Counts of `HighlightCounts`.
    visibility : dict of str to int or str
        Counts of `VisibilityCounts`; empty where there are no sources.
    """

    passes: dict[str, np.ndarray]
    seconds: dict[str, float]
    highlights: dict[str, int]
    visibility: dict[str, int | str]

    @property
    def picture(self):
        """Combined without alpha."""
        return self.passes["Combined"][..., :3]

    @property
    def bokeh(self):
        """The bokeh without alpha."""
        return self.passes["Bokeh"][..., :3]


class BokehScene(BenchScene):
    """The current scene, drawn with and without its highlights apart; as `BenchScene`."""

    def __init__(self, scene):
        scene.camera.data.aplanat.bokeh.use = True
        super().__init__(scene)

    def splatted(self, samples, subsamples=4, method="ADAPTIVE", **bokeh):
        """Return the snapshot with highlights apart; settings as those of `BokehSettings`."""
        snapshot = self.sampled(method, samples, subsamples=subsamples, reference_bokeh=True)
        settings = replace(self.snapshot.camera.bokeh, **bokeh)
        camera = replace(snapshot.camera, bokeh=settings)
        return replace(snapshot, camera=camera, passes=PASSES)

    def plain(self, samples, method="REFERENCE", **settings):
        """Return the snapshot with highlights sampled as everything else."""
        snapshot = self.sampled(method, samples, **settings)
        return replace(snapshot, passes=PASSES)

    def draw_passes(self, snapshot, culls=True, progress=None):
        """Draw a frame and tell the steps of its bokeh apart.

        Parameters
        ----------
        snapshot : SceneSnapshot
            Of `splatted` or `plain`.
        culls : bool
            False: every highlight gets a mask.
        progress : callable, optional
            Called with the number of samples done.

        Returns
        -------
        BokehFrame
        """
        seconds, heard = {}, []
        with _listening(heard, culls), timed(seconds, "frame"):
            with timed(seconds, "prepare"):
                plan = plan_frame(snapshot)
                renderer = FrameRenderer(plan, snapshot, self._buffers)
                renderer.wait()

            @contextmanager
            def stage(name):
                # The steps of a sample are left to run into one another.
                if name in {"surfaces", "sum"}:
                    yield
                    return
                with timed(seconds, name):
                    yield
                    renderer.wait()

            while not renderer.finished():
                renderer.advance(16, stage)
                renderer.wait()
                if progress:
                    progress(renderer.samples_done)
        try:
            passes = renderer.read_passes(PASSES)
            counts = asdict(renderer.highlights) if renderer.highlights else {}
        finally:
            renderer.release()
        passes = {name: picture[::-1] for name, picture in passes.items()}
        return BokehFrame(passes, seconds, counts, asdict(heard[-1]) if heard else {})


@contextmanager
def _listening(heard, culls):
    """Hear what the tests of visibility find, and leave them out if they are not to cull."""
    find = BokehVisibility.find

    def listened(self, *others, **named):
        found = find(self, *others, **named, **({} if culls else {"culls": False}))
        heard.append(found.counts)
        return found

    BokehVisibility.find = listened
    try:
        yield
    finally:
        BokehVisibility.find = find
