"""What lies under a pixel, drawn by the passes that make the Depth pass.

One pixel of the view is drawn through a pinhole, so a place that is picked has the depth that a
render of it has: textures' alpha, holdouts, instances and curves count as they do there.
"""

from dataclasses import replace

import numpy as np

from ..device import context as device_context
from ..device import state
from ..passes.surface.data import EMPTY_DEPTH
from ..scene.view import read_view
from ..snapshot.film import Sampling
from ..snapshot.scene import SceneSnapshot
from .frame.pipeline import FrameRenderer
from .planning.plan import plan_frame
from .shared_resources import resources
from .viewport_session import session_of_view

_ONE_SAMPLE = Sampling(method="REFERENCE", lens_samples=1, uses_levels=False)


def point_under(depsgraph, space, region, region_3d, x, y):
    """Return the place in the scene under a pixel of a 3D view, whatever engine draws the view.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph
        Of the view.
    space : bpy.types.SpaceView3D
    region : bpy.types.Region
    region_3d : bpy.types.RegionView3D
    x, y : int
        Pixel of the region, from its lower left corner.

    Returns
    -------
    ndarray of shape (3,) or None
        In world space, m; None where there is nothing but the world.

    Raises
    ------
    AplanatError
        If the view cannot be drawn.
    """
    session = session_of_view(resources(), depsgraph, space)
    view = read_view(depsgraph, space, region, region_3d, 1, session.sources)
    if view is None:
        return None
    return point_of_pixel(session, depsgraph, view.camera, view.film, x, y)


def point_of_pixel(session, depsgraph, camera, film, x, y):
    """Return the place in the scene that a camera sees in a pixel; as `point_under`.

    Parameters
    ----------
    session : ViewportSession
    depsgraph : bpy.types.Depsgraph
    camera : Camera
    film : Film
    x, y : int
        Pixel of the film, from its lower left corner.
    """
    if not (0 <= x < film.width and 0 <= y < film.height):
        return None
    device_context.ensure_context()
    with state.preserved():
        snapshot = SceneSnapshot(
            content=session.content(depsgraph),
            camera=replace(camera, lens=None, bokeh=None, chromatic=None, artist=None),
            film=replace(film, region=(x, y, 1, 1)),
            sampling=_ONE_SAMPLE,
            passes=("Combined", "Depth", "Position"),
            alpha_threshold=depsgraph.view_layer.pass_alpha_threshold,
        )
        renderer = FrameRenderer(plan_frame(snapshot), snapshot, session.scene_buffers)
        try:
            found = renderer.read_passes(("Depth", "Position"))
        finally:
            renderer.release()
    if found["Depth"].item() >= EMPTY_DEPTH:
        return None
    return np.array(found["Position"], np.float64).reshape(3)
