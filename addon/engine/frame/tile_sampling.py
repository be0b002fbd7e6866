"""Adaptive sampling by a noise threshold: the tiles for which lens samples are still drawn.

Samples are added to the active tiles only. A tile's sum has the samples up to the measurement at
which it stopped, and is divided by their weight. Between measurements nothing is read from the
device.
"""

from dataclasses import dataclass

import numpy as np

from ...device import geometry, readback
from ...device.textures import texture_2d
from ...passes import picture_error
from ...passes.tile_scales import TileScales
from ...sampling.rounds import first_look, looks
from ...sampling.tile_control import HALF_SHARE, TILE, TileControl, runs

# A picture is compared with that of half its samples, and with one in between.
_PICTURES = ("shown_0", "shown_1", "shown_2", "shown_3")


@dataclass(frozen=True, eq=False)
class FrameWeights:
    """The weights by which the sums of a frame are divided.

    Parameters
    ----------
    by_channel : float or tuple of 4 float
        Summed weight of the samples so far; of each channel, where they differ.
    mean : float
        Mean over the channels.
    scales, mean_scales : TileScales or None
        The weights of each tile, where tiles have different numbers of samples.
    light, mean_light : passes.surface.real_lens.SampleLight or None
        The weights over the picture, where they differ by place.
    """

    by_channel: float | tuple[float, float, float, float]
    mean: float
    scales: object = None
    mean_scales: object = None
    light: object = None
    mean_light: object = None


@dataclass(frozen=True)
class SamplingReport:
    """Progress of sampling: error and numbers of samples.

    Parameters
    ----------
    target, error : float or None
        Noise threshold and estimated error, 1 - SSIM; None where there is none, or not yet.
    samples : tuple of (int, float, int)
        Least, mean and largest number of lens samples of any tile.
    tiles, above : int
        Number of tiles, and of those whose error is above the target.
    """

    target: float | None
    error: float | None
    samples: tuple[int, float, int]
    tiles: int = 1
    above: int = 0

    @property
    def text(self):
        """The error as words; empty without a noise threshold or before the first estimate."""
        if self.error is None:
            return ""
        return f"Error {self.error:.4f} of {self.target:.4f}"


def weights_of(plan, samples):
    """Return the `FrameWeights` of a plan's first samples, the same everywhere."""
    weight = plan.weight(samples)
    # All sub-pixels of a first sample may lie outside a narrow box filter: weight 0.
    if isinstance(weight, tuple):
        weight = tuple(w or 1.0 for w in weight)
        return FrameWeights(weight, weight[3])
    return FrameWeights(weight or 1.0, weight or 1.0)


