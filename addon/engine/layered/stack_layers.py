"""Depth layers of a captured picture, sent to the device."""

from dataclasses import dataclass

import numpy as np

from ...device.targets import Targets
from ...device.textures import texture_2d, texture_array
from ...device.uniforms import uniform_buffer
from ...layers.joining import join_layers
from ...passes.bokeh import layer_highlights
from ...passes.layered import layers
from ...passes.surface import surface
from .layer_raster import DeviceLayers, LayerRaster
from .stack_highlights import find_highlights, runs_of, seen_from_middle
from .stack_occluders import occluding_surfaces


def stack_near(stack):
    """Return the near plane that a captured picture is kept with: half its least depth, m."""
    return 0.5 * max(stack.depth_range[0], 1e-6)


def stack_far(stack):
    """Return a depth behind everything that a captured picture has, m."""
    return 2.0 * stack.depth_range[1]


def buffer_depths(plan, layer):
    """Return the depths of a layer as the frame's depth buffer would hold them.

    Parameters
    ----------
    plan : FramePlan
    layer : DepthLayer

    Returns
    -------
    ndarray of shape (height, width)
        float32; `passes.layered.layers.EMPTY` where nothing is.
    """
    slope, offset = plan.projection[2, 2:]
    with np.errstate(divide="ignore"):
        depth = layer.depth.astype(np.float64)
        ndc = offset - slope * depth if plan.orthographic else offset / depth - slope
    # What is infinitely far lies on the far plane.
    found = np.clip(np.where(np.isinf(depth), 1.0, 0.5 * ndc + 0.5), 0.0, 1.0)
    covered = layer.color[..., 3] > 0.0
    return np.where(covered, found, layers.EMPTY).astype(np.float32)


class StackLayers:
    """A captured picture on the device, for as many frames as it is seen in.

    What follows from the picture alone is made once. What a frame's lens changes in the layers, the
    light that they keep of highlights, `prepare` writes for each frame.

    Parameters
    ----------
    stack : LayerStack
    """

    def __init__(self, stack):
        self.stack = join_layers(stack)
        self._depths = None
        self._made = None
        self._occluders = None
        self._threshold = None
        self._highlights = self._picture = None
        # Pyramids are those of the layers as they were before.
        self._stale = True

    def prepare(self, plan, split=None, field=None):
        """Return the layers with their pyramids, as the samples of a frame see them.

        Parameters
        ----------
        plan : FramePlan
            With `layered`. Its depth buffer is that of all frames of the stack.
        split : GPUUniformBuf or None
            `HighlightParams`, of a frame with a bokeh.
        field : tuple of (str, GPUUniformBuf or GPUTexture) or None
            `passes.surface.chromatic.resources`, with chromatic aberration.

        Returns
        -------
        DeviceLayers
        """
        if self._made is None:
            self._made = _upload(self._depths_of(plan), self.stack)
            self._stale = True
        textures, raster = self._made.textures, self._made.raster
        if plan.bokeh:
            highlights = self.highlights(plan)
            view = uniform_buffer(stack_view(plan))
            for entries, number in (highlights.surfaces, highlights.world):
                if number:
                    layer_highlights.leave_base(
                        entries, number, textures["colors"], split, view, field
                    )
                    self._stale = True
        else:
            self._forget_highlights()
        if self._stale:
            count = len(self.stack.layers)
            layers.build_pyramids(textures, raster.width, raster.height, count, True)
            self._stale = False
        return self._made

    def highlights(self, plan):
        """Return the highlights of the picture at a frame's threshold.

        Parameters
        ----------
        plan : FramePlan
            With a `bokeh`.

        Returns
        -------
        HighlightTextures
        """
        threshold = plan.bokeh.settings.least_threshold
        if threshold != self._threshold:
            self._forget_highlights()
            found = find_highlights(self.stack, self._depths_of(plan), threshold)
            self._threshold, self._highlights = threshold, _textures(found)
        return self._highlights

    def picture(self, plan):
        """Return the picture as the lens' middle sees it, at half its resolution.

        Returns
        -------
        tuple of 2 GPUTexture
            Colour, and value of the depth buffer of the nearest that covers a pixel.
        """
        if self._picture is None:
            color, depth = seen_from_middle(self.stack, self._depths_of(plan))
            self._picture = texture_2d(color, "RGBA32F"), texture_2d(depth[..., None], "R32F")
        return self._picture

    def occluders(self, plan):
        """Return the foremost surfaces of each pixel; the stack keeps and releases them.

        Returns
        -------
        Targets
            ``layers`` and ``opacity``, see `passes.visibility.visibility_warp.pack`.
        """
        if self._occluders is None:
            surfaces, opacity = occluding_surfaces(self.stack, self._depths_of(plan))
            self._occluders = Targets(surfaces.shape[1], surfaces.shape[0], [])
            self._occluders.textures["layers"] = texture_2d(surfaces)
            self._occluders.textures["opacity"] = texture_2d(opacity, "RGBA8")
        return self._occluders

    def _depths_of(self, plan):
        if self._depths is None:
            self._depths = np.stack([buffer_depths(plan, layer) for layer in self.stack.layers])
        return self._depths

    def _forget_highlights(self):
        """Restore the light of highlights that was taken out of the layers."""
        found, self._highlights, self._threshold = self._highlights, None, None
        if found is None or self._made is None:
            return
        for entries, number in (found.surfaces, found.world):
            if number:
                layer_highlights.give_back(entries, number, self._made.textures["colors"])
                self._stale = True

    def release(self):
        """Give everything back to the device."""
        if self._made is not None:
            self._made.textures.release()
        if self._occluders is not None:
            self._occluders.release()
        self._made = self._occluders = self._highlights = self._threshold = None
        self._picture = None


