"""Bokeh of a frame: peel, extract, splat (methods 9 to 13).

Done once a frame, before its first lens sample; what the samples then leave out is what was
splatted here, light for light. A view that moves is given a draft, and the whole in steps when it
has come to rest.
"""

from contextlib import nullcontext
from dataclasses import dataclass, replace

import numpy as np

from ..device import geometry, readback
from ..device.targets import Targets, TargetSpec
from ..device.uniforms import uniform_buffer
from ..passes import background, clusters, highlights, peel, splat, surface
from .bokeh_clusters import similarity_of
from .bokeh_look import make_look
from .bokeh_search import tiles_of
from .bokeh_visibility import BokehVisibility

# Highlights that the list has room for at first.
_FIRST_LIST = 1 << 16
# Sources of a draft, and how often they are merged more boldly to get there.
_DRAFT_SOURCES = 1 << 11
_DRAFT_ROUNDS = 4


@dataclass
class HighlightCounts:
    """What became of a frame's highlights.

    Attributes
    ----------
    found : int
        Pixels of any layer above the threshold.
    clustered : int
        Sources that are left after merging.
    culled_size : int
        Found, but so sharp that the lens samples draw them.
    culled_occlusion, culled_cone : int
        Sources that nothing of the lens sees; sources that need no mask.
    masked : int
        Sources with a mask of their own.
    splatted : int
        Sources that were drawn.
    """

    found: int = 0
    clustered: int = 0
    culled_size: int = 0
    culled_occlusion: int = 0
    culled_cone: int = 0
    masked: int = 0
    splatted: int = 0


@dataclass(frozen=True)
class _Search:
    """Surfaces that are searched for highlights in one way.

    Parameters
    ----------
    surfaces : frozenset of (int, int)
        Group and slot.
    world : bool
        Instead of surfaces, the world.
    part : tuple of 4 int
        Of the raster.
    subpixels : int
    views : list of (tuple of 2 float, int)
        Place on the lens, m, and the region that it stands for.
    """

    surfaces: frozenset
    world: bool
    part: tuple[int, int, int, int]
    subpixels: int
    views: list


def highlight_buffer(bokeh):
    """Upload what divides light into highlights and the rest.

    Parameters
    ----------
    bokeh : BokehPlan

    Returns
    -------
    GPUUniformBuf
        `HighlightParams`.
    """
    settings = bokeh.settings
    return uniform_buffer(
        surface.HIGHLIGHT_PARAMS.pack(
            split=(settings.threshold, bokeh.least_coc, settings.gain, settings.amplification),
            world=(bokeh.world_depth, float(bokeh.world), bokeh.world_share, 0.0),
        )
    )


