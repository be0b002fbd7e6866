"""A captured picture seen through the lens again: sample by sample, with ever other settings."""

import numpy as np

from ...device import keeping
from ...layers.filling import filled
from ...snapshot.camera import Camera
from ...snapshot.content import InstanceTable, SceneContent
from ...snapshot.film import Film, Sampling
from ...snapshot.scene import SceneSnapshot
from ..drawing.scene_buffers import SceneBuffers
from ..frame.pipeline import FrameRenderer
from ..layered.layer_raster import clipped_projection
from ..layered.stack_layers import StackLayers, stack_far, stack_near
from ..planning.plan import plan_frame
from .settings import bokeh_of, f_stop_of, lens_of, real_lens_of

# Lens samples between two looks at whether to go on.
_STRETCH = 16


def refocus_snapshot(stack, settings, content=None):
    """Return the snapshot of a captured picture.

    Parameters
    ----------
    stack : LayerStack
    settings : RefocusSettings
    content : SceneContent, optional
        An empty one that stays the same from picture to picture.

    Returns
    -------
    SceneSnapshot
        Without any content of its own.

    Raises
    ------
    FocusError
        If the focus distance or the f-number cannot form a picture.
    """
    projection = np.array(stack.camera.projection, np.float64)
    near, far = stack_near(stack), stack_far(stack)
    if stack.camera.orthographic:
        projection = clipped_projection(projection, near, far)
    else:
        # The far plane at infinity, where the world is.
        projection[2, 2:] = -1.0, -2.0 * near
    view = np.eye(4) if stack.camera.view is None else np.array(stack.camera.view, np.float64)
    camera = Camera(
        view=view,
        projection=projection,
        lens=lens_of(stack, settings),
        orthographic=stack.camera.orthographic,
        real_lens=real_lens_of(stack, settings),
        bokeh=bokeh_of(stack, settings),
        chromatic=settings.chromatic,
        distortion=settings.distortion,
        artist=settings.artist,
        f_number=f_stop_of(stack, settings),
    )
    sampling = Sampling(method="LAYERED", lens_samples=settings.samples, seed=settings.seed)
    return SceneSnapshot(
        content=content or nothing(),
        camera=camera,
        film=Film(stack.width, stack.height, (0, 0, stack.width, stack.height), True, "BOX", 1.0),
        sampling=sampling,
        passes=("Combined", "Defocus", "Bokeh") if stack.fills else ("Combined",),
        stack=stack,
    )


def planned_frame(stack, settings, content=None):
    """Return how a captured picture is made; without the graphics device.

    Rays are traced through a real lens here, which takes seconds.

    Parameters
    ----------
    stack, settings, content
        As for `refocus_snapshot`.

    Returns
    -------
    snapshot : SceneSnapshot
    plan : FramePlan

    Raises
    ------
    FocusError
        If the focus distance or the f-number cannot form a picture.
    """
    snapshot = refocus_snapshot(stack, settings, content)
    return snapshot, plan_frame(snapshot)


