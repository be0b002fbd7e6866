"""Tables of a real lens on the device: those of some lens samples at a time, and sums of light."""

from collections import OrderedDict
from dataclasses import replace

import numpy as np

from ...passes.surface import real_lens
from ...passes.tile_scales import CORNERS
from ...sampling.tile_control import TILE

# Tables that are uploaded together, and how many such parts are kept: 8 MB, and as much for the
# slopes of subsamples.
_TOGETHER, _KEPT = 32, 4
# Share of the brightest place's light that counts as none.
_LEAST = 1e-5
# Steps between corners of a tile over those between nodes of the light.
_PARTS = 4


class LensTables:
    """The real lens of a frame's samples on the device.

    Parameters
    ----------
    plan : FramePlan
        With a `real_lens`.
    """

    def __init__(self, plan):
        self._parts = OrderedDict()
        self._sets = len(plan.lens_places)
        self._together = max(_TOGETHER // self._sets, 1)
        grid = plan.real_lens.grid
        self._sums = np.zeros((self._sets, grid.rows, grid.columns, 4))
        self._textures = None
        self.follow(plan)
        falloff = real_lens.light_texture(self._lens.falloff[None])
        light = real_lens.SampleLight(falloff, self._table(1))
        self._blur = self._area = None
        middle = self._upload(np.zeros((1, 2)))
        self._middle = real_lens.LensSample(
            0, middle, light, blur=self._blurred, area=self._enlarged
        )

    def follow(self, plan):
        """Go on with a plan that has more samples."""
        self._plan, self._lens = plan, plan.real_lens
        self._parts.clear()

    def sample(self, index):
        """Return the `LensSample` of a sample.

        For None that of the lens' middle, whose light is that of the picture over an even one.
        """
        if index is None:
            return self._middle
        moves, light, tables, turns = self._part(index // self._together)
        slot = index % self._together * self._sets
        light = real_lens.SampleLight(light, self._table(len(tables), slot), self._sets)
        return real_lens.LensSample(slot, moves, light, turns, self._sets, blur=self._blurred)

    def discs(self, bokeh):
        """Return the `LensSample` of a `BokehPlan`'s discs: the middle, for each band."""
        bands = bokeh.colors.traced if bokeh.colors else ()
        if not bands:
            return self._middle
        shares = np.stack([band.shares for band in bands])
        tables = self._upload(np.zeros((len(bands), 2)), shares)
        return replace(self._middle, resources=tables, tables=len(bands))

    def add(self, index):
        """Note that a sample was added to the picture."""
        weights = self._plan.sample_weights(index, index + 1)[0]
        tables = self._part(index // self._together)[2]
        first = index % self._together * self._sets
        self._sums += tables[first : first + self._sets, ..., None] * weights
        self._textures = None

    @property
    def sums(self):
        """Weights to divide the sums so far by, as two `SampleLight`: by channel, and alpha."""
        if self._textures is None:
            sums = self._divisors()
            mean = np.repeat(sums[..., 3:], 4, axis=-1)
            self._textures = [real_lens.light_texture(each) for each in (sums, mean)]
        table = self._table(self._sets)
        return tuple(
            real_lens.SampleLight(texture, table, self._sets) for texture in self._textures
        )

    @property
    def corners(self):
        """Corners along each side of a tile between which the light is nearly linear."""
        grid = self._lens.grid
        pitch = min(self._plan.width / (grid.columns - 1), self._plan.height / (grid.rows - 1))
        steps = _PARTS * TILE / pitch
        return next((count for count in CORNERS if count - 1 >= steps), CORNERS[-1])

    def corner_sums(self, shape):
        """Weights to divide the sums so far by, at corners of tiles.

        Parameters
        ----------
        shape : tuple of 2 int
            Rows and columns of tiles.

        Returns
        -------
        ndarray of shape (*shape, corners, corners, 4)
            Upwards, to the right; by channel.
        """
        grid, count = self._lens.grid, self.corners
        size = np.array([self._plan.width, self._plan.height])
        steps = TILE * np.arange(count) / (count - 1)
        y, x = ((TILE * np.arange(n)[:, None] + steps).ravel() for n in shape)
        places = np.stack(np.meshgrid(x, y), axis=-1) / size
        index, weights = grid.taps(grid.low + places * (grid.high - grid.low))
        # Tiles are never those of several sets.
        found = np.einsum("yxt,yxtc->yxc", weights, self._divisors()[0].reshape(-1, 4)[index])
        rows, columns = shape
        return found.reshape(rows, count, columns, count, 4).swapaxes(1, 2)

    def _divisors(self):
        # What the lens takes away is left out of the divisor of the colours: what is opaque stays
        # so. The first samples may have no light at some place.
        sums = self._sums.copy()
        sums[..., :3] /= np.maximum(self._lens.falloff, _LEAST)[..., None]
        return np.maximum(sums, _LEAST * max(float(self._sums.max()), 1e-30))

    def blur_at_infinity(self):
        """Return what the lens adds to the circle of confusion of what is infinitely far.

        Returns
        -------
        ndarray of shape (height, width, 1)
            In the middle of the raster's pixels, px.
        """
        size = np.array([self._plan.width, self._plan.height])
        x, y = (np.arange(count) + 0.5 for count in size)
        shares = np.stack(np.meshgrid(x, y), axis=-1) / size
        shown, tables = self._lens.grid, self._lens.tables
        index, weights = tables.moves_grid.taps(shown.low + shares * (shown.high - shown.low))
        found = (tables.blur[..., 0].ravel()[index] * weights).sum(axis=-1, keepdims=True)
        return found * self._focal_px

    @property
    def _focal_px(self):
        return self._plan.coc_scale / self._lens.tables.aperture_radius

    def _blurred(self):
        if self._blur is None:
            blur = self._lens.tables.blur * np.float32(self._focal_px)
            self._blur = real_lens.field_texture(blur)
        return self._blur

    def _enlarged(self):
        if self._area is None:
            self._area = real_lens.field_texture(self._lens.tables.area)
        return self._area

    def _table(self, count, first=0):
        grid = self._lens.grid
        return (float(grid.columns), float(grid.rows), float(count), float(first))

    def _part(self, number):
        if number not in self._parts:
            part = slice(number * self._together, (number + 1) * self._together)
            places = self._plan.lens_places[:, part]
            colors = self._plan.lens_colors(part)
            if colors is not None:
                colors = np.repeat(colors, len(places), axis=0)
            # The sets of a sample one after the other.
            places = places.swapaxes(0, 1).reshape(-1, 2)
            light = self._lens.light(places)
            turns = self._turns(places, colors) if self._plan.blurs else None
            texture = real_lens.light_texture(light)
            self._parts[number] = (self._upload(places, colors), texture, light, turns)
            while len(self._parts) > _KEPT:
                self._parts.popitem(last=False)
        self._parts.move_to_end(number)
        return self._parts[number]

    def _upload(self, places, colors=None):
        tables = self._lens.tables
        size = self._plan.width, self._plan.height
        return real_lens.resources(tables.moves(places, colors), tables, size)

    def _turns(self, places, colors):
        return real_lens.turns_texture(self._plan.turns(places, colors))
