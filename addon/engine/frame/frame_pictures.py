"""The pictures of a frame: from the sums of its samples to the passes (methods 1).

With distortion the sums are those of a larger undistorted raster (`engine.planning.distortion`).
Light and mattes are resampled from it with a filter; ids and geometry are taken from the nearest
pixel of the raster, since they must not be mixed.
"""

import numpy as np

from ...device import readback, state
from ...device.targets import Targets, TargetSpec
from ...passes import cryptomatte, resolve
from ...passes.bokeh import marks
from ...passes.surface import data
from ...sampling.tile_control import TILE
from ...snapshot.render_passes import cryptomatte_kinds
from ..bokeh.marks import mark_targets, shows_marks

# Weights that are the same for all tiles, and all over the picture.
_NOWHERE = (None, None)


class FramePictures:
    """Reads the pictures of a frame off its targets.

    Parameters
    ----------
    plan : FramePlan
    content : SceneContent
    buffers : SceneBuffers
    drawing : SceneDrawing
        Aimed at the frame.
    view : GPUUniformBuf
        `ViewParams` of the frame.
    targets : Targets
        With those of `target_specs`, and the sums of the samples.
    fullscreen : GPUBatch
    lens : LensTables or None
    """

    def __init__(self, plan, content, buffers, drawing, view, targets, fullscreen, lens=None):
        self._plan = plan
        self._content = content
        self._buffers = buffers
        self._drawing = drawing
        self._view = view
        self._targets = targets
        self._fullscreen = fullscreen
        self._lens = lens
        self._kinds = cryptomatte_kinds(plan.passes)
        self._nearest = None

    @staticmethod
    def target_specs(plan):
        """Return the render targets that pictures are made in."""
        specs = [TargetSpec("image", "RGBA32F", size=plan.size), *mark_targets(plan)]
        if plan.distortion and (plan.automatic or plan.real_lens):
            specs.append(TargetSpec("mean", "RGBA32F"))
        if plan.distortion and cryptomatte_kinds(plan.passes):
            specs.append(TargetSpec("ranks", "RGBA32F"))
        return specs

    def resolve(self, weights, origin=(0, 0), pixel_size=1):
        """Draw the picture so far into the bound frame buffer.

        Parameters
        ----------
        weights : FrameWeights
            Of the samples so far.
        origin : tuple of 2 int
            Lower left corner of the picture in the frame buffer, px.
        pixel_size : int
            Side of the square of the frame buffer that shows one pixel of the picture.
        """
        targets = self._targets
        whole = (targets["sum"], weights.by_channel)
        tiles = (weights.scales, weights.light)
        bokeh = targets["bokeh"] if self._plan.bokeh else None
        if not shows_marks(self._plan):
            if tiles != (None, None):
                targets.forget_framebuffers()
            self._resolve(*whole, origin, pixel_size, bokeh, tiles)
            return
        targets.forget_framebuffers()
        with targets.framebuffer("image").bind():
            self._resolve(*whole, bokeh=bokeh, by_place=tiles)
        with targets.framebuffer("seen_marks").bind():
            self._resolve(targets["marks"], 1.0)
        textures = (targets["image"], targets["seen_marks"])
        marks.draw_picture(self._fullscreen, *textures, origin, pixel_size)

    def _resolve(self, total, weight, origin=(0, 0), pixel_size=1, bokeh=None, by_place=_NOWHERE):
        state.overwrite()
        distortion = self._plan.distortion
        scales, light = by_place
        if by_place != _NOWHERE and distortion is not None:
            # Divided before resampling: only means can be interpolated between pixels.
            with self._targets.framebuffer("mean").bind():
                resolve.resolve(self._fullscreen, total, weight, scales=scales, light=light)
            total, weight, (scales, light) = self._targets["mean"], 1.0, _NOWHERE
        resolve.resolve(
            self._fullscreen, total, weight, origin, pixel_size, bokeh, distortion, scales, light
        )

    def read_combined(self, weights):
        """Return the picture so far, shape (height, width, 4), bottom row first."""
        picture = self.read_defocus(weights)
        # Added in numpy, so that Combined is the sum of the two passes to the last bit.
        return picture + self.read_bokeh() if self._plan.bokeh else picture

    def read_shown(self, weights):
        """Return the picture that a viewport shows: Combined, or the debug view instead."""
        if not shows_marks(self._plan):
            return self.read_combined(weights)
        framebuffer = self._targets.framebuffer("marked")
        with framebuffer.bind():
            self.resolve(weights)
        return readback.read_color(framebuffer, *self._plan.size)

    def read_defocus(self, weights):
        """Return the pass Defocus, the light of the lens samples, as `read_combined`."""
        by_place = (weights.scales, weights.light)
        return self._read(self._targets["sum"], weights.by_channel, by_place)

    def read_bokeh(self):
        """Return the pass Bokeh, the splatted highlights, as `read_combined`."""
        plan = self._plan
        if not plan.bokeh:
            width, height = plan.size
            return np.zeros((height, width, 4), np.float32)
        if plan.distortion:
            return self._read(self._targets["bokeh"], 1.0)
        return readback.read_color(self._targets.framebuffer("bokeh"), plan.width, plan.height)

    def read_focus_matte(self, weights):
        """Return the Focus Matte so far, shape (height, width, 1)."""
        by_place = (weights.mean_scales, weights.mean_light)
        focus = self._read(self._targets["focus_sum"], weights.mean, by_place)
        return np.ascontiguousarray(focus[..., :1])

    def _read(self, total, weight, by_place=_NOWHERE):
        framebuffer = self._targets.framebuffer("image")
        with framebuffer.bind():
            self._resolve(total, weight, by_place=by_place)
        return readback.read_color(framebuffer, *self._plan.size)

    def read_sample_count(self, counts):
        """Return the pass Sample Count, shape (height, width, 1).

        Parameters
        ----------
        counts : ndarray of shape (rows, columns)
            Lens samples of each tile of the raster.
        """
        plan = self._plan
        each = counts.repeat(TILE, axis=0).repeat(TILE, axis=1)[: plan.height, : plan.width]
        found = each[..., None].astype(np.float32)
        return self._picked(found) if plan.distortion else np.ascontiguousarray(found)

    def read_cryptomatte(self, name, weights):
        """Return a Cryptomatte pass so far, as `read_combined`."""
        plan = self._plan
        framebuffer = self._targets.framebuffer("ranks" if plan.distortion else "image")
        with framebuffer.bind():
            state.overwrite()
            cryptomatte.draw_ranks(
                self._fullscreen,
                self._targets["tables"],
                self._kinds,
                name[:-2],
                int(name[-2:]),
                weights.mean,
                weights.mean_scales,
                weights.mean_light,
            )
        found = readback.read_color(framebuffer, plan.width, plan.height)
        return self._picked(found) if plan.distortion else found

    def _picked(self, raster):
        """Resample a raster to the picture by nearest pixels."""
        if self._nearest is None:
            plan = self._plan
            self._nearest = plan.distortion.nearest((plan.width, plan.height))
        return np.ascontiguousarray(raster[self._nearest])

    def read_data(self, names):
        """Return data passes: depth, normal, position, vector, CoC, detail.

        Parameters
        ----------
        names : sequence of str

        Returns
        -------
        dict of str to ndarray of shape (height, width, channels)
        """
        if not names:
            return {}
        plan = self._plan
        # What is infinitely far has a circle of confusion of its own in each place of a real lens.
        beside = ("Depth",) if self._lens is not None and "CoC" in names else ()
        slots = data.targets(names)
        draws = self._drawing.full_detail_draws(data.target(names, self._lens is not None))
        bindings = [("data_buf", data.data_params(
            plan.previous, plan.next, plan.width, plan.height, plan.alpha_threshold
        ))]  # fmt: skip
        if "Vector" in names:
            tables = self._buffers.neighbouring_instances(self._content.instances)
            bindings += zip(("previous_tx", "next_tx"), tables, strict=True)
        instances = self._buffers.instances
        if "Detail" in names:
            instances = self._drawing.detail_table()
        specs = [TargetSpec(name, "RGBA32F") for name in slots]
        specs.append(TargetSpec("depth", "DEPTH_COMPONENT32F"))
        with Targets(plan.width, plan.height, specs) as targets:
            empty = data.empty_values(plan.empty_coc)
            for name in slots:
                targets.clear(name, empty[name])
            framebuffer = targets.framebuffer(*slots, depth="depth")
            with framebuffer.bind():
                framebuffer.clear(depth=1.0)
                state.opaque()
                middle = self._lens and self._lens.sample(None)
                data.draw(draws, self._view, instances, tuple(bindings), middle)
            self._drawing.counts.draw_calls += len(draws)
            pictures = {
                name: readback.read_color(targets.framebuffer(name), plan.width, plan.height)
                for name in {data.PLACES[name][0] for name in {*names, *beside}}
            }
        if beside:
            depth = _channels(pictures, *data.PLACES["Depth"])
            added = np.where(depth == data.EMPTY_DEPTH, self._lens.blur_at_infinity(), 0.0)
            target, channel, _ = data.PLACES["CoC"]
            pictures[target][..., channel:] += added
        if plan.distortion:
            pictures = {name: self._picked(pixels) for name, pixels in pictures.items()}
        found = {name: _channels(pictures, *data.PLACES[name]) for name in names}
        if plan.distortion:
            for name in {"Vector", "CoC"} & found.keys():
                found[name] = in_picture(name, found[name], plan.distortion)
        return found


def in_picture(name, values, distortion):
    """Convert a pass from pixels of the undistorted raster to pixels of the picture.

    Parameters
    ----------
    name : {'Vector', 'CoC'}
    values : ndarray of shape (height, width, channels)
        Values of the raster's pixels that are nearest to the picture's.
    distortion : DistortionPlan

    Returns
    -------
    ndarray of float32, of the same shape
    """
    centres = distortion.centres()
    if name == "CoC":
        # The radius of the disc of the same area.
        found = values / np.sqrt(distortion.growth(centres).prod(axis=-1, keepdims=True))
        return found.astype(np.float32)
    places = distortion.sources(centres)
    before = distortion.pictured(places + values[..., :2]) - centres
    after = centres - distortion.pictured(places - values[..., 2:])
    moved = np.concatenate([before, after], axis=-1)
    # No movement stays exactly 0.
    still = np.repeat(~values.reshape(*values.shape[:2], 2, 2).any(axis=-1), 2, axis=-1)
    return np.where(still, 0.0, moved).astype(np.float32)


def _channels(pictures, target, first, count):
    return np.ascontiguousarray(pictures[target][..., first : first + count])
