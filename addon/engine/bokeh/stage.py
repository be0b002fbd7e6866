"""The bokeh of a frame: search, merge, visibility, splat (methods 9 to 13).

Done once a frame, before its first lens sample; the samples then leave out exactly the light that
was splatted here. A moving view gets a draft, and the whole bokeh in steps when it rests.
"""

from contextlib import nullcontext
from dataclasses import dataclass, replace

from ...device import geometry, readback
from ...device.targets import Targets, TargetSpec
from ...device.uniforms import uniform_buffer
from ...passes.bokeh import clusters, splat
from ...passes.bokeh.highlight_list import HighlightList
from ..visibility.stage import BokehVisibility
from .clusters import similarity_of
from .listing import HighlightSearch
from .look import look_in_steps, make_look
from .marks import draw_marks, fates, with_sharp
from .stack_listing import StackHighlightSearch

# Most sources of a draft, and how often the bounds of merging are widened to get there.
_DRAFT_SOURCES = 1 << 11
_DRAFT_ROUNDS = 4


@dataclass
class HighlightCounts:
    """Numbers of a frame's highlights by their fate.

    Attributes
    ----------
    found : int
        Pixels of any layer above the threshold.
    clustered : int
        Sources that are left after merging.
    culled_size : int
        Highlights so sharp that the lens samples draw them.
    culled_occlusion, culled_cone : int
        Sources hidden from the whole lens; sources without occluders, which need no mask.
    masked : int
        Sources with a visibility mask.
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
    split : FrameSplit
    field : tuple of (str, GPUUniformBuf or GPUTexture) or None
        `passes.surface.chromatic.resources`, with chromatic aberration.
    lens : passes.surface.real_lens.LensSample or None
        As of `BokehLook`.

    Attributes
    ----------
    counts : HighlightCounts
    report : tuple of str
        Warnings: settings of the camera that cannot be met; known when discs have been drawn.
    fates : dict of str to int
        Numbers of sources by fate, by the names of `passes.bokeh.marks.FATES`.
    thresholds : tuple of 2 float or None
        The least and the largest threshold of light that was found; None where there was none.
    """

    def __init__(self, plan, drawing, buffers, occluders, split, field=None, lens=None):
        self._plan = plan
        self._drawing = drawing
        self._buffers = buffers
        self._occluders = occluders
        self._split = split
        self._field = field
        self._lens = lens
        self.counts = HighlightCounts()
        self.fates = {}
        self.thresholds = None
        self.report = ()
        self.bytes = 0
        self._unpaired = 0

    def run(self, fullscreen, targets, frame_view, stage=nullcontext):
        """Search, merge, test the visibility, and splat.

        Parameters
        ----------
        fullscreen : GPUBatch
        targets : Targets
            Its target ``bokeh`` gets the discs.
        frame_view : GPUUniformBuf
            `ViewParams` of the frame, in pixels.
        stage : callable, optional
            As that of `FrameRenderer.advance`: ``search``, ``merge``, ``visibility``, ``splat``.
        """
        steps = self.steps(fullscreen, targets, frame_view)
        for name in ("search", "merge", "visibility", "splat"):
            with stage(name):
                next(steps, None)
                while name == "splat" and next(steps, self) is not self:
                    pass

    def divide(self, fullscreen):
        """Find, once a frame, which light is splatted and which the lens samples draw."""
        self._split.find(self._drawing, self._buffers, fullscreen)

    def steps(self, fullscreen, targets, frame_view):
        """Do what `run` does in steps; the picture changes with the last step.

        Yields
        ------
        None
            After each step; closing the generator releases what it holds.
        """
        held = []
        try:
            sources, count = listed = self._find(fullscreen, held)
            yield
            sources, count = merged = self._merge(sources, count, held)
            visibility = None
            if count:
                yield
                visibility = self._hide(sources, count, held)
                yield
                yield from look_in_steps(self._plan)
            target = targets.framebuffer("bokeh")
            with target.bind():
                target.clear(color=(0.0, 0.0, 0.0, 0.0))
            if visibility:
                self._splat(sources, count, visibility, target, frame_view, held)
            self.fates = fates(self.counts, visibility and visibility.counts)
            if "marks" in targets:
                marks = targets.framebuffer("marks")
                draw_marks(
                    self._plan,
                    marks,
                    frame_view,
                    listed,
                    merged,
                    visibility,
                    lambda: self._with_sharp()._find(fullscreen, held),
                )
            self.bytes = max(self.bytes, sum(targets.bytes for targets in held))
        finally:
            for targets in held:
                targets.release()

    def _find(self, fullscreen, held):
        """Return the list of highlights, two textures, and their number."""
        self.divide(fullscreen)
        found = HighlightList()
        held.append(found)
        search = self._search(found)
        search.run(fullscreen)
        self.bytes = max(self.bytes, search.bytes)
        self.counts.found = found.count + search.sharp
        self.counts.culled_size = search.sharp
        self.thresholds = search.thresholds
        return found.textures, found.count

    def _search(self, found):
        split, field = self._split, self._field
        if self._plan.layered and self._plan.layered.stack:
            return StackHighlightSearch(self._plan, self._buffers, split, found, field)
        return HighlightSearch(self._plan, self._drawing, self._buffers, split, found, field)

    def _with_sharp(self):
        """Return a stage that also lists highlights that are too sharp to be splatted."""
        bokeh = with_sharp(self._plan.bokeh)
        plan = replace(self._plan, bokeh=bokeh)
        parts = (self._drawing, self._buffers, self._occluders)
        return BokehStage(plan, *parts, self._split.sharp(bokeh), self._field, self._lens)

    def _merge(self, sources, count, held):
        """Merge similar highlights as the settings ask for; return the list and its length."""
        plan = self._plan
        similarity = similarity_of(plan.bokeh.settings, count)
        rounds = _DRAFT_ROUNDS if plan.bokeh.draft else 1
        while similarity and count > 1:
            colors = plan.bokeh.colors
            focus = colors.focus_distance if colors else plan.focus_distance
            lens = (focus, float(plan.orthographic), plan.coc_scale, 0.0)
            pixel = 2.0 / (plan.projection[1, 1] * plan.height)
            parameters = clusters.cluster_params(similarity, plan.view, lens, pixel)
            parameters = uniform_buffer(parameters)
            lists, count, unpaired = clusters.cluster(sources, count, parameters, similarity)
            held.append(lists)
            if unpaired:
                self._unpaired = unpaired
            sources = (lists["a"], lists["b"])
            rounds -= 1
            if rounds == 0 or count <= _DRAFT_SOURCES:
                break
            similarity = _bolder(similarity)
        self.counts.clustered = count
        return sources, count

    def _told_of_merging(self):
        if not self._unpaired:
            return ()
        return (
            f"bokeh: {self._unpaired} clusters are more than the {clusters.MOST_PAIRED} that Merge"
            " All compares with one another; neighbours were merged instead (raise Levels or"
            " Similarity)",
        )

    def _hide(self, sources, count, held):
        """Find the visibility of the sources from the lens, as `Visibility`."""
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

    def _splat(self, sources, count, visibility, target, frame_view, held):
        rays = None
        if visibility.counts.method == "SPLAT":
            rays = (visibility.layers, visibility.opacity, visibility.states, visibility.parameters)
        look = make_look(self._plan, self._buffers.look_textures, self._field, self._lens)
        self.report = (*look.report, *self._told_of_merging())
        with target.bind():
            densities = splat.splat(
                geometry.square_batch(),
                count,
                (*sources, visibility.tiles, visibility.masks),
                look,
                frame_view,
                rays,
            )
        held.append(densities)
        # Wait: the textures may be released only after the device has read them.
        readback.wait(target)


def _bolder(similarity):
    """Return a `Similarity` that merges highlights that differ twice as much."""
    return replace(
        similarity,
        cell=2.0 * similarity.cell,
        extent=2.0 * similarity.extent,
        harm=4.0 * similarity.harm,
    )
