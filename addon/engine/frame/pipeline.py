"""The frame renderer: the GPU passes of a frame in order, lens sample by lens sample.

Only the sums of the samples and the Cryptomatte tables outlive a sample, so memory does not depend
on their number.
"""

from contextlib import nullcontext
from dataclasses import replace

from ...device import geometry, keeping, readback
from ...device.targets import Targets
from ...device.uniforms import uniform_buffer
from ...passes import background
from ...passes.surface import chromatic, real_lens, surface_target
from ...snapshot.render_passes import cryptomatte_kinds
from ..bokeh.split import FrameSplit
from ..bokeh.stage import BokehStage
from ..drawing.scene_drawing import DrawingCounts, SceneDrawing
from ..drawing.view_resources import chromatic_resources, view_params
from ..layered.layered_drawing import LayeredDrawing, in_step
from ..visibility.stage import SceneOccluders
from . import sample_sums
from .frame_bokeh import FrameBokeh
from .frame_pictures import FramePictures
from .lens_tables import LensTables
from .readable_frame import ReadableFrame
from .subsampling import SubsampleBlur
from .target_specs import needs_mattes, target_specs
from .tile_sampling import TileSampling

# Most samples in the device's queue, to bound the memory of the queue.
_SAMPLES_IN_FLIGHT = 32


