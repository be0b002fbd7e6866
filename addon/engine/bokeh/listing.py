"""The search for a frame's highlights on the device (methods 9).

Tile by tile and view by view: fragments brighter than the threshold are drawn into lists, with the
depth of opaque surfaces, and made into a list of highlights pixel by pixel.
"""

from dataclasses import dataclass

import numpy as np

from ...device import state
from ...device.targets import Targets, TargetSpec
from ...device.uniforms import uniform_buffer
from ...passes import background
from ...passes.bokeh import highlights, peel
from ...passes.surface import surface, surface_target
from .lamp_areas import NO_AREAS, LampAreas, lamp_areas
from .search_tiles import tiles_of

# Room for fragments: first guess a texel, least and most in all; a tile with more is divided.
_ROOM = 0.25
_LEAST_ROOM, _MOST_ROOM = 1 << 14, 1 << 23


@dataclass(frozen=True)
class _Search:
    """A set of surfaces that are searched for highlights with the same views and resolution.

    Parameters
    ----------
    surfaces : frozenset of (int, int)
        Group and slot.
    world : bool
        Search the world background instead of surfaces.
    part : tuple of 4 int
        x, y, width, height of the part of the raster that is searched, px.
    subpixels : int
    views : list of (tuple of 2 float, int)
        Places on the lens, m, and the region of the lens that each represents.
    projection : ndarray of shape (4, 4)
        Camera space to clip space of the whole raster.
    areas : LampAreas
        Areas of the instances whose texels are counted.
    """

    surfaces: frozenset
    world: bool
    part: tuple[int, int, int, int]
    subpixels: int
    views: list
    projection: np.ndarray
    areas: LampAreas = NO_AREAS


