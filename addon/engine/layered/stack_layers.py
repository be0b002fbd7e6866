"""Depth layers of a captured picture, sent to the device."""

import numpy as np

from ...device.targets import Targets
from ...device.textures import texture_array
from ...passes.layered import layers
from .layer_raster import DeviceLayers, LayerRaster

# Of a depth buffer's value: what lies on a layer's bounds is inside.
_ROUNDING = 1e-6


def stack_near(stack):
    """Return the near plane that a captured picture is kept with: half its least depth, m."""
    depths = [layer.depth[np.isfinite(layer.depth)] for layer in stack.layers]
    nearest = min((float(found.min()) for found in depths if found.size), default=2.0)
    return 0.5 * max(nearest, 1e-6)


def stack_far(stack):
    """Return a depth behind everything that a captured picture has, m."""
    depths = [layer.depth[np.isfinite(layer.depth)] for layer in stack.layers]
    farthest = max((float(found.max()) for found in depths if found.size), default=1.0)
    return 2.0 * farthest


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

    Parameters
    ----------
    stack : LayerStack
    """

    def __init__(self, stack):
        self.stack = stack
        self._made = None

    def on_device(self, plan):
        """Return the layers with their pyramids, uploaded by the first frame.

        Parameters
        ----------
        plan : FramePlan
            With `layered`. Its depth buffer is that of all frames of the stack.

        Returns
        -------
        DeviceLayers
        """
        if self._made is None:
            self._made = _upload(plan, self.stack)
            raster = self._made.raster
            layers.build_pyramids(
                self._made.textures, raster.width, raster.height, len(self._made.bounds), True
            )
        return self._made

    def release(self):
        """Give the layers back to the device."""
        if self._made is not None:
            self._made.textures.release()
            self._made = None


def _upload(plan, stack):
    height, width = stack.layers[0].depth.shape
    count = len(stack.layers)
    depths = np.stack([buffer_depths(plan, layer) for layer in stack.layers])
    # Half precision ends there.
    colors = np.stack([np.clip(layer.color, -65504.0, 65504.0) for layer in stack.layers])
    textures = Targets(width, height, layers.specs(width, height, count)[2:])
    textures.textures["colors"] = _texels(colors, layers.COLOR_FORMAT)
    textures.textures["depths"] = _texels(depths[..., None], layers.DEPTH_FORMAT)
    bounds = np.empty((count, 2))
    for number, found in enumerate(depths):
        held = found[found <= 1.0]
        bounds[number] = (held.min(), held.max()) if held.size else (1.0, 0.0)
    bounds += (-_ROUNDING, _ROUNDING)
    raster = LayerRaster(width, height, 1, stack.overscan)
    return DeviceLayers(textures, raster, bounds, filtered=True)


def _texels(array, texel_format):
    texture = texture_array(array, texel_format)
    texture.filter_mode(False)
    return texture
