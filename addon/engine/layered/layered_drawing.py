"""Lens samples as rays through depth layers of the scene (methods 7).

The scene is drawn once a layer, from the middle of the lens, between the near and the far plane of
the layer; what chance makes transparent, and light that is added to what is behind it, is drawn
anew for every sample, in front of what its rays have met.

References
----------
Lee, Eisemann and Seidel, SIGGRAPH Asia 2009.
"""

from dataclasses import dataclass

import numpy as np

from ...device import state
from ...device.targets import Targets, TargetSpec
from ...device.textures import texture_2d
from ...device.uniforms import uniform_buffer
from ...layers.cuts import OVERLAP, layer_cuts
from ...passes.layered import cast, layers
from ...passes.surface import surface

# Texels of all layers together, and along a side of a pixel: what is in focus is as smooth as the
# pixel filter makes it only where texels are finer than pixels.
_MOST_TEXELS = 1 << 25
_FINEST = 3
# Of a depth: what lies on the outermost planes is inside.
_ROUNDING = 1e-4


@dataclass(frozen=True)
class LayerRaster:
    """The raster of the layers.

    Parameters
    ----------
    width, height : int
        In texels.
    fine : int
        Texels along a side of a pixel.
    margin : tuple of 2 int
        Pixels beyond the frame on the left and right, at the bottom and the top.
    """

    width: int
    height: int
    fine: int
    margin: tuple[int, int]


def layer_raster(plan, nearest, farthest):
    """Choose the raster of the layers.

    Parameters
    ----------
    plan : FramePlan
        With `layered`.
    nearest, farthest : float
        Depths between which there is something, m.

    Returns
    -------
    LayerRaster
    """
    reach = plan_reach(plan, nearest, farthest)
    most = int(plan.layered.overscan * max(plan.width, plan.height))
    margin = tuple(int(min(np.ceil(side), most)) for side in reach)
    width, height = plan.width + 2 * margin[0], plan.height + 2 * margin[1]
    affordable = int(np.sqrt(_MOST_TEXELS / (width * height * plan.layered.count)))
    fine = int(np.clip(affordable, 1, _FINEST))
    return LayerRaster(width * fine, height * fine, fine, margin)


def plan_reach(plan, nearest, farthest):
    """Return how far the lens moves anything between two depths across and up, in pixels."""
    moved = np.zeros(2)
    sweeps = [plan.sweep]
    if plan.chromatic:
        base, gain = plan.sweep_parts
        sweeps = [base + gain * focus for focus in plan.chromatic.overall().inverse_focus]
    for sweep in sweeps:
        for depth in (window_depth(plan, nearest), window_depth(plan, farthest)):
            moved = np.maximum(moved, np.abs(plan.lens_extent * (sweep[:2] + sweep[2:] * depth)))
    return moved


def window_depth(plan, depth):
    """Return what the depth buffer of a frame holds for a depth in m."""
    clip = plan.projection @ np.array([0.0, 0.0, -depth, 1.0])
    return float(clip[2] / clip[3]) * 0.5 + 0.5


def clipped_projection(projection, near, far):
    """Return a projection with other near and far planes, m.

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
    near, far : float

    Returns
    -------
    ndarray of shape (4, 4)
    """
    found = np.array(projection, np.float64)
    if found[3, 2] == 0.0:
        found[2, 2:] = -2.0 / (far - near), -(far + near) / (far - near)
    else:
        found[2, 2:] = -(far + near) / (far - near), -2.0 * far * near / (far - near)
    return found


def clip_planes(projection):
    """Return the depths of the near and the far plane of a projection, m."""
    slope, offset = projection[2, 2:]
    if projection[3, 2] == 0.0:
        return (offset + 1.0) / slope, (offset - 1.0) / slope
    return offset / (slope - 1.0), offset / (slope + 1.0) if slope != -1.0 else np.inf