class BokehStage:
    """Makes a frame's bokeh.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.
    drawing : SceneDrawing
        Aimed at the frame.
    buffers : SceneBuffers
    occluders : SceneOccluders
        Of the drawing's content.
    highlights_buffer : GPUUniformBuf
        See `highlight_buffer`.

    Attributes
    ----------
    counts : HighlightCounts
    report : tuple of str
        What is not as the camera asks, one sentence each; known when discs have been drawn.
    """

    def __init__(self, plan, drawing, buffers, occluders, highlights_buffer):
        self._plan = plan
        self._drawing = drawing
        self._buffers = buffers
        self._occluders = occluders
        self._highlights = highlights_buffer
        self.counts = HighlightCounts()
        self.report = ()
        self.bytes = 0

    def run(self, fullscreen, targets, frame_view, stage=nullcontext):
        """Peel, extract and splat.

        Parameters
        ----------
        fullscreen : GPUBatch
        targets : Targets
            Whose ``bokeh`` gets it.
        frame_view : GPUUniformBuf
            `ViewParams` of the frame.
        stage : callable, optional
            As that of `FrameRenderer.advance`: ``search``, ``merge``, ``visibility``, ``splat``.
        """
        steps = self.steps(fullscreen, targets, frame_view)
        for name in ("search", "merge", "visibility", "splat"):
            with stage(name):
                next(steps, None)

    def steps(self, fullscreen, targets, frame_view):
        """Do the same bit by bit; the picture changes with the last step.

        Yields
        ------
        None
            After each step; closing the generator gives back what it holds.
        """
        held = []
        try:
            sources, count = self._find(fullscreen, held)
            yield
            sources, count = self._merge(sources, count, held)
            visibility = None
            if count:
                yield
                visibility = self._hide(sources, count, held)
                yield
            target = targets.framebuffer("bokeh")
            with target.bind():
                target.clear(color=(0.0, 0.0, 0.0, 0.0))
            if visibility:
                self._splat(sources, count, visibility, target, frame_view)
            self.bytes = max(self.bytes, sum(targets.bytes for targets in held))
        finally:
            for targets in held:
                targets.release()

    def _find(self, fullscreen, held):
        """Return the list of highlights, two textures, and how many they are."""
        room = _FIRST_LIST
        while True:
            with Targets(2, 1, [TargetSpec("total", "R32UI")]) as totals:
                total = totals["total"]
                total.clear(format="UINT", value=(0,))
                specs = [TargetSpec(name, "RGBA32F") for name in "ab"]
                lists = Targets(highlights.COLUMNS, room // highlights.COLUMNS, specs)
                for search in self._searches():
                    tiles = tiles_of(search.part, search.subpixels)
                    if not tiles:
                        continue
                    _, _, width, height = tiles[0]
                    with Targets(width, height, self._specs(search, height)) as layers:
                        for tile in tiles:
                            self._list_tile(search, tile, layers, lists, total, fullscreen)
                        self.bytes = max(self.bytes, layers.bytes)
                        # The layers are given back only after the device has read them.
                        _totals(total)
                count, sharp = _totals(total)
            if count <= room:
                break
            lists.release()
            room = highlights.COLUMNS * -(-count // highlights.COLUMNS)
        held.append(lists)
        self.counts.found = count + sharp
        self.counts.culled_size = sharp
        return (lists["a"], lists["b"]), count

    def _merge(self, sources, count, held):
        """Merge similar highlights, as the model asks for; returns the list and its length."""
        plan = self._plan
        similarity = similarity_of(plan.bokeh.settings, count)
        rounds = _DRAFT_ROUNDS if plan.bokeh.draft else 1
        while similarity and count > 1:
            lens = (plan.focus_distance, float(plan.orthographic), plan.coc_scale, 0.0)
            pixel = 2.0 / (plan.projection[1, 1] * plan.height)
            parameters = clusters.cluster_params(similarity, plan.view, lens, pixel)
            lists, count = clusters.cluster(sources, count, uniform_buffer(parameters), similarity)
            held.append(lists)
            sources = (lists["a"], lists["b"])
            rounds -= 1
            if rounds == 0 or count <= _DRAFT_SOURCES:
                break
            similarity = _bolder(similarity)
        self.counts.clustered = count
        return sources, count

    def _searches(self):
        """Return what is searched in which way: what looks the same from anywhere, and the rest."""
        bokeh = self._plan.bokeh
        places = [tuple(place) for place in (bokeh.lens_views * self._plan.lens_extent).tolist()]
        views = list(zip(places, range(1, len(places) + 1), strict=True))
        alone = [((0.0, 0.0), 0)]
        steady = bokeh.shining - bokeh.mirroring
        searches = [_Search(steady, False, bokeh.part, bokeh.subpixels, alone)]
        if bokeh.mirroring:
            several = views if len(views) > 1 else alone
            fine = bokeh.mirroring_subpixels
            searches.append(_Search(bokeh.mirroring, False, bokeh.whole, fine, several))
        if bokeh.world:
            searches.append(_Search(frozenset(), True, bokeh.whole, bokeh.world_subpixels, alone))
        return searches

    def _list_tile(self, search, tile, layers, lists, total, fullscreen):
        """List what a tile shows, view by view and layer by layer, as long as there is more."""
        view = uniform_buffer(self._raster_params(tile, layers, search.subpixels))
        for lens, region in search.views:
            found = _totals(total) if search.surfaces else None
            peel_layers = self._peel_world if search.world else self._peel
            for layer in peel_layers(search, layers, view, lens, fullscreen):
                shape = (tile[2:], search.subpixels, lens, region)
                peeled = highlights.PeeledRaster((layer,), view, self._highlights, *shape)
                highlights.count(peeled, layers["counts"], layers["rows"], total)
                highlights.emit(peeled, layers["counts"], layers["rows"], (lists["a"], lists["b"]))
                before, found = found, _totals(total)
                if found == before:
                    break

    def _hide(self, sources, count, held):
        """Find what hides the sources from the lens, as `Visibility`."""
        visibility = BokehVisibility(self._plan, self._occluders, self._buffers)
        found = visibility.find(sources[0], count, self._drawing, held)
        counts = found.counts
        self.counts.culled_occlusion = counts.outside + counts.hidden
        self.counts.culled_cone = counts.visible + counts.free
        self.counts.masked = counts.masked
        self.counts.splatted = count - self.counts.culled_occlusion
        merged = self._plan.bokeh.settings.model == "CLUSTERED" or self._plan.bokeh.draft
        if merged and counts.masked and counts.method != "SPLAT":
            masks = found.masks
            soft = Targets(masks.width, masks.height, [TargetSpec("masks", "R16F")])
            held.append(soft)
            clusters.soften(sources[0], count, found, soft["masks"])
            found = replace(found, masks=soft["masks"])
        return found

    @staticmethod
    def _specs(search, height):
        fine = search.subpixels
        # A layer and the one before it.
        colors = ["world"] if search.world else ["light_color_0", "light_color_1"]
        depths = [] if search.world else ["light_depth_0", "light_depth_1", "scene_depth"]
        specs = [TargetSpec(name, "RGBA32F", scale=fine) for name in colors]
        specs += [TargetSpec(name, "DEPTH_COMPONENT32F", scale=fine) for name in depths]
        specs.append(TargetSpec("counts", "R32UI", 1))
        specs.append(TargetSpec("rows", "R32UI", size=(height, 2)))
        return specs

    def _raster_params(self, tile, layers, subpixels):
        plan, bokeh = self._plan, self._plan.bokeh
        x, y, _, _ = tile
        width, height = layers.width, layers.height
        crop = np.eye(4)
        crop[0, 0], crop[1, 1] = bokeh.width / width, bokeh.height / height
        crop[0, 3] = (bokeh.width - 2 * x - width) / width
        crop[1, 3] = (bokeh.height - 2 * y - height) / height
        return surface.VIEW_PARAMS.pack(
            view=plan.view,
            view_inverse=np.linalg.inv(plan.view),
            projection=crop @ bokeh.projection,
            lens=(plan.focus_distance, float(plan.orthographic), plan.coc_scale, plan.sharp_radius),
            film=(width * subpixels, height * subpixels, 0.0, 0.0),
        )

    def _peel(self, search, layers, view, lens, fullscreen):
        """Draw what is brighter than the threshold, layer by layer.

        Yields
        ------
        tuple of 2 GPUTexture
            Light and depth of a layer, to be read before the next.
        """
        drawing = self._drawing
        shining = drawing.full_detail_draws(peel.HIGHLIGHTS, search.surfaces)
        if not shining:
            return
        before, layer = (("light_color_1", "light_depth_1"), ("light_color_0", "light_depth_0"))
        nothing = layers.framebuffer(before[0], depth=before[1])
        with nothing.bind():
            nothing.clear(color=(0.0, 0.0, 0.0, 0.0), depth=0.0)
        # The first layer's colour is drawn over by its highlights.
        opaque = drawing.full_detail_draws(peel.OPAQUE)
        self._draw_layer(layers, view, opaque, before[1:], (layer[0], "scene_depth"), lens)
        for _ in range(self._plan.bokeh.layers):
            self._draw_layer(layers, view, shining, (*before[::-1], "scene_depth"), layer, lens)
            yield tuple(layers[name] for name in layer)
            before, layer = layer, before

    def _peel_world(self, search, layers, view, lens, fullscreen):
        """Draw what of the world is brighter than the threshold; yields it, without a depth."""
        with layers.framebuffer("world").bind():
            background.draw_excess(
                fullscreen,
                view,
                self._buffers.environment_buffer,
                self._buffers.environment_image,
                self._highlights,
            )
        yield layers["world"], None

    def _draw_layer(self, layers, view, draws, textures, layer, lens):
        color, depth = layer
        framebuffer = layers.framebuffer(color, depth=depth)
        with framebuffer.bind():
            framebuffer.clear(color=(0.0, 0.0, 0.0, 0.0), depth=1.0)
            read = [layers[name] for name in textures]
            instances = self._buffers.instances
            peel.draw_layer(draws, view, instances, read, self._highlights, lens)
        self._drawing.counts.draw_calls += len(draws)
        self._drawing.counts.triangles += sum(d.triangles * d.count for d in draws)

    def _splat(self, sources, count, visibility, target, frame_view):
        rays = None
        if visibility.counts.method == "SPLAT":
            rays = (visibility.layers, visibility.opacity, visibility.states, visibility.parameters)
        look = make_look(self._plan)
        self.report = look.report
        with target.bind():
            splat.splat(
                geometry.square_batch(),
                count,
                (*sources, visibility.tiles, visibility.masks),
                look,
                frame_view,
                rays,
            )
        # What it reads is given back only after the device has read it.
        readback.wait(target)


def _totals(total):
    """Read how many highlights have been listed, and how many texels were too sharp."""
    return tuple(int(n) for n in np.asarray(total.read()).ravel()[:2])


def _bolder(similarity):
    """Return what merges highlights that differ twice as much."""
    return replace(
        similarity,
        cell=2.0 * similarity.cell,
        extent=2.0 * similarity.extent,
        harm=4.0 * similarity.harm,
    )