class TileSampling:
    """The tiles of a frame: their samples, their errors, and which are active.

    Parameters
    ----------
    plan : FramePlan
        With `automatic` sampling.
    fullscreen : GPUBatch
    leader : TileSampling or None
        Follow the decisions of another renderer's tiles (for Fringe).
    lens : LensTables or None
        With a real lens, whose weights differ by place.

    Attributes
    ----------
    batch : GPUBatch
        Over the active tiles.
    active : GPUTexture or None
        1 for the active tiles, else 0; None while all are.
    """

    def __init__(self, plan, fullscreen, leader=None, lens=None):
        wanted = plan.automatic
        self._fullscreen = fullscreen
        self._size = (plan.width, plan.height)
        self._leader = leader
        most = max(wanted.most, 1)
        least = min(wanted.least, most)
        self._control = (
            leader._control if leader else TileControl(wanted.error, *self._size, least, most)
        )
        self._looks = looks(most, wanted.unit)
        self._first = first_look(wanted.unit)
        self._lens = lens
        # Of each tile, or with a real lens at corners in it.
        corners = (lens.corners, lens.corners) if lens else ()
        self._weights = np.zeros((*self._control.shape, *corners, 4))
        self._noted_light = 0.0
        self._samples = np.zeros(self._control.shape, np.int64)
        self._noted = 0
        self._pictures = {}
        self._own_batch, self._own_active = fullscreen, None

    @property
    def batch(self):
        """Triangles over the active tiles."""
        return self._leader.batch if self._leader else self._own_batch

    @property
    def active(self):
        """1 for the active tiles, else 0; None while all are."""
        return self._leader.active if self._leader else self._own_active

    @property
    def done(self):
        """Whether no further samples are needed."""
        return self._control.done

    def stop(self):
        """End sampling for all tiles."""
        self._control.stop()

    def expected(self, samples):
        """Estimate how many samples the frame will take, after `samples` of them."""
        control = self._control
        if control.done:
            return samples
        if control.error is None:
            return max(self._first, samples)
        growth = (control.error / control.target) ** (1.0 / control.power)
        return int(np.clip(samples * growth, samples + 1, max(self._looks[-1], samples + 1)))

    def report(self, plan, samples):
        """Return a `SamplingReport`."""
        self.note(plan, samples)
        control, counts = self._control, self._samples
        return SamplingReport(
            target=control.target,
            error=control.error,
            samples=(int(counts.min()), control.mean(counts), int(counts.max())),
            tiles=counts.size,
            above=control.left or 0,
        )

    def specs(self):
        """Return the render targets that measuring needs."""
        return () if self._leader else picture_error.specs(*self._size, _PICTURES)

    def part(self, reach):
        """Return the bounding rectangle of the active tiles, widened by `reach` px.

        Returns
        -------
        tuple of 4 int or None
            x, y, width, height; None for the whole raster.
        """
        active = self._control.active
        if active.all() or not active.any():
            return None
        sides = []
        for axis, size in zip((0, 1), self._size, strict=True):
            found = np.flatnonzero(active.any(axis=axis))
            low = max(int(found[0]) * TILE - reach, 0)
            sides.append((low, min(int(found[-1] + 1) * TILE + reach, size) - low))
        (x, width), (y, height) = sides
        return x, y, width, height

    def note(self, plan, samples):
        """Add the samples drawn since the last call to the counts of the active tiles."""
        if samples > self._noted:
            if self._lens:
                light = self._lens.corner_sums(self._control.shape)
                weights = (light - self._noted_light)[self._control.active]
                self._noted_light = light
            else:
                weights = plan.sample_weights(self._noted, samples).sum(axis=0)
            self._weights[self._control.active] += weights
            self._samples[self._control.active] += samples - self._noted
            self._noted = samples

    def counts(self, plan, samples):
        """Return how many samples each tile got, shape (rows, columns)."""
        self.note(plan, samples)
        return self._samples

    def weights(self, plan, samples):
        """Return the `FrameWeights` of the samples so far."""
        self.note(plan, samples)
        if (self._samples == self._samples[0, 0]).all():
            return weights_of(plan, int(self._samples[0, 0]))
        return FrameWeights(1.0, 1.0, self._scales(), self._scales(mean=True))

    def _scales(self, mean=False):
        weights = np.where(self._weights > 0.0, self._weights, 1.0)
        if mean:
            weights = np.repeat(weights[..., 3:], 4, axis=-1)
        if not self._lens:
            return TileScales(texture_2d(1.0 / weights))
        rows, columns, corners = weights.shape[:3]
        weights = weights.transpose(0, 2, 1, 3, 4).reshape(rows * corners, columns * corners, 4)
        return TileScales(texture_2d(weights), corners)

    def is_look(self, samples):
        """Return whether the error is measured after this number of samples."""
        return self._leader is None and samples in self._looks

    def look(self, plan, samples, targets, bokeh=None):
        """Measure the error and choose the tiles that go on.

        Parameters
        ----------
        plan : FramePlan
        samples : int
            Drawn so far.
        targets : Targets
            With the sum, and those of `specs`.
        bokeh : GPUTexture or None
            Splatted highlights, added to the mean of the samples.

        Returns
        -------
        bool
            Whether the set of active tiles has changed.
        """
        self.note(plan, samples)
        control = self._control
        was = control.active
        earlier = self._compared_with(samples)
        self._show(samples, targets, bokeh, earlier)
        if earlier and samples >= self._first:
            errors = [self._measure(targets, samples, before) for before in earlier]
            shares = (1.0,) if len(errors) == 1 else (HALF_SHARE, 1.0 - HALF_SHARE)
            measured = sum(share * error for share, error in zip(shares, errors, strict=True))
            following = next((look for look in self._looks if look > samples), samples)
            control.decide(samples, measured, following)
        elif samples >= self._looks[-1]:
            control.stop()
        if np.array_equal(was, control.active):
            return False
        if control.active.any():
            edges = TILE * runs(control.active) / np.array([*self._size, *self._size])
            self._own_batch = geometry.rectangles_batch(2.0 * edges - 1.0)
            self._own_active = texture_2d(np.repeat(control.active[..., None], 4, axis=-1))
        return True

    def _compared_with(self, samples):
        """Return the samples of the pictures to compare with: half of `samples`, and more."""
        half = min(self._pictures, key=lambda n: abs(n - samples / 2), default=None)
        later = [n for n in self._pictures if half < n < samples]
        # With too few samples in between, the change says little about the error.
        later = [n for n in later if samples - n >= n / 4][-1:]
        return [half, *later] if half else []

    def _show(self, samples, targets, bokeh, kept):
        spare = [name for name in _PICTURES if name not in self._pictures.values()]
        if not spare:
            oldest = min(n for n in self._pictures if n not in kept)
            spare = [self._pictures.pop(oldest)]
        self._pictures[samples] = spare[0]
        scales = self._scales()
        with targets.framebuffer(spare[0]).bind():
            picture_error.display(self._fullscreen, targets["sum"], scales, bokeh)

    def _measure(self, targets, samples, before):
        """Return the error of each tile, estimated from the change since an earlier picture."""
        control = self._control
        names = (self._pictures[samples], self._pictures[before])
        rest = control.rest(samples, before)
        picture_error.measure(self._fullscreen, targets, *names, rest)
        rows, columns = control.shape
        table = readback.read_color(targets.framebuffer("tile_errors"), columns, rows)
        # NaN in the picture counts as no error.
        errors, changes = np.nan_to_num(table[..., :2].astype(np.float64)).transpose(2, 0, 1)
        control.observe(samples, before, changes)
        return errors
