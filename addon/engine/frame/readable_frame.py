"""Reading a frame while it is drawn or when it is done: its passes and its progress."""

from dataclasses import replace

import numpy as np

from ...sampling.tile_control import TILE
from ...snapshot.render_passes import made_by
from .tile_sampling import SamplingReport, weights_of


class ReadableFrame:
    """The reading half of `pipeline.FrameRenderer`: pictures and progress.

    A subclass has ``plan``, ``samples_done`` and, of itself, ``_pictures``, ``_targets``,
    ``_tiles``, ``_lens``, ``_plain``, ``_bokeh`` and ``_stopped``.
    """

    @property
    def samples_expected(self):
        """About how many samples the frame takes; exact where that is known."""
        if self._tiles:
            return self._tiles.expected(self.samples_done)
        return self.samples_done if self._stopped else self.plan.samples

    @property
    def thresholds(self):
        """The least and the largest automatic threshold of highlights; None without any."""
        bokeh = self.plan.bokeh
        return self._bokeh.stage.thresholds if bokeh and bokeh.contrast else None

    def is_late(self, seconds):
        """Whether the time limit is reached after `seconds` of drawing.

        The minimum samples of a noise threshold are drawn in any case: shaders and bokeh alone may
        take longer than the limit, and the picture would be that of a pinhole.
        """
        limit, wanted = self.plan.time_limit, self.plan.automatic
        if limit is None or seconds < limit or self.sampled:
            return False
        return wanted is None or self.samples_done >= min(wanted.least, wanted.most)

    @property
    def sampling(self):
        """Error and samples so far, as `SamplingReport`."""
        done = self.samples_done
        if self._tiles:
            return self._tiles.report(self.plan, done)
        return SamplingReport(None, None, (done, float(done), done))

    @property
    def _weights(self):
        if self._tiles:
            found = self._tiles.weights(self.plan, self.samples_done)
        else:
            found = weights_of(self.plan, self.samples_done)
        if self._lens and found.scales is None:
            light, mean = self._lens.sums
            found = replace(found, light=light, mean_light=mean)
        return found

    def _sample_counts(self):
        if self._tiles:
            return self._tiles.counts(self.plan, self.samples_done)
        tiles = (-(-side // TILE) for side in (self.plan.height, self.plan.width))
        return np.full(tuple(tiles), self.samples_done)

    def resolve(self, origin=(0, 0), pixel_size=1):
        """Draw the picture so far into the bound frame buffer.

        Parameters
        ----------
        origin : tuple of 2 int
            Where its lower left corner goes.
        pixel_size : int
            Side of the square that shows one pixel.
        """
        self._pictures.resolve(self._weights, origin, pixel_size)

    def read_image(self):
        """Return the picture so far, shape (height, width, 4), bottom row first."""
        self._targets.forget_framebuffers()
        return self._pictures.read_shown(self._weights)

    def pass_groups(self):
        """Return the plan's passes in groups that are best read together.

        Returns
        -------
        list of tuple of str
        """
        together = made_by(self.plan.passes, "DATA")
        groups = [(name,) for name in self.plan.passes if name not in together]
        return [*groups, together] if together else groups

    def read_passes(self, names=None):
        """Return passes of the plan, from the samples so far.

        Parameters
        ----------
        names : sequence of str, optional
            Default: all.

        Returns
        -------
        dict of str to ndarray of shape (height, width, channels)
            float32, bottom row first, by name, in the order of `names`.
        """
        names = self.plan.passes if names is None else names
        self._targets.forget_framebuffers()
        made, weights = self._pictures, self._weights
        pictures = made.read_data(made_by(names, "DATA"))
        for name in names:
            if name == "Combined":
                pictures[name] = made.read_shown(weights)
            elif name == "Defocus":
                pictures[name] = made.read_defocus(weights)
            elif name == "Bokeh":
                pictures[name] = made.read_bokeh()
            elif name == "Focus Matte":
                pictures[name] = made.read_focus_matte(weights)
            elif name == "Fringe":
                pictures[name] = self._read_fringe(weights)
            elif name == "Sample Count":
                pictures[name] = made.read_sample_count(self._sample_counts())
            elif name not in pictures:
                pictures[name] = made.read_cryptomatte(name, weights)
        return {name: pictures[name] for name in names}

    def _read_fringe(self, weights):
        picture = self._pictures.read_combined(weights)[..., :3]
        if self._plain is None:
            return np.zeros_like(picture, order="C")
        return picture - self._plain._pictures.read_combined(self._plain._weights)[..., :3]
