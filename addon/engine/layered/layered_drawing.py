"""Lens samples as rays through depth layers (methods 7).

The layers are slices of the scene, drawn once each, or those of a captured picture. What chance
makes transparent, and light that is added to what is behind it, is drawn anew for every sample, in
front of what its rays have met.

References
----------
Lee, Eisemann and Seidel, SIGGRAPH Asia 2009.
"""

from dataclasses import replace

import numpy as np

from ...device import state
from ...device.targets import TargetSpec, level_count
from ...device.textures import texture_2d
from ...device.uniforms import uniform_buffer
from ...passes.bokeh import peel
from ...passes.layered import cast
from ...passes.surface import surface, surface_target
from .scene_layers import draw_scene_layers

# Samples in a row of the table of places; every device has textures of this width.
MOST_ACROSS = 8192


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
        That the surfaces are drawn into, seen from the middle of the lens.
    optics : callable
        From a sample, or None for the lens' middle at the reference wavelength, to its
        `passes.surface.real_lens.SampleOptics`.
    highlights : GPUUniformBuf or None
    surroundings : tuple of 4 float
        Colour where nothing is, premultiplied.
    """

    def __init__(self, plan, drawing, buffers, target, optics, highlights, surroundings):
        self._plan = plan
        self._drawing = drawing
        self._buffers = buffers
        self._target = target
        self._optics = optics
        self._highlights = highlights
        self._surroundings = surroundings
        self._made = None
        draws = drawing.full_detail_draws(drawing.target)
        self._by_chance = [draw for draw in draws if draw.transparent and not draw.refracts]
        self._places = texture_2d(_folded(plan.layered.places))
        self._nothing = texture_2d(np.array([[surroundings]], np.float32))
        # Sweeps in texels of the sample, which is as fine as the picture.
        self._sweep, self._gain = plan.sweep, None
        if plan.chromatic:
            self._sweep, self._gain = plan.sweep_parts

    @property
    def bytes(self):
        """How many bytes the layers hold on the device."""
        return self._made.textures.bytes if self._made else 0

    def prepare(self):
        """Make the layers, if they are not there yet."""
        if self._made is not None:
            return
        plan = self._plan
        if plan.layered.stack is not None:
            # They outlive the frame.
            reference = self._optics(None).wavelength
            field = reference and reference.resources
            made = self._buffers.captured.prepare(plan, self._highlights, field)
        else:
            optics = self._optics(None)
            resources = {"highlights": self._highlights, "optics": optics.wavelength}
            resources["lights"] = self._drawing.lights.shared()
            # Layers are seen from the middle of the lens: rays bend, the surfaces stay.
            bends = optics.lens is not None and "LENS_BLUR" in self._target.defines
            blur = optics.lens.blur_resources if bends else ()
            target = surface_target.of_layers(self._target)
            solid = self._drawing.full_detail_draws(target)
            solid = [draw for draw in solid if not (draw.transparent or draw.refracts)]
            wanted = {(draw.group, draw.slot) for draw in solid}
            made = draw_scene_layers(
                plan,
                self._drawing,
                solid,
                self._drawing.full_detail_draws(peel.OPAQUE, wanted),
                self._buffers.instances,
                "MATTES" in self._target.defines,
                resources,
                blur,
            )
        self._made, raster = made, made.raster
        size = (raster.width, raster.height)
        eyes = plan.layered.eyes
        margin = [raster.fine * side for side in raster.margin]
        if plan.layered.stack is not None:
            margin = plan.layered.origin
        self._params = uniform_buffer(
            cast.LAYERED_PARAMS.pack(
                surroundings=self._surroundings,
                raster=(raster.fine, raster.fine, *margin),
                sampling=(
                    made.count,
                    level_count(*size),
                    float(made.filtered),
                    plan.layered.cell,
                ),
                eyes=(
                    *(1.0 / np.abs(eyes).max(axis=0) if len(eyes) > 1 else (0.0, 0.0)),
                    float(plan.layered.peeled and not made.filtered),
                    0.0,
                ),
                **bend_lookups(plan, made.nearest),
            )
        )

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
        self._drawing.draw_through(index, framebuffer, view, targets)

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
        sharp, optics = plan.sharp_radius, self._optics(index)
        cast.cast(
            fullscreen,
            self._made.textures,
            behind or self._nothing,
            self._places,
            self._params,
            sweep=self._sweep,
            offset=self._offset(index),
            index=index,
            empty_focus=(sharp / max(abs(plan.empty_coc), sharp)) ** 2,
            gain=self._gain,
            wavelength=optics.wavelength,
            lens=optics.lens,
            eyes=len(plan.layered.eyes) > 1,
            culls=plan.layered.culls,
            counts=counts,
        )
        self._drawing.counts.draw_calls += 1

    def _offset(self, index):
        """Return where in its pixel a sample lies, in texels of the sample."""
        if self._made.filtered:
            # The pixel filter was the capture's.
            return (0.0, 0.0)
        return -0.5 * self._plan.jitter[index] * np.array([self._plan.width, self._plan.height])

    def _draw_by_chance(self, index, framebuffer, view):
        """Draw surfaces with stochastic transparency over what the sample sees."""
        if not self._by_chance:
            return
        lights = self._drawing.lights.of_samples(index, (index,))
        with framebuffer.bind(), self._drawing.confined():
            state.opaque()
            surface.draw_sample(
                self._by_chance,
                view,
                self._buffers.instances,
                self._plan.lens_sample(index),
                index,
                highlights=self._highlights,
                optics=self._optics(index),
                lights=lights,
            )
        counts = self._drawing.counts
        counts.draw_calls += len(self._by_chance)
        counts.triangles += sum(d.triangles * d.count for d in self._by_chance)

    def release(self):
        """Give the layers back to the device."""
        if self._made is not None and self._plan.layered.stack is None:
            self._made.textures.release()
        self._made = None


def in_step(plan, mixed):
    """Return a plan whose pixels all see through the same places on the lens, where they must.

    A real lens weighs each pixel's light by the places that its layers are seen through; what is
    drawn anew for every sample is seen through the first set of places.

    Parameters
    ----------
    plan : FramePlan
    mixed : bool
        Something is drawn anew for every sample.

    Returns
    -------
    FramePlan
    """
    if not mixed or plan.layered is None or plan.real_lens is None:
        return plan
    places = np.repeat(plan.layered.places[:1], len(plan.layered.places), axis=0)
    return replace(plan, layered=replace(plan.layered, places=places, in_step=True))


def bend_lookups(plan, nearest):
    """Return what of `LayeredParams` bends the rays of a real lens.

    Parameters
    ----------
    plan : FramePlan
    nearest : float
        Depth of the nearest surface, m.

    Returns
    -------
    dict of str to sequence
    """
    if plan.real_lens is None:
        return {"vergence": (0.0,) * 4, "nodes": (0.0,) * 4, "powers": np.zeros((4, 4))}
    slope, offset = plan.projection[2, 2:]
    end = min(1.0 / nearest, plan.real_lens.tables.largest_vergence)
    # Chebyshev's: a cubic through them is as good as any.
    nodes = 0.5 - 0.5 * np.cos((np.arange(4) + 0.5) / 4 * np.pi)
    return {
        "vergence": ((slope - 1.0) / offset, 2.0 / offset, end, 0.0),
        "nodes": nodes,
        "powers": np.linalg.inv(nodes[:, None] ** np.arange(4)),
    }


def _folded(places, across=MOST_ACROSS):
    """Pack sample positions into rows of at most `across` texels, the longest that devices have."""
    sets, samples = places.shape[:2]
    across = min(samples, across)
    blocks = -(-samples // across)
    found = np.zeros((blocks, sets, across, 4), np.float32)
    for block in range(blocks):
        part = places[:, block * across : (block + 1) * across]
        found[block, :, : part.shape[1], :2] = part
    return found.reshape(blocks * sets, across, 4)
