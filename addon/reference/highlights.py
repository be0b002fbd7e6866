"""The list of highlights of peeled layers, pixel by pixel: the twin of `passes.highlights`."""

from dataclasses import dataclass

import numpy as np

from ..sampling.highlights import highlight_share

# Circles of confusion that differ by more are not averaged, px.
_COC_TOLERANCE = 1.0


@dataclass(frozen=True, eq=False)
class Raster:
    """How a peeled raster was drawn.

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the raster.
    orthographic : bool
    focus_distance, coc_scale : float
        See `engine.plan.FramePlan`.
    least_coc : float
        See `sampling.highlights`.
    subpixels : int
        Texels along a side of a pixel.
    """

    projection: np.ndarray
    orthographic: bool
    focus_distance: float
    coc_scale: float
    least_coc: float
    subpixels: int

    def depth(self, window_depth):
        """Return the depth along the axis of depth buffer values, m."""
        z = 2.0 * np.asarray(window_depth, float) - 1.0
        slope, offset = self.projection[2, 2:]
        return (offset - z) / slope if self.orthographic else offset / (z + slope)

    def coc(self, depth):
        """Return the signed radius of the circle of confusion, px."""
        defocus = self.coc_scale * (depth - self.focus_distance) / self.focus_distance
        return defocus if self.orthographic else defocus / depth


def highlights(layers, raster):
    """List the highlights of peeled layers.

    Parameters
    ----------
    layers : sequence of (ndarray, ndarray)
        Light to be splatted, shape (height, width, 3), and window depth, shape (height,
        width), of each layer; bottom row first.
    raster : Raster

    Returns
    -------
    sources : ndarray of shape (N, 8)
        x, y, depth, extent, red, green, blue, region; by layer, row, column and circle of
        confusion.
    sharp : int
        Pixels with light too sharp to be splatted.
    """
    found, sharp = [], 0
    for color, window_depth in layers:
        rows, columns = (side // raster.subpixels for side in window_depth.shape)
        for row in range(rows):
            for column in range(columns):
                pixel, too_sharp = _pixel(color, window_depth, raster, row, column)
                found += pixel
                sharp += too_sharp
    return np.array(found).reshape(-1, 8), sharp


def _pixel(color, window_depth, raster, row, column):
    fine = raster.subpixels
    block = (slice(row * fine, (row + 1) * fine), slice(column * fine, (column + 1) * fine))
    light = color[block].reshape(-1, 3).astype(float)
    bright = light.max(axis=1) > 0.0
    if not bright.any():
        return [], False
    y, x = np.mgrid[block]
    places = np.stack([x, y], axis=-1).reshape(-1, 2)[bright] + 0.5
    light, depth = light[bright], raster.depth(window_depth[block].ravel()[bright])
    coc = raster.coc(depth)
    share = highlight_share(coc, raster.least_coc)
    blurred = share > 0.0
    if not blurred.any():
        return [], True
    low, high = coc[blurred].min(), coc[blurred].max()
    groups = [blurred]
    if high - low > _COC_TOLERANCE:
        near = coc < 0.5 * (low + high)
        groups = [blurred & near, blurred & ~near]
    size = np.array(window_depth.shape[::-1])
    sources = [_source(places[g], light[g], depth[g], share[g], raster, size) for g in groups]
    return sources, not blurred.all()


def _source(places, light, depth, share, raster, size):
    weight = light.max(axis=1) * share
    clip = (places * weight[:, None]).sum(axis=0) / weight.sum() / size * 2.0 - 1.0
    mean_depth = weight.sum() / (weight / depth).sum()
    scale = np.diag(raster.projection)[:2]
    if raster.orthographic:
        xy = (clip - raster.projection[:2, 3]) / scale
    else:
        xy = (clip + raster.projection[:2, 2]) / scale * mean_depth
    area = 1.0 / raster.subpixels**2
    energy = (light * share[:, None]).sum(axis=0) * area
    return [*xy, mean_depth, np.sqrt(len(places) * area), *energy, 0.0]
