"""The split of a frame's light between lens samples and splats: its thresholds, found once a frame.

Where the threshold is automatic, all that is searched is drawn once as the lens' middle sees it, at
half the picture's resolution, and averaged over squares of all sizes. Then reflecting surfaces are
drawn once, to find the tiles in which any are as bright as a highlight there: elsewhere the lens
samples keep their light, and no search for it is needed. (Surfaces whose reflections may be smaller
than what that drawing shows are searched wherever they are.)
"""

import copy

import numpy as np

from ...device import state
from ...device.targets import Targets, TargetSpec, atlas_size, level_count
from ...device.uniforms import uniform_buffer
from ...passes import background
from ...passes.bokeh import highlights, peel, surroundings
from ...passes.bokeh.split_light import SplitLight
from ...passes.surface import surface, surface_target

# How often the means are taken again, without the light that the ones before leave to be splatted.
_ROUNDS = 3
# Longest side of the drawing that finds tiles, texels: a wide overscan is drawn coarser.
_LONGEST = 4096
# Of the split that leaves all light to the lens samples.
_NEVER = 1e30


class FrameSplit:
    """The split of a frame's light; bound as a `passes.bokeh.split_light.SplitLight` is.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`.
    optics : callable
        From None to what is bound for a drawing from the lens' middle; as of `SceneDrawing.aim`.

    Attributes
    ----------
    light : passes.bokeh.split_light.SplitLight
    searched : tuple of 4 int
        x, y, width and height of the part of the raster of the search in which reflecting surfaces
        are searched, px; without area where they have no highlights.
    """

    def __init__(self, plan, optics):
        bokeh = plan.bokeh
        self._plan, self._optics = plan, optics
        self._found = not bokeh.contrast
        self.searched = bokeh.whole
        specs = [TargetSpec("candidates", "R32UI", size=self._tiles)]
        specs.append(
            TargetSpec("surroundings", surroundings.SURROUNDINGS_FORMAT, size=self._surroundings)
        )
        self._targets = Targets(1, 1, specs)
        self._targets["candidates"].clear(format="UINT", value=(1,))
        self._targets.clear("surroundings", (0.0,) * 4)
        self._targets["surroundings"].filter_mode(True)
        self.light = self._light(self._params())

    @property
    def _captured(self):
        return self._plan.layered is not None and self._plan.layered.stack is not None

    @property
    def _surroundings(self):
        bokeh = self._plan.bokeh
        return surroundings.surroundings_size(*bokeh.whole[2:]) if bokeh.contrast else (2, 1)

    @property
    def _tiles(self):
        bokeh = self._plan.bokeh
        if not bokeh.contrast or self._captured:
            return (1, 1)
        return tuple(-(-side // surroundings.TILE) for side in (bokeh.width, bokeh.height))

    def bind(self, shader):
        """Bind what a shader declares of it."""
        self.light.bind(shader)

    def sharp(self, bokeh):
        """Return the split with the same thresholds and another `BokehPlan`."""
        other = copy.copy(self)
        other.light = self._light(self._params(bokeh))
        return other

    def _light(self, params):
        return SplitLight(
            uniform_buffer(params), self._targets["surroundings"], self._targets["candidates"]
        )

    def _params(self, bokeh=None, **others):
        plan, bokeh = self._plan, bokeh or self._plan.bokeh
        settings = bokeh.settings
        values = {
            "split": (settings.least_threshold, bokeh.least_coc, settings.gain, plan.empty_coc),
            "world": (bokeh.world_depth, float(bokeh.world), bokeh.world_share, 0.0),
            "raster": bokeh.projection,
            "views": (*plan.lens_extent, np.sqrt(len(bokeh.lens_views)), 0.0),
            "automatic": (
                bokeh.contrast,
                float(level_count(bokeh.width, bokeh.height)),
                bokeh.width / surroundings.TILE,
                bokeh.height / surroundings.TILE,
            ),
            "size": (bokeh.width, bokeh.height, self._surroundings[0] / 2, self._surroundings[1]),
        }
        return surface.HIGHLIGHT_PARAMS.pack(**values | others)

    def find(self, drawing, buffers, fullscreen):
        """Find the thresholds, once.

        Parameters
        ----------
        drawing : SceneDrawing
            Aimed at the frame.
        buffers : SceneBuffers
        fullscreen : GPUBatch
        """
        if self._found:
            return
        self._found = True
        size = self._plan.bokeh.whole[2:]
        specs = [
            TargetSpec("means", surroundings.MEANS_FORMAT, size=atlas_size(*size)),
            TargetSpec("before", surroundings.SURROUNDINGS_FORMAT, size=self._surroundings),
        ]
        if not self._captured:
            specs.append(TargetSpec("color", "RGBA32F"))
            specs.append(TargetSpec("depth", "DEPTH_COMPONENT32F"))
        with Targets(*(-(-side // 2) for side in size), specs) as targets:
            for name in ("means", "before"):
                targets[name].filter_mode(True)
            if self._captured:
                self._average(buffers.captured.picture(self._plan), targets)
                return
            self._draw(targets, drawing, buffers, fullscreen)
            self._average((targets["color"], targets["depth"]), targets)
            self._find_tiles(drawing, buffers, targets["means"])

    def _draw(self, targets, drawing, buffers, fullscreen):
        """Draw the picture but veils as the lens' middle sees it, with all light."""
        world = drawing.content.world
        view = self._view(self._plan.bokeh.projection, (targets.width, targets.height))
        framebuffer = targets.framebuffer("color", depth="depth")
        with framebuffer.bind():
            framebuffer.clear(color=(*world.color, 1.0), depth=1.0)
        whole = self._light(self._params(split=(_NEVER, 1.0, 1.0, 0.0), automatic=(0.0,) * 4))
        draws = drawing.full_detail_draws(drawing.target)
        resources = {"highlights": whole, "optics": self._optics(None)}
        resources["lights"] = drawing.lights.steady()
        with framebuffer.bind():
            state.opaque()
            surface.draw_sample(draws, view, buffers.instances, (0.0,) * 4, 0, **resources)
        drawing.counts.draw_calls += len(draws)
        drawing.counts.triangles += sum(draw.triangles * draw.count for draw in draws)
        if world.image:
            with framebuffer.bind():
                image = (buffers.environment_buffer, buffers.environment_image)
                background.draw(fullscreen, view, *image, (0.0,) * 4)

    def _average(self, picture, targets):
        """Find the surroundings."""
        bokeh = self._plan.bokeh
        view = self._view(bokeh.projection, bokeh.whole[2:])
        # The last round must end in what is bound.
        textures = (self._targets["surroundings"], targets["before"])
        before = None
        for number in reversed(range(_ROUNDS)):
            found, means = textures[number % 2], targets["means"]
            split = self.light.buffer
            surroundings.find(picture, bokeh.whole[2:], means, found, view, split, before)
            before = found

    def _find_tiles(self, drawing, buffers, means):
        """Find the tiles in which reflecting surfaces are searched."""
        plan, bokeh = self._plan, self._plan.bokeh
        if not bokeh.reflecting:
            self.searched = (0, 0, 0, 0)
            return
        lit = surface_target.lit(peel.CANDIDATES, plan.shadows)
        coarser = 0
        while max(bokeh.width, bokeh.height) >> coarser > _LONGEST and coarser < 4:
            coarser += 1
        size = tuple(-(-side >> coarser) for side in (bokeh.width, bokeh.height))
        lights = drawing.lights.steady()
        tiles = [TargetSpec("marks", "R32UI", size=self._tiles)]
        tiles.append(TargetSpec("finished", "R32UI", size=(2, 1)))
        with Targets(*size, [TargetSpec("raster", "DEPTH_COMPONENT32F"), *tiles]) as targets:
            marks = targets["marks"]
            marks.clear(format="UINT", value=(0,))
            framebuffer = targets.framebuffer(depth="raster")
            projections = zip((False, True), bokeh.search_projections, strict=True)
            for mirroring, projection in projections:
                view = self._view(projection, size)
                keys = {key for key in bokeh.reflecting if (key in bokeh.mirroring) == mirroring}
                for target, wanted, resources in (
                    (lit, keys - bokeh.glinting, (self.light, means, lights)),
                    (peel.GLINTS, keys & bokeh.glinting, ()),
                ):
                    draws = drawing.full_detail_draws(target, wanted) if wanted else ()
                    raster = (view, buffers.instances, marks, surroundings.TILE >> coarser)
                    with framebuffer.bind():
                        peel.mark_candidates(draws, *raster, *resources)
                    for draw in draws:
                        drawing.counts.draw_calls += 1
                        drawing.counts.triangles += draw.triangles * draw.count
            highlights.finish(targets["finished"])
            surroundings.spread(marks, self._targets["candidates"])
            # In the same stretch of work in which the search reads what it lists.
            found = self._targets["candidates"]
            found = np.array(found.read(), np.uint32).reshape(found.height, found.width)
        self.searched = _part_of(found, bokeh.whole[2:])

    def _view(self, projection, size):
        plan = self._plan
        return uniform_buffer(
            surface.VIEW_PARAMS.pack(
                view=plan.view,
                view_inverse=np.linalg.inv(plan.view),
                projection=projection,
                lens=(
                    *(plan.focus_distance, float(plan.orthographic)),
                    *(plan.coc_scale, plan.sharp_radius),
                ),
                film=(*map(float, size), 0.0, 0.0),
            )
        )


def _part_of(tiles, size):
    """Return x, y, width and height, px, of the part of a raster in which tiles are marked."""
    rows, columns = np.nonzero(tiles)
    if len(rows) == 0:
        return (0, 0, 0, 0)
    side = surroundings.TILE
    left, below = int(columns.min()) * side, int(rows.min()) * side
    right = min((int(columns.max()) + 1) * side, size[0])
    above = min((int(rows.max()) + 1) * side, size[1])
    return (left, below, right - left, above - below)