class LayeredDrawing:
    """Draws lens samples of a frame through depth layers.

    Parameters
    ----------
    plan : FramePlan
        With `layered`.
    drawing : SceneDrawing
        Aimed at the frame.
    buffers : SceneBuffers
    target : passes.surface.surface_target.SurfaceTarget
        That the surfaces are drawn into.
    wavelengths : callable
        From a sample, or None for the reference wavelength, to its `ChromaticSample` or None.
    highlights : GPUUniformBuf or None
    surroundings : tuple of 4 float
        Colour where nothing is, premultiplied.
    """

    def __init__(self, plan, drawing, buffers, target, wavelengths, highlights, surroundings):
        self._plan = plan
        self._drawing = drawing
        self._buffers = buffers
        self._target = target
        self._wavelengths = wavelengths
        self._highlights = highlights
        self._surroundings = surroundings
        self._layers = None
        draws = drawing.full_detail_draws(target)
        self._solid = [draw for draw in draws if not draw.transparent]
        self._by_chance = [draw for draw in draws if draw.transparent]
        self._places = texture_2d(_padded(plan.layered.places))
        self._nothing = texture_2d(np.array([[surroundings]], np.float32))
        # Sweeps in texels of the sample, which is as fine as the picture.
        self._sweep, self._gain = plan.sweep, None
        if plan.chromatic:
            self._sweep, self._gain = plan.sweep_parts

    @property
    def bytes(self):
        """How many bytes the layers hold on the device."""
        return self._layers.bytes if self._layers else 0

    def prepare(self):
        """Draw the layers, if they are not there yet."""
        if self._layers is not None:
            return
        plan = self._plan
        near, far = clip_planes(plan.projection)
        nearest = max(self._drawing.nearest, near)
        farthest = min(self._drawing.farthest, far)
        if not nearest < farthest:
            # Nothing is in view, or all at one depth.
            nearest = min(nearest, farthest) if np.isfinite(farthest) and farthest > 0 else near
            nearest, farthest = max(nearest, near), max(nearest, near) * 2.0
        nearest = max(near, nearest * (1.0 - _ROUNDING))
        farthest = min(far, farthest * (1.0 + _ROUNDING))
        count = plan.layered.count
        self._cuts = layer_cuts(count, nearest, farthest, plan.orthographic)
        self._raster = raster = layer_raster(plan, nearest, farthest)
        mattes = "MATTES" in self._target.defines
        specs = layers.specs(raster.width, raster.height, count, mattes)
        self._layers = Targets(raster.width, raster.height, specs)
        self._draw_layers(mattes)
        layers.build_pyramids(self._layers, raster.width, raster.height, count, alpha_covers=False)
        bounds = np.zeros((count, 4))
        for number in range(count):
            bounds[number, :2] = [window_depth(plan, d) for d in self._planes(number)]
        self._params = uniform_buffer(
            cast.LAYERED_PARAMS.pack(
                bounds=bounds,
                surroundings=self._surroundings,
                raster=(raster.fine, raster.fine, *(raster.fine * side for side in raster.margin)),
                sampling=(
                    count,
                    layers.level_count(raster.width, raster.height),
                    0.0,
                    plan.layered.cell,
                ),
            )
        )

    def _planes(self, number):
        """Return the depths between which a layer is drawn, m."""
        near, far = self._cuts[number : number + 2]
        if number + 2 < len(self._cuts):
            if self._plan.orthographic:
                far += OVERLAP * (far - near)
            else:
                # In equal steps of the circle of confusion, and no farther than there is anything.
                far = 1.0 / (1.0 / far - OVERLAP * (1.0 / near - 1.0 / far))
            far = min(far, self._cuts[-1]) if far > 0.0 else self._cuts[-1]
        return float(near), float(far)

    def _draw_layers(self, mattes):
        plan, raster = self._plan, self._raster
        grown = np.diag(
            [
                plan.width * raster.fine / raster.width,
                plan.height * raster.fine / raster.height,
                1.0,
                1.0,
            ]
        )
        projection = grown @ plan.projection
        specs = [TargetSpec("color", "RGBA32F"), TargetSpec("depth", "DEPTH_COMPONENT32F")]
        if mattes:
            specs.append(TargetSpec("mattes", "RGBA32F"))
        slots = ("color", "mattes")[: 1 + mattes]
        wavelength = self._wavelengths(None)
        origin = [
            first * raster.fine - side * raster.fine
            for first, side in zip(plan.origin, raster.margin, strict=True)
        ]
        with Targets(raster.width, raster.height, specs) as drawn:
            for number in range(plan.layered.count):
                clipped = clipped_projection(projection, *self._planes(number))
                view = uniform_buffer(
                    surface.VIEW_PARAMS.pack(
                        view=plan.view,
                        view_inverse=np.linalg.inv(plan.view),
                        projection=clipped,
                        lens=(
                            plan.focus_distance,
                            float(plan.orthographic),
                            plan.coc_scale,
                            plan.sharp_radius,
                        ),
                        film=(raster.width, raster.height, *origin),
                    )
                )
                for name in slots:
                    drawn.clear(name, (0.0, 0.0, 0.0, 0.0))
                framebuffer = drawn.framebuffer(*slots, depth="depth")
                with framebuffer.bind():
                    framebuffer.clear(depth=1.0)
                    state.opaque()
                    surface.draw_sample(
                        self._solid,
                        view,
                        self._buffers.instances,
                        (0.0, 0.0, 0.0, 0.0),
                        0,
                        highlights=self._highlights,
                        wavelength=wavelength,
                    )
                layers.pack(drawn, number, self._layers, clipped, plan.projection)
            counts = self._drawing.counts
            counts.draw_calls += plan.layered.count * len(self._solid)
            counts.triangles += plan.layered.count * sum(d.triangles * d.count for d in self._solid)

    def specs(self, shows_image):
        """Return the targets that it needs beside the sample's."""
        return [TargetSpec("behind", "RGBA32F")] if shows_image else []

    def draw(self, index, fullscreen, targets, view, background=None):
        """Draw a lens sample.

        Parameters
        ----------
        index : int
        fullscreen : GPUBatch
        targets : Targets
            The frame's, with those of `specs`.
        view : GPUUniformBuf
            `ViewParams` of the frame.
        background : callable, optional
            Draws what surrounds the scene, as a sample sees it, where the depth buffer is empty;
            without it all is of one colour.
        """
        self.prepare()
        if background:
            framebuffer = targets.framebuffer("behind", depth="sample_depth")
            with framebuffer.bind():
                framebuffer.clear(color=self._surroundings, depth=1.0)
                with self._drawing.confined():
                    background(index)
        slots = ("sample", "mattes") if "mattes" in targets else ("sample",)
        framebuffer = targets.framebuffer(*slots, depth="sample_depth")
        with framebuffer.bind(), self._drawing.confined():
            self.cast(index, fullscreen, targets["behind"] if background else None)
        self._draw_by_chance(index, framebuffer, view)
        self._drawing.draw_glows(index, framebuffer, view)

    def cast(self, index, fullscreen, behind=None, counts=False):
        """Cast the rays of a lens sample into the bound frame buffer.

        Parameters
        ----------
        index : int
        fullscreen : GPUBatch
        behind : GPUTexture or None
            What surrounds the scene, as this sample sees it; None: the one colour.
        counts : bool
            See `passes.layered.cast.cast`.
        """
        plan = self._plan
        sharp = plan.sharp_radius
        cast.cast(
            fullscreen,
            self._layers,
            behind or self._nothing,
            self._places,
            self._params,
            sweep=self._sweep,
            offset=-0.5 * plan.jitter[index] * np.array([plan.width, plan.height]),
            index=index,
            empty_focus=(sharp / max(abs(plan.empty_coc), sharp)) ** 2,
            gain=self._gain,
            wavelength=self._wavelengths(index),
            culls=plan.layered.culls,
            counts=counts,
        )
        self._drawing.counts.draw_calls += 1

    def _draw_by_chance(self, index, framebuffer, view):
        """Draw what is transparent by chance, in front of what the sample sees."""
        if not self._by_chance:
            return
        with framebuffer.bind(), self._drawing.confined():
            state.opaque()
            surface.draw_sample(
                self._by_chance,
                view,
                self._buffers.instances,
                self._plan.lens_sample(index),
                index,
                highlights=self._highlights,
                wavelength=self._wavelengths(index),
            )
        counts = self._drawing.counts
        counts.draw_calls += len(self._by_chance)
        counts.triangles += sum(d.triangles * d.count for d in self._by_chance)

    def release(self):
        """Give the layers back to the device."""
        if self._layers is not None:
            self._layers.release()
            self._layers = None


def _padded(places):
    found = np.zeros((*places.shape[:2], 4), np.float32)
    found[..., :2] = places
    return found
