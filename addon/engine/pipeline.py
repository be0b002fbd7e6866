"""The ordered passes of a frame, sample by sample.

Only the sum of the samples outlives a sample, so memory does not depend on their number.
"""

import numpy as np

from ..device import geometry, readback, state
from ..device.targets import Targets, TargetSpec
from ..device.uniforms import uniform_buffer
from ..passes import accumulate, resolve, surface

_TARGETS = (
    TargetSpec("sample", "RGBA32F"),
    TargetSpec("sample_depth", "DEPTH_COMPONENT32F"),
    TargetSpec("sum", "RGBA32F"),
    TargetSpec("image", "RGBA32F"),
)


class FrameRenderer:
    """Renders a frame progressively.

    Parameters
    ----------
    plan : FramePlan
    snapshot : SceneSnapshot
    buffers : SceneBuffers
        Updated to the snapshot's content.
    """

    def __init__(self, plan, snapshot, buffers):
        self._buffers = buffers
        self._fullscreen = geometry.fullscreen_batch()
        self._content = None
        self._targets = None
        self.restart(plan, snapshot)

    def restart(self, plan, snapshot):
        """Begin a frame anew, with another view or content; what still fits is kept.

        Parameters
        ----------
        plan : FramePlan
        snapshot : SceneSnapshot
            The buffers must be updated to its content.
        """
        self.plan = plan
        self.samples_done = 0
        self.draw_calls = 0
        self.triangles = 0
        if snapshot.content is not self._content:
            self._draws = surface.build_draws(snapshot.content, self._buffers)
            self._triangles_per_sample = sum(d.triangles * d.count for d in self._draws)
            self._content = snapshot.content
        self._view = uniform_buffer(_view_params(plan))
        world = snapshot.content.world.color
        self._background = (0.0,) * 4 if snapshot.film.transparent else (*world, 1.0)
        size = (plan.width, plan.height)
        if self._targets is None or (self._targets.width, self._targets.height) != size:
            self.release()
            self._targets = Targets(*size, _TARGETS)
        self._targets.forget_framebuffers()
        with self._targets.framebuffer("sum").bind():
            self._targets.framebuffer("sum").clear(color=(0.0, 0.0, 0.0, 0.0))

    def advance(self, samples):
        """Render up to `samples` more lens samples."""
        self._targets.forget_framebuffers()
        end = min(self.samples_done + samples, self.plan.samples)
        for index in range(self.samples_done, end):
            self._render_sample(index)
        self.samples_done = end

    def wait(self):
        """Return when the device has drawn everything it was given."""
        readback.wait(self._targets.framebuffer("sum"))

    def _render_sample(self, index):
        plan = self.plan
        lens_sample = (*plan.lens_positions[index].tolist(), *plan.jitter[index].tolist())
        framebuffer = self._targets.framebuffer("sample", depth="sample_depth")
        with framebuffer.bind():
            framebuffer.clear(color=self._background, depth=1.0)
            state.opaque()
            surface.draw_sample(
                self._draws, self._view, self._buffers.instances, lens_sample, index
            )
        with self._targets.framebuffer("sum").bind():
            accumulate.accumulate(self._fullscreen, self._targets["sample"])
        self.draw_calls += len(self._draws) + 1
        self.triangles += self._triangles_per_sample

    def finished(self):
        """Whether every sample has been rendered."""
        return self.samples_done >= self.plan.samples

    def resolve(self, origin=(0, 0), pixel_size=1):
        """Draw the picture so far into the bound frame buffer.

        Parameters
        ----------
        origin : tuple of 2 int
            Where its lower left corner goes.
        pixel_size : int
            Side of the square that shows one pixel.
        """
        state.overwrite()
        resolve.resolve(
            self._fullscreen, self._targets["sum"], max(self.samples_done, 1), origin, pixel_size
        )

    def read_image(self):
        """Return the picture so far, shape (height, width, 4), bottom row first."""
        self._targets.forget_framebuffers()
        framebuffer = self._targets.framebuffer("image")
        with framebuffer.bind():
            self.resolve()
        return readback.read_color(framebuffer, self.plan.width, self.plan.height)

    def release(self):
        """Give the targets back to the device."""
        if self._targets is not None:
            self._targets.release()
            self._targets = None


def _view_params(plan):
    return surface.VIEW_PARAMS.pack(
        view=plan.view,
        view_inverse=np.linalg.inv(plan.view),
        projection=plan.projection,
        lens=(plan.focus_distance, float(plan.orthographic), 0.0, 0.0),
        film=(plan.width, plan.height, 0.0, 0.0),
    )
