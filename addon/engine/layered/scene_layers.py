"""Depth layers of a scene: drawn from the middle of the lens, a slice or a peel of the scene each.

Slices are planned as a capture plans them, from the depths that are in view: bounds of objects say
little of a floor that goes on under the camera. What chance makes transparent is left out: it is
drawn anew for every lens sample.
"""

import numpy as np

from ...device import state
from ...device.targets import Targets, TargetSpec
from ...device.uniforms import uniform_buffer
from ...layers.slices import MEASURED_SIDE, plan_slices
from ...passes.layered import joining, layers
from ...passes.surface import surface
from .layer_raster import (
    DeviceLayers,
    clip_planes,
    clipped_projection,
    depth_in_window,
    layer_raster,
)

# Of a depth: what lies on the outermost planes is inside.
_ROUNDING = 1e-4
# How often depths in view are measured: nearer things need a wider picture, which shows more.
_MEASURES = 2


def draw_scene_layers(plan, drawing, draws, shapes, instances, mattes, resources, blur=()):
    """Draw a scene into depth layers.

    Parameters
    ----------
    plan : FramePlan
        With `layered`.
    drawing : SceneDrawing
        Aimed at the frame.
    draws : list of Draw
        Of what is drawn, for `passes.surface.surface_target.of_layers`.
    shapes : list of Draw
        Of the same, for `passes.bokeh.peel.OPAQUE`.
    instances : GPUTexture
    mattes : bool
        The draws have a second target, of mattes.
    resources : dict
        ``highlights``, ``optics`` and ``lights`` of `passes.surface.surface.draw_sample`.
    blur : tuple of (str, GPUUniformBuf or GPUTexture)
        `passes.surface.real_lens.LensSample.blur_resources`, with a real lens and mattes.

    Returns
    -------
    DeviceLayers
    """
    drawn = _Slices(plan, draws, shapes, instances, mattes, resources, blur)
    near, far, nearest, farthest = _depths(plan, drawing, drawn)
    count, eyes = plan.layered.count, plan.layered.eyes
    planes = [(near, far)] * count
    if not plan.layered.peeled:
        slices = plan_slices(count, nearest, farthest, near, far, plan.orthographic)
        planes = [(slice_.clip_start, slice_.clip_end) for slice_ in slices]
    raster = layer_raster(plan, nearest, farthest)
    sides = (raster.width, raster.height)
    textures = drawn.draw(raster, sides, planes, eyes, raster.parts)
    if not plan.layered.peeled:
        joining.join(textures, len(planes), len(eyes))
    drawing.counts.draw_calls += drawn.times * len(draws)
    drawing.counts.triangles += drawn.times * sum(d.triangles * d.count for d in draws)
    layers.build_pyramids(textures, *sides, len(planes), False, len(eyes))
    return DeviceLayers(textures, raster, len(planes), nearest, filtered=False)


def _depths(plan, drawing, drawn):
    """Return where layers begin and end, and the nearest and farthest depths in view, m."""
    near, far = clip_planes(plan.projection)
    nearest, farthest = max(drawing.nearest, near), min(drawing.farthest, far)
    if not nearest < farthest:
        # Nothing is in view, or all at one depth.
        nearest = min(max(farthest, near), nearest)
        farthest = 2.0 * nearest
    # The first and the last layer have all that there may be beside what was measured.
    near = max(near, nearest * (1.0 - _ROUNDING))
    far = min(far, farthest * (1.0 + _ROUNDING))
    nearest, farthest = near, far
    raster = None
    for _ in range(_MEASURES):
        wider, raster = raster, layer_raster(plan, nearest, farthest)
        seen = raster != wider and drawn.depths(raster, (near, far))
        if not seen:
            break
        nearest, farthest = seen
    return near, far, nearest, farthest


