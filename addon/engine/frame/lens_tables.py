"""Tables of a real lens on the device: those of some lens samples at a time, and sums of light."""

from collections import OrderedDict

import numpy as np

from ...passes.surface import real_lens

# Samples whose tables are uploaded together, and how many such parts are kept: 15 MB.
_TOGETHER, _KEPT = 64, 4
# Share of the brightest place's light that counts as none.
_LEAST = 1e-6


class LensTables:
    """The real lens of a frame's samples on the device.

    Parameters
    ----------
    plan : FramePlan
        With a `real_lens`.
    """

    def __init__(self, plan):
        self._parts = OrderedDict()
        self._sums = np.zeros((plan.real_lens.grid.rows, plan.real_lens.grid.columns, 4))
        self._textures = None
        self.follow(plan)
        self._middle = real_lens.LensSample(0, self._upload(np.zeros((1, 2))))

    def follow(self, plan):
        """Go on with a plan that has more samples."""
        self._plan, self._lens = plan, plan.real_lens
        self._parts.clear()

    def sample(self, index):
        """Return the `LensSample` of a sample; that of the lens' middle for None."""
        if index is None:
            return self._middle
        moves, light, tables = self._part(index // _TOGETHER)
        grid, slot = self._lens.grid, index % _TOGETHER
        table = (float(grid.columns), float(grid.rows), float(len(tables)), float(slot))
        return real_lens.LensSample(slot, moves, real_lens.SampleLight(light, table))

    def add(self, index):
        """Note that a sample was added to the picture."""
        weights = self._plan.sample_weights(index, index + 1)[0]
        tables = self._part(index // _TOGETHER)[2]
        self._sums += tables[index % _TOGETHER][..., None] * weights
        self._textures = None

    @property
    def sums(self):
        """The summed weights of the samples so far, as two `SampleLight`: by channel, and alpha."""
        if self._textures is None:
            # The first samples may have no light at some place.
            sums = np.maximum(self._sums, _LEAST * max(float(self._sums.max()), 1e-30))
            mean = np.repeat(sums[..., 3:], 4, axis=-1)
            self._textures = [real_lens.light_texture(each[None]) for each in (sums, mean)]
        grid = self._lens.grid
        table = (float(grid.columns), float(grid.rows), 1.0, 0.0)
        return tuple(real_lens.SampleLight(texture, table) for texture in self._textures)

    def _part(self, number):
        if number not in self._parts:
            places = self._plan.lens_positions[number * _TOGETHER : (number + 1) * _TOGETHER]
            light = self._lens.light(places)
            self._parts[number] = (self._upload(places), real_lens.light_texture(light), light)
            while len(self._parts) > _KEPT:
                self._parts.popitem(last=False)
        self._parts.move_to_end(number)
        return self._parts[number]

    def _upload(self, places):
        tables = self._lens.tables
        grid = tables.moves_grid
        return real_lens.resources(
            tables.moves(places),
            grid.low,
            grid.high,
            tables.focus_vergence,
            tables.largest_vergence,
        )