class HighlightSearch:
    """Lists a frame's highlights.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.
    drawing : SceneDrawing
        Aimed at the frame.
    buffers : SceneBuffers
    split : FrameSplit
        Whose thresholds are found.
    found : passes.bokeh.highlight_list.HighlightList
        Gets the highlights.
    field : tuple of (str, GPUUniformBuf or GPUTexture) or None
        `passes.surface.chromatic.resources`, with chromatic aberration.

    Attributes
    ----------
    sharp : int
        Pixels with light above the threshold whose circle of confusion is too small to be splatted.
    thresholds : tuple of 2 float or None
        The least and the largest threshold of light that was found; None where there was none.
    bytes : int
        Peak memory on the device.
    """

    def __init__(self, plan, drawing, buffers, split, found, field=None):
        self._plan = plan
        self._drawing = drawing
        self._buffers = buffers
        self._split = split
        self._highlights = found
        self._field = field
        self.sharp = 0
        self.thresholds = None
        self.bytes = 0

    def run(self, fullscreen):
        """Search the surfaces and the world for highlights.

        Parameters
        ----------
        fullscreen : GPUBatch
        """
        self._lights = self._drawing.lights.steady()
        for search in self._searches():
            tiles = tiles_of(search.part, search.subpixels)
            if not tiles or not (search.world or search.surfaces):
                continue
            draws = self._draws(search)
            if not (search.world or draws[1]):
                continue
            _, _, width, height = tiles[0]
            fine = search.subpixels
            specs = [TargetSpec("scene", "DEPTH_COMPONENT32F", scale=fine)]
            if search.world:
                specs.append(TargetSpec("through", "R16F", scale=fine))
            with Targets(width, height, specs) as raster:
                self._list_tiles(search, tiles, draws, raster, fullscreen)

    def _list_tiles(self, search, tiles, draws, raster, fullscreen):
        fine = search.subpixels
        room = int(np.clip(_ROOM * raster.width * raster.height * fine**2, _LEAST_ROOM, _MOST_ROOM))
        lists = highlights.FragmentLists(raster.width, raster.height, fine, room)
        rows = len(self._drawing.content.instances.world)
        areas = search.areas.in_tile(search.part, fine, rows)
        counts = highlights.TexelCounts(areas, search.areas.growths(rows))
        # Where a tile's edge cuts a lamp, its texels are counted before any of its light is listed.
        cut = search.areas.any_cut(tiles, fine, areas)
        try:
            for tile in tiles if cut else ():
                lists.clear()
                self._draw(
                    search, tile, search.views[0], draws, raster, (lists, counts, True), fullscreen
                )
            for tile in tiles:
                for view in search.views:
                    held = (lists, counts, not cut)
                    lists = self._list(search, tile, view, draws, raster, held, fullscreen)
        finally:
            lists.release()
            counts.release()

    def _searches(self):
        """Return the searches: surfaces seen from the lens' centre, mirrors from several places."""
        bokeh = self._plan.bokeh
        places = [tuple(place) for place in (bokeh.lens_views * self._plan.lens_extent).tolist()]
        views = list(zip(places, range(1, len(places) + 1), strict=True))
        alone = [((0.0, 0.0), 0)]
        steady, part = bokeh.shining - bokeh.mirroring, self._split.searched
        if not part[2]:
            steady -= bokeh.reflecting
        areas = NO_AREAS
        if not bokeh.draft:
            content, size = self._drawing.content, bokeh.whole[2:]
            areas = lamp_areas(content, steady, self._plan, bokeh.projection, size)
            areas = areas.without_growth(
                content.groups[n] for n in sorted({n for n, _ in bokeh.reflecting})
            )
        deep, deep_mirrors = bokeh.search_projections
        searches = [_Search(steady, False, bokeh.part, bokeh.subpixels, alone, deep, areas)]
        if bokeh.mirroring and part[2]:
            several = views if len(views) > 1 else alone
            fine, mirrors = bokeh.mirroring_subpixels, bokeh.mirroring
            searches.append(_Search(mirrors, False, part, fine, several, deep_mirrors))
        if bokeh.world:
            fine = bokeh.world_subpixels
            around = bokeh.projection
            searches.append(_Search(frozenset(), True, bokeh.whole, fine, alone, around))
        return searches

    def _draws(self, search):
        """Return lists of draws: opaque surfaces not searched, searched, opaque, transparent.

        Of the world only what covers it.
        """
        drawing = self._drawing
        if search.world:
            covers = ()
            if drawing.farthest > self._world_covered_from():
                covers = drawing.full_detail_draws(peel.COVERS)
            return covers, (), (), ()
        shadows = self._plan.shadows
        target = surface_target.lit(peel.HIGHLIGHTS, shadows)
        shining = drawing.full_detail_draws(target, search.surfaces)
        if not shining:
            return (), (), (), ()
        others = drawing.surfaces() - search.surfaces
        see_through = drawing.see_through()
        veils = [
            *drawing.full_detail_draws(
                surface_target.lit(peel.VEILS, shadows), see_through & search.surfaces
            ),
            *drawing.full_detail_draws(peel.OTHER_VEILS, see_through & others),
        ]
        hiders = drawing.full_detail_draws(peel.HIDERS)
        return drawing.full_detail_draws(peel.OPAQUE, others), shining, hiders, veils

    def _draw(self, search, tile, view, draws, raster, held, fullscreen):
        """Draw a tile, seen from a place on the lens, into lists; return its `ViewParams`."""
        params = uniform_buffer(self._raster_params(search, tile, raster))
        framebuffer = raster.framebuffer(depth="scene")
        size = (tile[2] * search.subpixels, tile[3] * search.subpixels)
        with framebuffer.bind(), state.scissored(0, 0, *size):
            framebuffer.clear(depth=1.0)
            self._append(search, draws, params, view[0], held, fullscreen, raster)
        return params

    def _list(self, search, tile, view, draws, raster, held, fullscreen):
        """List the highlights of a tile from one place on the lens; return the lists to reuse."""
        lists, counts, _ = held
        lens, region = view
        lists.clear()
        params = self._draw(search, tile, view, draws, raster, held, fullscreen)
        number, shining, thresholds = lists.read()
        if draws[2] and 0 < number <= lists.capacity:
            self._draw_before(search, tile, params, draws[2:], lens, lists, raster)
            number, shining, thresholds = lists.read()
        if number > lists.capacity:
            # Drawn again into larger lists: texels are not counted twice.
            if number <= _MOST_ROOM:
                lists.release()
                lists = highlights.FragmentLists(
                    raster.width, raster.height, search.subpixels, number
                )
                held = (lists, counts, False)
                return self._list(search, tile, view, draws, raster, held, fullscreen)
            parts = _halves(tile)
            if len(parts) > 1:
                for part in parts:
                    held = (lists, counts, False)
                    lists = self._list(search, part, view, draws, raster, held, fullscreen)
                return lists
        self.bytes = max(self.bytes, raster.bytes + lists.targets.bytes)
        if number == 0:
            return lists
        layers = self._plan.bokeh.layers
        seen = highlights.SearchedRaster(
            params, self._split, search.subpixels, layers, lens, region, self._field
        )
        scene = None if search.world else raster["scene"]
        highlights.order(seen, lists, min(number, lists.capacity), scene, counts)
        self.sharp += self._highlights.append(seen, lists, shining)
        self.thresholds = extremes(self.thresholds, thresholds)
        return lists

    def _append(self, search, draws, params, lens, held, fullscreen, raster):
        buffers = self._buffers
        lists, counts, counting = held
        if search.world:
            world = (buffers.environment_buffer, buffers.environment_image)
            through = self._through(draws[0], params, raster)
            background.list_highlights(fullscreen, params, *world, self._split, lists, through)
            return
        others, shining, *_ = draws
        peel.draw_opaque(others, params, buffers.instances, lens)
        instances, lights = buffers.instances, self._lights
        peel.list_highlights(
            shining, params, instances, lens, lists, self._split, counts, counting, lights
        )
        for draw in (*others, *shining):
            self._drawing.counts.draw_calls += 1
            self._drawing.counts.triangles += draw.triangles * draw.count

    def _world_covered_from(self):
        """Return the depth from which on surfaces are as good as infinitely far, m.

        Visibility counts what is nearer (`hiding_depth` of visibility_lib.glsl).
        """
        moves = highlights.SAME_VIEW / max(self._plan.coc_scale, 1e-30)
        return 1.0 / (1.0 / self._plan.bokeh.world_depth + moves)

    def _through(self, covers, params, raster):
        """Return the transmittance of the surfaces in front of the world, by texel."""
        raster.clear("through", (1.0,) * 4)
        if covers:
            nearest = self._world_covered_from()
            with raster.framebuffer("through").bind():
                peel.cover_world(covers, params, self._buffers.instances, nearest)
        for draw in covers:
            self._drawing.counts.draw_calls += 1
            self._drawing.counts.triangles += draw.triangles * draw.count
        return raster["through"]

    def _draw_before(self, search, tile, params, draws, lens, lists, raster):
        """Draw the occluders before the highlights of a tile, and list transparent surfaces."""
        hiders, veils = draws
        size = (tile[2] * search.subpixels, tile[3] * search.subpixels)
        framebuffer = raster.framebuffer(depth="scene")
        with framebuffer.bind(), state.scissored(0, 0, *size):
            peel.hide_highlights(hiders, params, self._buffers.instances, lens, lists)
            if veils:
                instances = self._buffers.instances
                peel.list_veils(veils, params, instances, lens, lists, self._split, self._lights)
        for draw in (*hiders, *veils):
            self._drawing.counts.draw_calls += 1
            self._drawing.counts.triangles += draw.triangles * draw.count

    def _raster_params(self, search, tile, raster):
        plan, bokeh = self._plan, self._plan.bokeh
        x, y, _, _ = tile
        width, height = raster.width, raster.height
        crop = np.eye(4)
        crop[0, 0], crop[1, 1] = bokeh.width / width, bokeh.height / height
        crop[0, 3] = (bokeh.width - 2 * x - width) / width
        crop[1, 3] = (bokeh.height - 2 * y - height) / height
        return surface.VIEW_PARAMS.pack(
            view=plan.view,
            view_inverse=np.linalg.inv(plan.view),
            projection=crop @ search.projection,
            lens=(plan.focus_distance, float(plan.orthographic), plan.coc_scale, plan.sharp_radius),
            film=(width * search.subpixels, height * search.subpixels, 0.0, 0.0),
        )


def extremes(before, thresholds):
    """Return the least and the largest threshold of `before`, a pair or None, and of an array."""
    least, largest = before or (np.inf, 0.0)
    return min(least, float(thresholds.min())), max(largest, float(thresholds.max()))


def _halves(tile):
    """Divide a tile across its longer side; one of a single pixel stays as it is."""
    x, y, width, height = tile
    if width * height == 1:
        return [tile]
    if width >= height:
        half = width // 2
        return [(x, y, half, height), (x + half, y, width - half, height)]
    half = height // 2
    return [(x, y, width, half), (x, y + half, width, height - half)]
