"""The list of a captured picture's highlights (methods 9).

A captured layer is what a peeled layer is to the search in a scene: each of its pixels that is
brighter than the threshold is a fragment, whatever is in front of it.
"""

from ...device.uniforms import uniform_buffer
from ...passes.bokeh import highlights, layer_highlights
from ..layered.stack_layers import stack_view
from .listing import extremes


class StackHighlightSearch:
    """Lists the highlights of a captured picture; used as `HighlightSearch` is.

    Parameters
    ----------
    plan : FramePlan
        With a `bokeh`, of a captured picture.
    buffers : SceneBuffers
        With the picture, as `captured`.
    split : FrameSplit
        Whose thresholds are found.
    found : passes.bokeh.highlight_list.HighlightList
        Gets the highlights.
    field : tuple of (str, GPUUniformBuf or GPUTexture) or None
        `passes.surface.chromatic.resources`, with chromatic aberration.

    Attributes
    ----------
    sharp, thresholds, bytes
        As of `HighlightSearch`.
    """

    def __init__(self, plan, buffers, split, found, field=None):
        self._plan = plan
        self._found = buffers.captured.highlights(plan)
        self._split = split
        self._highlights = found
        view = uniform_buffer(stack_view(plan))
        layers = max(plan.bokeh.layers, plan.layered.count)
        self._seen = highlights.SearchedRaster(view, split, 1, layers, field=field)
        self.sharp = self.bytes = 0
        self.thresholds = None

    def run(self, _fullscreen):
        """List the highlights of surfaces, and of the world."""
        of_surfaces, of_world = self._found.runs
        for first, number in of_surfaces:
            self._list(self._found.surfaces[0], first, number, self._found.nearest)
        for first, number in of_world if self._plan.bokeh.world else ():
            self._list(self._found.world[0], first, number, None)

    def _list(self, entries, first, number, scene):
        bokeh = self._plan.bokeh
        lists = highlights.FragmentLists(bokeh.width, bokeh.height, 1, number)
        try:
            lists.clear()
            layer_highlights.append(entries, first, number, self._split, self._seen.view, lists)
            listed, tiles, thresholds = lists.read()
            self.bytes = max(self.bytes, lists.targets.bytes)
            if listed == 0:
                # All are hidden by what is right in front of them.
                return
            highlights.order(self._seen, lists, listed, scene)
            self.sharp += self._highlights.append(self._seen, lists, tiles)
            self.thresholds = extremes(self.thresholds, thresholds)
        finally:
            lists.release()