class _Slices:
    """Draws slices of a scene.

    Parameters
    ----------
    plan : FramePlan
    draws, shapes, instances, mattes, resources, blur
        As of `draw_scene_layers`.

    Attributes
    ----------
    times : int
        How often the scene was drawn so far.
    """

    def __init__(self, plan, draws, shapes, instances, mattes, resources, blur):
        self._plan = plan
        self._draws = draws
        self._shapes = shapes
        self._instances = instances
        self._slots = ("color", "mattes")[: 1 + mattes]
        self._resources = resources
        self._blur = blur
        self.times = 0

    def draw(self, raster, sides, planes, eyes, parts=1):
        """Draw slices into new layers.

        Parameters
        ----------
        raster : LayerRaster
            What they show.
        sides : tuple of 2 int
            Width and height, texels.
        planes : list of (float, float)
            Depths that they lie between, m.
        eyes : ndarray of shape (E, 2)
            As `LayeredPlan.eyes`.
        parts : int
            Of a texel along each side that its shape is drawn in.

        Returns
        -------
        Targets
            Of `passes.layered.layers.specs`, without pyramids.
        """
        plan, mattes = self._plan, len(self._slots) > 1
        projection, origin = self._shown(raster, sides)
        # Peeled layers take turns with the depths: what is drawn lies behind the one before.
        depths = ("depth", "front")
        specs = [TargetSpec(name, "RGBA32F") for name in self._slots]
        specs += [TargetSpec(name, "DEPTH_COMPONENT32F") for name in depths]
        made = Targets(*sides, layers.specs(*sides, len(planes), mattes, len(eyes)))
        if parts > 1:
            specs.append(TargetSpec("shape", "DEPTH_COMPONENT32F", scale=parts))
        with Targets(*sides, specs) as drawn:
            with drawn.framebuffer(depth="front").bind():
                drawn.framebuffer(depth="front").clear(depth=0.0)
            for number, pair in enumerate(planes):
                clipped = clipped_projection(projection, *pair)
                view = self._view(clipped, sides, origin)
                seen = {name: drawn[name] for name in self._slots}
                if parts > 1:
                    self._draw_shape(drawn, "shape", view)
                    seen["shape"] = drawn["shape"]
                for turn, eye in enumerate(eyes):
                    self._draw(drawn, depths, view, eye)
                    seen["depth"] = drawn[depths[0]]
                    slot = turn * len(planes) + number
                    layers.pack(seen, number, made, clipped, plan.projection, slot, parts)
                if plan.layered.peeled:
                    depths = depths[::-1]
        return made

    def depths(self, raster, planes):
        """Return the least and the largest depth that a raster shows between two depths, m.

        Returns
        -------
        tuple of 2 float, or None
            None where nothing is in view.
        """
        shown = np.array([raster.width, raster.height]) / raster.fine
        sides = np.ceil(shown * min(1.0, MEASURED_SIDE / shown.max())).astype(int).tolist()
        projection, origin = self._shown(raster, sides)
        clipped = clipped_projection(projection, *planes)
        specs = [TargetSpec("color", "RGBA32F"), TargetSpec("depth", "DEPTH_COMPONENT32F")]
        made = Targets(*sides, layers.specs(*sides, 1))
        with made, Targets(*sides, specs) as drawn:
            self._draw_shape(drawn, "depth", self._view(clipped, sides, origin))
            seen = {name: drawn[name] for name in ("color", "depth")}
            layers.pack(seen, 0, made, clipped, self._plan.projection)
            layers.build_pyramids(made, *sides, 1, False)
            least, largest = layers.depth_range(made, *sides)
        if least > largest:
            return None
        found = (depth_in_window(self._plan, value) for value in (least, largest))
        return tuple(float(np.clip(depth, *planes)) for depth in found)

    def _draw_shape(self, drawn, name, view):
        framebuffer = drawn.framebuffer(depth=name)
        with framebuffer.bind():
            framebuffer.clear(depth=1.0)
            state.opaque()
            surface.draw_sample(self._shapes, view, self._instances, (0.0,) * 4, 0)
        self.times += 1

    def _draw(self, drawn, depths, view, eye):
        depth, front = depths
        for name in self._slots:
            drawn.clear(name, (0.0, 0.0, 0.0, 0.0))
        bindings = (("front_tx", drawn[front]), ("eye", tuple(eye.tolist())), *self._blur)
        framebuffer = drawn.framebuffer(*self._slots, depth=depth)
        with framebuffer.bind():
            framebuffer.clear(depth=1.0)
            state.opaque()
            surface.draw_sample(
                self._draws,
                view,
                self._instances,
                (0.0,) * 4,
                0,
                bindings,
                **self._resources,
            )
        self.times += 1

    def _shown(self, raster, sides):
        """Return the projection of a raster, and where it begins in the picture, texels."""
        plan, shown = self._plan, np.array([raster.width, raster.height]) / raster.fine
        projection = np.diag([*(plan.width, plan.height) / shown, 1.0, 1.0]) @ plan.projection
        return projection, (np.array(plan.origin) - raster.margin) * sides / shown

    def _view(self, projection, sides, origin):
        plan = self._plan
        lens = (plan.focus_distance, float(plan.orthographic), plan.coc_scale, plan.sharp_radius)
        return uniform_buffer(
            surface.VIEW_PARAMS.pack(
                view=plan.view,
                view_inverse=np.linalg.inv(plan.view),
                projection=projection,
                lens=lens,
                film=(*sides, *origin),
            )
        )