@dataclass(frozen=True, eq=False)
class HighlightTextures:
    """The highlights of a captured picture on the device; see `StackHighlights`.

    Parameters
    ----------
    surfaces, world : tuple of (tuple of 3 GPUTexture, int)
        As `passes.bokeh.layer_highlights` takes them, and how many there are.
    runs : tuple of tuple of (int, int)
        Of `surfaces` and of `world`: first and number of those that are listed together.
    nearest : GPUTexture
        R32F.
    """

    surfaces: tuple
    world: tuple
    runs: tuple
    nearest: object


def _textures(found):
    parts = (found.surfaces, found.world)
    surfaces, world = (
        (layer_highlights.entry_textures(part.place, part.light, part.front), len(part.place))
        for part in parts
    )
    nearest = texture_2d(found.nearest[..., None], "R32F")
    return HighlightTextures(surfaces, world, tuple(map(runs_of, parts)), nearest)


def stack_view(plan):
    """Return the bytes of the `ViewParams` of the raster of a captured picture.

    Parameters
    ----------
    plan : FramePlan
        With `layered` and a `bokeh`.

    Returns
    -------
    bytes
    """
    return surface.VIEW_PARAMS.pack(
        view=plan.view,
        view_inverse=np.linalg.inv(plan.view),
        projection=plan.bokeh.projection,
        lens=(plan.focus_distance, float(plan.orthographic), plan.coc_scale, plan.sharp_radius),
        film=(plan.bokeh.width, plan.bokeh.height, 0.0, 0.0),
    )


def _upload(depths, stack):
    count, height, width = depths.shape
    # Half precision ends there.
    colors = np.stack([np.clip(layer.color, -65504.0, 65504.0) for layer in stack.layers])
    textures = Targets(width, height, layers.specs(width, height, count)[2:])
    textures.textures["colors"] = _texels(colors, layers.COLOR_FORMAT)
    textures.textures["depths"] = _texels(
        np.stack([depths, np.ones_like(depths)], axis=-1), layers.DEPTH_FORMAT
    )
    raster = LayerRaster(width, height, 1, stack.overscan)
    nearest = max(stack.depth_range[0], 1e-6)
    return DeviceLayers(textures, raster, count, nearest, filtered=True)


def _texels(array, texel_format):
    texture = texture_array(array, texel_format)
    texture.filter_mode(False)
    return texture
