"""The views of a stereoscopic render: camera, place and shift of each.

Blender renders all views of a view layer in one call of the engine. With *Stereo 3D* two eyes share
a camera, moved apart and shifted or turned by its convergence settings; with *Multi-View* each view
has a camera of its own, found by the suffix of its name. Blender computes both for the active view
(`RenderEngine.active_view_set`).
"""

from dataclasses import dataclass


@dataclass(frozen=True, eq=False)
class View:
    """One view of a render, as `scene.camera.camera.read_camera` asks for it.

    Parameters
    ----------
    engine : bpy.types.RenderEngine or None
    blender : bpy.types.SceneRenderView
    """

    engine: object
    blender: object

    @property
    def name(self):
        """The name of the view."""
        return self.blender.name

    def activate(self):
        """Make this the view that Blender's functions refer to."""
        self.engine.active_view_set(self.name)

    def camera(self, depsgraph):
        """Return the camera that sees this view, of the evaluated scene."""
        return self.engine.camera_override or depsgraph.scene.camera

    def place(self, camera):
        """Return the transform of a camera for this view, object to world."""
        return self.engine.camera_model_matrix(camera)

    def shift_x(self, camera):
        """Return the shift of a camera for this view, in units of the sensor's side."""
        return self.engine.camera_shift_x(camera)


def views_of(engine, scene):
    """Return the views that a render of a scene has.

    Parameters
    ----------
    engine : bpy.types.RenderEngine or None
        None where only the names are asked for.
    scene : bpy.types.Scene

    Returns
    -------
    list of View or None
        None stands for the only view of a render without stereoscopy.
    """
    render = scene.render
    if not render.use_multiview:
        return [None]
    found = render.stereo_views if render.views_format == "STEREO_3D" else render.views
    views = [View(engine, view) for view in found if view.use]
    # Without any, Blender renders as if there were no stereoscopy.
    return views or [None]