class Refocusing:
    """A captured picture on the device, to be seen with one setting after the other.

    The layers are uploaded once; only what a change of the settings asks for is done anew. What
    was drawn with other settings before changes no bit of a picture. Needs the graphics device, and
    is used by one thread.

    Parameters
    ----------
    stack : LayerStack
    settings : RefocusSettings
    look_textures : TextureCache, optional
        Of the session.
    drafts : bool
        Begin with a draft of the bokeh, unless the last whole one was quick, and leave the whole to
        `refine_bokeh`.
    planned : tuple of SceneSnapshot and FramePlan, optional
        Of `planned_frame`; made here if it is not given.

    Attributes
    ----------
    settings : RefocusSettings
    report : tuple of str
        Warnings about settings that cannot be met; known after a sample.

    Raises
    ------
    FocusError
        If the focus distance or the f-number cannot form a picture.
    """

    def __init__(self, stack, settings, look_textures=None, drafts=False, planned=None):
        self.stack = stack
        self.settings = settings
        snapshot, plan = planned or planned_frame(stack, settings)
        self._content = snapshot.content
        self._buffers = SceneBuffers(look_textures)
        self._buffers.update(self._content)
        self._buffers.captured = StackLayers(stack)
        self._bokeh = "DRAFT" if drafts else "AT_ONCE"
        self._renderer = FrameRenderer(plan, snapshot, self._buffers, self._bokeh)

    def change(self, settings, planned=None):
        """Begin anew with other settings; the same ones go on where they are.

        Parameters
        ----------
        settings : RefocusSettings
        planned : tuple of SceneSnapshot and FramePlan, optional
            Of `planned_frame` with the content of the picture before.

        Raises
        ------
        FocusError
            If the focus distance or the f-number cannot form a picture; nothing has changed then.
        """
        if settings == self.settings:
            return
        snapshot, plan = planned or planned_frame(self.stack, settings, self._content)
        self._renderer.restart(plan, snapshot, self._bokeh)
        self.settings = settings

    @property
    def samples_done(self):
        """Lens samples that the picture has so far."""
        return self._renderer.samples_done

    @property
    def finished(self):
        """Whether the picture has all its lens samples, and the whole bokeh."""
        return self._renderer.finished()

    @property
    def sampled(self):
        """Whether the picture has all its lens samples."""
        return self._renderer.sampled

    @property
    def bokeh_drafted(self):
        """Whether the bokeh is a draft, or not made yet."""
        return self._renderer.bokeh_drafted

    def refine_bokeh(self):
        """Make a part of the whole bokeh; the last part replaces the draft."""
        self._renderer.refine_bokeh()
        self._renderer.wait()

    @property
    def report(self):
        """Warnings about settings that cannot be met; known after a sample."""
        return self._renderer.report

    @property
    def highlights(self):
        """Numbers of highlights by fate, as `HighlightCounts`; None without bokeh."""
        return self._renderer.highlights

    def advance(self, samples):
        """Draw up to a number of lens samples more, and wait for them.

        The first one also finds and draws the bokeh.

        Parameters
        ----------
        samples : int

        Returns
        -------
        bool
            Whether there are more to draw.
        """
        self._renderer.advance(samples)
        self._renderer.wait()
        return not self.finished

    def read(self):
        """Return the picture as it is so far; there must be a sample.

        Returns
        -------
        ndarray of shape (height, width, 4)
            Scene linear, premultiplied, bottom row first.
        """
        if not self.stack.fills:
            return self._renderer.read_image()
        # Light that is splatted is whole, whatever the lens samples miss.
        passes = self._renderer.read_passes(("Defocus", "Bokeh"))
        picture = filled(passes["Defocus"])
        picture[..., :3] += passes["Bokeh"][..., :3]
        return picture

    def release(self):
        """Give everything back to the device; it cannot be used afterwards."""
        self._renderer.release()
        self._buffers.captured.release()
        self._renderer = self._buffers = None
        # The layers are the largest that there is: they go now.
        keeping.let_go()


def refocus(stack, settings, go_on=lambda share: True):
    """Return a captured picture as the lens sees it; needs the graphics device.

    Parameters
    ----------
    stack : LayerStack
    settings : RefocusSettings
    go_on : callable
        Takes the share that is done; False ends it.

    Returns
    -------
    ndarray of shape (height, width, 4) or None
        Scene linear, premultiplied, bottom row first; None if it was ended.
    """
    refocusing = Refocusing(stack, settings)
    try:
        while not refocusing.finished:
            if not go_on(refocusing.samples_done / settings.samples):
                return None
            refocusing.advance(_STRETCH)
        return refocusing.read()
    finally:
        refocusing.release()


def nothing():
    """Return the content of a picture that has layers only."""
    table = InstanceTable(np.zeros((0, 4, 4), np.float32), np.zeros(0, np.float32))
    return SceneContent({}, {}, {}, table, ())
