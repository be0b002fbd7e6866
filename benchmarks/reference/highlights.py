"""The list of highlights of a raster, pixel by pixel: the twin of `passes.bokeh.highlights`."""

from dataclasses import dataclass

import numpy as np

from addon.sampling.highlights import highlight_share

# Circles of confusion that differ by more are not averaged, px.
_COC_TOLERANCE = 1.0
# Those that differ by less see the same surfaces in front, px.
_SAME_VIEW = 1.0
# Of see-through ones that differ by less one highlight is made, px.
_ONE_PLACE = 1.05
# Parallax, px, below which visibility does not count what is in front.
_SAME_PLACE = 0.25
# Highlights of a pixel; side of a tile, px.
_MOST, _TILE = 8, 8


@dataclass(frozen=True, eq=False)
class Raster:
    """How a raster was drawn.

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the raster.
    orthographic : bool
    focus_distance, coc_scale : float
        See `engine.planning.plan.FramePlan`.
    least_coc : float
        See `sampling.highlights`.
    subpixels : int
        Texels along a side of a pixel.
    layers : int
        Fragments of a texel that are listed.
    """

    projection: np.ndarray
    orthographic: bool
    focus_distance: float
    coc_scale: float
    least_coc: float
    subpixels: int
    layers: int = 4

    def depth(self, window_depth):
        """Return the depth along the axis of depth buffer values, m."""
        z = 2.0 * np.asarray(window_depth, float) - 1.0
        slope, offset = self.projection[2, 2:]
        return (offset - z) / slope if self.orthographic else offset / (z + slope)

    def coc(self, depth):
        """Return the signed radius of the circle of confusion, px."""
        defocus = self.coc_scale * (depth - self.focus_distance) / self.focus_distance
        return defocus if self.orthographic else defocus / depth


def highlights(fragments, scene, raster):
    """List the highlights of a raster.

    Parameters
    ----------
    fragments : sequence of (ndarray, ndarray, ndarray)
        Of each texel, in any order: light to be splatted, shape (height, width, 3), window
        depth and share of the light from behind that passes, 0 where opaque, shape (height, width);
        bottom row first.
    scene : ndarray of shape (height, width)
        Window depth of the nearest opaque surface.
    raster : Raster

    Returns
    -------
    sources : ndarray of shape (N, 8)
        x, y, depth, extent, red, green, blue, region; by tile, row, column and circle of confusion.
    sharp : int
        Pixels with light too sharp to be splatted.
    """
    height, width = scene.shape
    found, sharp = [], 0
    rows, columns = np.mgrid[0 : height // raster.subpixels, 0 : width // raster.subpixels]
    rows, columns = rows.ravel(), columns.ravel()
    for k in np.lexsort((columns, rows, columns // _TILE, rows // _TILE)):
        pixel, too_sharp = _pixel(fragments, scene, raster, rows[k], columns[k])
        found += pixel
        sharp += too_sharp
    return np.array(found).reshape(-1, 8), sharp


def _seen(fragments, scene, raster, texel):
    """Return the fragments of a texel that something of the lens may see, from front to back."""
    listed = [
        (float(depth[texel]), color[texel].astype(float), float(through[texel]))
        for color, depth, through in fragments
        if color[texel].max() > 0.0
    ]
    kept, layers, placed = [], 0, None
    for fragment in sorted(listed, key=lambda each: each[0]):
        depth = fragment[0]
        hiding = [scene[texel]] if scene[texel] < depth - 2e-7 else []
        hiding += [kept[-1][0]] if kept and kept[-1][2] == 0.0 else []
        cocs = raster.coc(raster.depth(np.array([*hiding, depth])))
        if (np.abs(cocs[:-1] - cocs[-1]) < _SAME_VIEW).any():
            continue
        # See-through ones with nearly one circle of confusion are put at the first one's depth.
        near = kept and kept[-1][2] > 0.0
        near = near and abs(raster.coc(raster.depth(placed)) - cocs[-1]) < _ONE_PLACE
        if not near:
            if layers == raster.layers:
                break
            layers, placed = layers + 1, depth
        kept.append((*fragment, placed))
    return [
        (placed, color * _passed(listed, depth, placed, raster), through)
        for depth, color, through, placed in kept
    ]


def _passed(listed, depth, placed, raster):
    """Return the share that passes what is in front, but not for visibility at `placed`."""
    ends = raster.depth(placed)
    move = _SAME_PLACE / raster.coc_scale
    far = ends - move * raster.focus_distance if raster.orthographic else 1 / (1 / ends + move)
    far = min(far, ends * (1.0 - 1e-5))
    return np.prod(
        [
            through
            for before, _, through in listed
            if through > 0.0 and before < depth and raster.depth(before) > far
        ]
    )


def _pixel(fragments, scene, raster, row, column):
    fine = raster.subpixels
    texels = [(row * fine + y, column * fine + x) for y in range(fine) for x in range(fine)]
    listed = [
        (texel, depth, color)
        for texel in texels
        for depth, color, _ in _seen(fragments, scene, raster, texel)
    ]
    if not listed:
        return [], False
    places = np.array([texel[::-1] for texel, _, _ in listed]) + 0.5
    depth = raster.depth(np.array([depth for _, depth, _ in listed]))
    light = np.array([color for _, _, color in listed])
    coc = raster.coc(depth)
    share = highlight_share(coc, raster.least_coc)
    blurred = share > 0.0
    sources, left = [], blurred
    while left.any():
        last = len(sources) == _MOST - 1
        group = left if last else left & (coc < coc[left].min() + _COC_TOLERANCE)
        each = (places[group], light[group], depth[group], share[group])
        sources.append(_source(*each, raster, np.array(scene.shape[::-1])))
        left = left & ~group
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
    covered = len(np.unique(places, axis=0))
    return [*xy, mean_depth, np.sqrt(covered * area), *energy, 0.0]
