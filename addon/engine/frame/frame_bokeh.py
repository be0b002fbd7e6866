"""The bokeh of a frame over time: whole at once, or later, with or without a draft till then."""

import time
from contextlib import nullcontext
from dataclasses import replace

import numpy as np

# Seconds below which a whole bokeh needs no draft.
_QUICK = 0.03


class FrameBokeh:
    """Runs the bokeh of a frame, and of following frames with another view.

    Attributes
    ----------
    stage : BokehStage or None
        The stage that made the bokeh that is shown; None without bokeh.
    drafted : bool
        The bokeh that is shown is a draft, or not made yet.
    seconds : float
        Duration of the last whole bokeh; infinite while none was made.
    """

    def __init__(self):
        self.stage = None
        self.drafted = False
        self.seconds = np.inf
        self._whole = self._draft = self._refining = None

    def restart(self, plan, make_stage, when):
        """Begin a frame anew.

        Parameters
        ----------
        plan : FramePlan
        make_stage : callable
            Returns the `BokehStage` of a plan.
        when : {'AT_ONCE', 'DRAFT', 'LATER'}
            The whole is made before the first sample, or by `refine`; until then there is a draft,
            or none. A whole that was quick the last time is made at once.
        """
        self.release()
        self.drafted = False
        if plan.bokeh:
            self.stage = self._whole = make_stage(plan)
            self.drafted = when != "AT_ONCE" and self.seconds > _QUICK
            if self.drafted and when == "DRAFT":
                self._draft = make_stage(replace(plan, bokeh=plan.bokeh.drafted()))

    def run(self, fullscreen, targets, view, stage=nullcontext):
        """Make what comes before the first sample, if anything does; as `BokehStage.run`."""
        if self.drafted and self._draft is None:
            # Samples leave out from the first one on what will be splatted.
            self._whole.divide(fullscreen)
            return
        self.stage = self._draft or self._whole
        start = time.perf_counter()
        self.stage.run(fullscreen, targets, view, stage)
        if self.stage is self._whole:
            self.seconds = time.perf_counter() - start

    def refine(self, fullscreen, targets, view):
        """Make a part of the whole bokeh; the last part replaces the draft."""
        if self._refining is None:
            self._refining = self._whole.steps(fullscreen, targets, view)
            self.seconds = 0.0
        start = time.perf_counter()
        done = next(self._refining, self) is self
        self.seconds += time.perf_counter() - start
        if done:
            self._refining = None
            self.stage = self._whole
            self.drafted = False

    def stop(self):
        """Abandon a whole bokeh that is in progress, and release what it holds on the device."""
        if self._refining is not None:
            self._refining.close()
            self._refining = None
            self.seconds = np.inf

    def release(self):
        """Release everything on the device; `seconds` is kept."""
        self.stop()
        self.stage = self._whole = self._draft = None