class FrameRenderer(ReadableFrame):
    """Renders a frame progressively.

    Parameters
    ----------
    plan : FramePlan
    snapshot : SceneSnapshot
    buffers : SceneBuffers
        Updated to the snapshot's content.

    Attributes
    ----------
    samples_done : int
    """

    def __init__(self, plan, snapshot, buffers, bokeh="AT_ONCE", leader=None):
        self._buffers = buffers
        self._fullscreen = geometry.fullscreen_batch()
        self._content = self._levels = self._drawing = self._blur = self._plain = None
        self._target = self._occluders = self._pictures = self._targets = self._layers = None
        self._graded = {}
        self._bokeh = FrameBokeh()
        self.restart(plan, snapshot, bokeh, leader)

    def restart(self, plan, snapshot, bokeh="AT_ONCE", leader=None):
        """Begin a frame with another view or content; buffers and targets that still fit are kept.

        Parameters
        ----------
        plan : FramePlan
        snapshot : SceneSnapshot
            The buffers must be updated to its content.
        bokeh : {'AT_ONCE', 'DRAFT', 'LATER'}
            When the whole bokeh is made; see `FrameBokeh.restart`.
        leader : TileSampling or None
            With `automatic` sampling: draw the tiles that another renderer has chosen (the frame
            with chromatic aberration, for the plain one of Fringe).
        """
        keeping.let_go()
        self._bokeh.stop()
        self.samples_done = 0
        self._stopped = False
        self._earlier_rounds = DrawingCounts()
        self._cryptomattes = cryptomatte_kinds(plan.passes)
        self._mattes = needs_mattes(plan)
        target = surface_target.of_picture(self._mattes, plan.shadows)
        self._highlights = None
        if plan.bokeh:
            target = surface_target.without_highlights(target, plan.bokeh.unsplit)
            self._highlights = FrameSplit(plan, self._optics)
        if plan.chromatic:
            target = surface_target.in_wavelengths(target)
        layers_target = surface_target.blurred_by_lens(target) if plan.real_lens else target
        if plan.real_lens:
            target = surface_target.through_lens(target)
        levels = self._buffers.levels_version
        if (snapshot.content, target, levels) != (self._content, self._target, self._levels):
            self._content, self._target, self._levels = snapshot.content, target, levels
            if self._drawing:
                self._drawing.release()
            self._drawing = SceneDrawing(snapshot.content, self._buffers, target, self._graded)
            self._occluders = SceneOccluders(snapshot.content, self._buffers)
        world = snapshot.content.world
        self._background = (0.0,) * 4 if snapshot.film.transparent else (*world.color, 1.0)
        self._shows_image = bool(world.image) and not snapshot.film.transparent
        self.plan = plan = in_step(plan, self._shows_image or self._drawing.has_chance)
        self._lens = LensTables(plan) if plan.real_lens else None
        tiles = (plan, self._fullscreen, leader, self._lens)
        self._tiles = TileSampling(*tiles) if plan.automatic else None
        self._field = chromatic_resources(plan.chromatic) if plan.chromatic else None
        wavelengths = self._wavelength if plan.chromatic else None
        self._drawing.aim(plan, self._optics, self._highlights)
        self._view = uniform_buffer(view_params(plan))
        self._pixels = uniform_buffer(view_params(replace(plan, subpixels=1)))
        if self._layers:
            self._layers.release()
        self._layers = None
        if plan.layered:
            resources = (self._optics, self._highlights, self._background)
            content = (self._drawing, self._buffers, layers_target)
            self._layers = LayeredDrawing(plan, *content, *resources)
        self._blur = None
        if plan.blurs:
            self._blur = SubsampleBlur(plan, self._drawing.nearest, wavelengths, self._lens)
        # Whether a draft is shown depends on time: the noise threshold must not depend on it.
        self._measures_bokeh = bool(plan.bokeh) and bokeh == "AT_ONCE"
        self._bokeh.restart(plan, self._stage, bokeh)
        self._prepare_targets()
        self._pictures = FramePictures(
            plan,
            self._content,
            self._buffers,
            self._drawing,
            self._view,
            self._targets,
            self._fullscreen,
            self._lens,
        )
        self._restart_plain(plan, snapshot)

    def _restart_plain(self, plan, snapshot):
        """Begin the same frame without chromatic aberration, which Fringe is a difference from."""
        if plan.plain is None:
            if self._plain:
                self._plain.release()
            self._plain = None
        elif self._plain:
            self._plain.restart(plan.plain, snapshot, leader=self._tiles)
        else:
            self._plain = FrameRenderer(plan.plain, snapshot, self._buffers, leader=self._tiles)

    def _wavelength(self, index):
        """Return a sample's `ChromaticSample`; that of the reference wavelength for None."""
        if self.plan.chromatic is None:
            return None
        if index is None:
            return chromatic.ChromaticSample((0.0, 0.0), (1.0,) * 4, self._field)
        plan = self.plan.chromatic
        tint = tuple(plan.weights[index].tolist())
        return chromatic.ChromaticSample(plan.dispersion(index), tint, self._field)

    def _optics(self, index):
        """Return what is bound for a sample; for None that of the lens' middle."""
        lens = self._lens.sample(index) if self._lens else None
        return real_lens.SampleOptics(self._wavelength(index), lens)

    def _stage(self, plan):
        scene = (self._drawing, self._buffers, self._occluders, self._highlights)
        return BokehStage(plan, *scene, self._field, self._lens and self._lens.discs(plan.bokeh))

    @property
    def layered(self):
        """The `LayeredDrawing` of the frame; None with another method."""
        return self._layers

    @property
    def counts(self):
        """Work done since the frame began, as `DrawingCounts`."""
        own = self._earlier_rounds + self._drawing.counts
        return own if self._plain is None else own + self._plain.counts

    @property
    def highlights(self):
        """Numbers of the frame's highlights by fate, as `HighlightCounts`; None without bokeh."""
        return self._bokeh.stage.counts if self._bokeh.stage else None

    @property
    def fates(self):
        """Numbers of sources by fate, see `BokehStage.fates`; empty without bokeh."""
        return self._bokeh.stage.fates if self._bokeh.stage else {}

    @property
    def report(self):
        """Warnings about settings of the camera that cannot be met; known after a sample."""
        return self.plan.report + (self._bokeh.stage.report if self._bokeh.stage else ())

    @property
    def bokeh_drafted(self):
        """Whether the bokeh that is shown is a draft, or not made yet."""
        return self._bokeh.drafted

    def _prepare_targets(self):
        size = (self.plan.width, self.plan.height)
        specs = self._target_specs()
        if (
            self._targets is None
            or (self._targets.width, self._targets.height) != size
            or self._specs != specs
        ):
            self._release_targets()
            self._targets = Targets(*size, specs)
            self._specs = specs
        self._targets.forget_framebuffers()
        for name in ("sum", "focus_sum", "tables"):
            if name in self._targets:
                self._targets.clear(name, (0.0, 0.0, 0.0, 0.0))

    def _target_specs(self):
        specs = target_specs(self.plan)
        specs += self._drawing.specs()
        if self._tiles:
            specs += self._tiles.specs()
        if self._blur:
            specs += self._blur.specs()
        if self._layers:
            specs += self._layers.specs(self._shows_image)
        return tuple(specs)

    def advance(self, samples, stage=nullcontext):
        """Render up to `samples` more lens samples.

        Parameters
        ----------
        samples : int
        stage : callable, optional
            For measuring: called with the name of each stage of a sample (``bokeh``, ``surfaces``,
            ``sum``), it returns a context manager in which the stage's work is sent to the device;
            within ``bokeh`` also with the stages of `BokehStage.run`.
        """
        keeping.let_go_now_and_then()
        self._targets.forget_framebuffers()
        end = self.samples_done + samples
        while self.samples_done < end and not self.sampled:
            if self.samples_done == self.plan.samples:
                self._begin_round()
            self._render_sample(self.samples_done, stage)
            if self._plain:
                self._plain.advance(1, stage)
            self.samples_done += 1
            if self.samples_done % _SAMPLES_IN_FLIGHT == 0:
                self.wait()
            if self._tiles and self._tiles.is_look(self.samples_done):
                with stage("error"):
                    self._look()

    @property
    def sampled(self):
        """Whether no further lens samples are needed."""
        if self._tiles:
            return self._tiles.done
        return self._stopped or self.samples_done >= self.plan.samples

    def stop(self):
        """Draw no further samples: the samples so far make the picture."""
        self._stopped = True
        if self._tiles:
            self._tiles.note(self.plan, self.samples_done)
            self._tiles.stop()

    def _look(self):
        """Measure the error of the picture, and choose the tiles that go on."""
        if self._plain:
            self._plain._tiles.note(self._plain.plan, self.samples_done)
        discs = self._targets["bokeh"] if self._measures_bokeh else None
        if self._tiles.look(self.plan, self.samples_done, self._targets, discs):
            for renderer in filter(None, (self, self._plain)):
                renderer._drawing.confine(renderer._part())

    def _part(self):
        reach = self._blur.reach if self._blur else 0
        return self._tiles.part(reach)

    def _begin_round(self):
        """Plan the samples of the next round, for the active tiles."""
        self._earlier_rounds += self._drawing.counts
        self.plan = self.plan.extended()
        wavelengths = self._wavelength if self.plan.chromatic else None
        if self._lens:
            self._lens.follow(self.plan)
        if earlier := self._blur:
            self._blur = SubsampleBlur(self.plan, self._drawing.nearest, wavelengths, self._lens)
            self._blur.limit(earlier)
        self._drawing.aim(self.plan, self._optics, self._highlights, self._part())
        for spec in self._drawing.specs():
            if spec.name not in self._targets:
                self._targets.add(spec)
        if self.plan.chromatic:
            # With more samples the extreme wavelengths reach a little further.
            self._field = chromatic_resources(self.plan.chromatic)

    def wait(self):
        """Wait until the device has finished all work it was given."""
        readback.wait(self._targets.framebuffer("sum"))

    def _render_sample(self, index, stage):
        if self._bokeh.stage and index == 0:
            with stage("bokeh"):
                self._bokeh.run(self._fullscreen, self._targets, self._pixels, stage)
        with stage("surfaces"):
            self._draw_sample(index)
        with stage("sum"):
            self._add_sample(index)
        self._drawing.counts.triangles_full_detail += self._drawing.full_detail

    def refine_bokeh(self):
        """Make a part of the whole bokeh; the last part replaces the draft."""
        if self.bokeh_drafted:
            self._targets.forget_framebuffers()
            self._bokeh.refine(self._fullscreen, self._targets, self._pixels)

    def _draw_sample(self, index):
        targets = self._targets
        if self._layers:
            background = self._draw_background if self._shows_image else None
            self._layers.draw(index, self._fullscreen, targets, self._view, background)
            return
        framebuffer = targets.framebuffer("sample", depth="sample_depth")
        with framebuffer.bind():
            framebuffer.clear(color=self._background, depth=1.0)
        if self._mattes:
            # The background has no id, and the focus matte of its distance.
            targets.clear("mattes", (0.0, 0.0, 0.0, self._empty_focus()))
            framebuffer = targets.framebuffer("sample", "mattes", depth="sample_depth")
        self._drawing.draw(index, framebuffer, self._view, targets)
        if self._shows_image:
            framebuffer_of_color = targets.framebuffer("sample", depth="sample_depth")
            with framebuffer_of_color.bind(), self._drawing.confined():
                self._draw_background(index)
        self._drawing.draw_through(index, framebuffer, self._view, targets)

    def _draw_background(self, index):
        background.draw(
            self._fullscreen,
            self._view,
            self._buffers.environment_buffer,
            self._buffers.environment_image,
            self.plan.lens_sample(index),
            self._highlights,
            self._wavelength(index),
            self._lens and self._lens.sample(index),
        )
        self._drawing.counts.draw_calls += 1

    def _add_sample(self, index):
        tiles = self._tiles
        batch = tiles.batch if tiles else self._fullscreen
        self._drawing.counts.draw_calls += sample_sums.add(
            batch,
            self._targets,
            self.plan,
            index,
            self._wavelength(index),
            self._blur,
            self._cryptomattes,
            tiles and tiles.active,
            self._lens and self._lens.sample(index).light,
        )
        if self._lens:
            self._lens.add(index)

    def _empty_focus(self):
        sharp = self.plan.sharp_radius
        return (sharp / max(abs(self.plan.empty_coc), sharp)) ** 2

    def finished(self):
        """Whether every sample has been rendered, and the whole bokeh."""
        return self.sampled and not self.bokeh_drafted

    def texture_bytes(self):
        """Return how many bytes targets, images and instances hold on the device."""
        targets = self._targets.bytes if self._targets else 0
        own = targets + self._drawing.texture_bytes()
        if self._plain:
            own += self._plain.texture_bytes() - self._buffers.texture_bytes()
        return own + self._buffers.texture_bytes()

    def geometry_bytes(self):
        """Return how many bytes the meshes hold on the device."""
        return self._buffers.geometry_bytes() + self._drawing.geometry_bytes()

    def release(self):
        """Release the renderer's resources on the device; it cannot be used afterwards."""
        self._bokeh.release()
        self._release_targets()
        for part in filter(None, (self._layers, self._plain, self._drawing)):
            part.release()
        self._plain = self._buffers = self._drawing = self._blur = self._graded = None
        self._tiles = None
        self._occluders = self._pictures = None
        keeping.let_go()

    def _release_targets(self):
        if self._targets is not None:
            self._targets.release()
            self._targets = None
