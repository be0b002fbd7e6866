"""A captured picture seen through the lens again: another focus, f-number and iris."""

from dataclasses import dataclass

import numpy as np

from ..sampling.iris import Iris
from ..sampling.thin_lens import ThinLens, aperture_radius
from ..snapshot.camera import Camera
from ..snapshot.content import InstanceTable, SceneContent
from ..snapshot.film import Film, Sampling
from ..snapshot.scene import SceneSnapshot
from .drawing.scene_buffers import SceneBuffers
from .frame.pipeline import FrameRenderer
from .layered.layer_raster import clipped_projection
from .layered.stack_layers import stack_far, stack_near
from .planning.plan import plan_frame

# Lens samples between two looks at whether to go on.
_STRETCH = 16


@dataclass(frozen=True)
class RefocusSettings:
    """How a captured picture is seen; what is None is as it was captured.

    Parameters
    ----------
    focus_distance : float or None
        Along the optical axis, m.
    f_stop : float or None
    iris : Iris or None
    samples : int
        Lens samples.
    seed : int
    """

    focus_distance: float | None = None
    f_stop: float | None = None
    iris: Iris | None = None
    samples: int = 128
    seed: int = 0


def lens_of(stack, settings):
    """Return the thin lens that a captured picture is seen through.

    Parameters
    ----------
    stack : LayerStack
    settings : RefocusSettings

    Returns
    -------
    ThinLens

    Raises
    ------
    FocusError
        If the focus distance or the f-number cannot form a picture.
    """
    camera = stack.camera
    f_stop = camera.f_stop if settings.f_stop is None else settings.f_stop
    if camera.aperture_radius is not None:
        radius = camera.aperture_radius * camera.f_stop / f_stop
    else:
        radius = aperture_radius(camera.focal_length_mm / 1000.0, f_stop)
    iris = settings.iris or Iris(camera.blades, camera.blade_rotation, camera.aperture_ratio)
    focus = settings.focus_distance
    return ThinLens(radius, camera.focus_distance if focus is None else focus, iris)


def refocus_snapshot(stack, settings):
    """Return the snapshot of a captured picture.

    Parameters
    ----------
    stack : LayerStack
    settings : RefocusSettings

    Returns
    -------
    SceneSnapshot
        Without any content of its own.
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
    )
    sampling = Sampling(method="LAYERED", lens_samples=settings.samples, seed=settings.seed)
    nothing = InstanceTable(np.zeros((0, 4, 4), np.float32), np.zeros(0, np.float32))
    return SceneSnapshot(
        content=SceneContent({}, {}, {}, nothing, ()),
        camera=camera,
        film=Film(stack.width, stack.height, (0, 0, stack.width, stack.height), True, "BOX", 1.0),
        sampling=sampling,
        stack=stack,
    )


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
    snapshot = refocus_snapshot(stack, settings)
    buffers = SceneBuffers()
    buffers.update(snapshot.content)
    renderer = FrameRenderer(plan_frame(snapshot), snapshot, buffers)
    try:
        while not renderer.finished():
            if not go_on(renderer.samples_done / settings.samples):
                return None
            renderer.advance(_STRETCH)
            renderer.wait()
        return renderer.read_image()
    finally:
        renderer.release()
