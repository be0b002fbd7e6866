"""Reads a 3D view: the camera and film of a viewport, as a final render would have them."""

from dataclasses import dataclass

import numpy as np

from ..snapshot.camera import Camera
from ..snapshot.film import Film
from .camera.breathing import with_breathing
from .camera.camera import evaluated_camera, read_optics
from .settings import filter_size


@dataclass(frozen=True, eq=False)
class View:
    """Camera and film of one region of a 3D view.

    Parameters
    ----------
    camera : Camera
    film : Film
        Of the whole region, in pixels of the picture; its `region` is the part that is rendered.
    pixel_size : int
        Pixels of the region along a side of one of the picture.
    """

    camera: Camera
    film: Film
    pixel_size: int

    @property
    def rectangle(self):
        """x, y, width and height of the rendered part, in pixels of the region."""
        return tuple(self.pixel_size * length for length in self.film.region)


def read_view(depsgraph, space, region, region_3d, pixel_size, sources=None):
    """Read the camera and film of a 3D view.

    In camera view the camera's lens takes the picture; any other view is a pinhole's.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph
    space : bpy.types.SpaceView3D
    region : bpy.types.Region
    region_3d : bpy.types.RegionView3D
    pixel_size : int
    sources : CameraSources or None
        As `scene.camera.camera.read_camera` takes it.

    Returns
    -------
    View or None
        None if the render border leaves nothing of the region.

    Raises
    ------
    CameraError
        If the view's camera is panoramic or custom.
    """
    scene = depsgraph.scene
    window = np.array(region_3d.window_matrix, np.float64)
    view = np.array(region_3d.view_matrix, np.float64)
    # The last pixels of the picture may reach out of the region.
    width, height = -(-region.width // pixel_size), -(-region.height // pixel_size)
    covered = np.array([region.width / width, region.height / height]) / pixel_size
    stretch = np.diag([*covered, 1.0, 1.0])
    stretch[:2, 3] = covered - 1.0
    frame = field_radius = None
    optics = {"lens": None}
    through_camera = region_3d.view_perspective == "CAMERA" and space.camera is not None
    if through_camera and space.camera.type == "CAMERA":
        camera = evaluated_camera(depsgraph, space.camera)
        frame = _camera_frame(camera, scene, window @ view)
        optics = read_optics(depsgraph, camera, sources=sources)
        field_radius = _field_radius(camera, scene) / optics["breathing"]
    if through_camera:
        border = _border_in_frame(scene.render, frame)
    else:
        border = _corners(space, "render_border") if space.use_render_border else _WHOLE
    part = _pixels(border, covered * (width, height))
    if part is None:
        return None
    render = scene.render
    film = Film(
        width,
        height,
        part,
        render.film_transparent,
        scene.aplanat.pixel_filter,
        filter_size(render),
    )
    orthographic = window[3, 3] != 0.0
    camera = Camera(
        view,
        with_breathing(stretch @ window, optics.get("breathing", 1.0)),
        orthographic=bool(orthographic),
        field_radius=field_radius,
        **optics,
    )
    return View(camera, film, pixel_size)


# Lower left and upper right corner of a rectangle, as shares of the region.
_WHOLE = np.array([[0.0, 0.0], [1.0, 1.0]])


def _camera_frame(camera, scene, view_to_clip):
    corners = np.ones((4, 4))
    corners[:, :3] = [
        camera.matrix_world.normalized() @ corner for corner in camera.data.view_frame(scene=scene)
    ]
    clip = corners @ view_to_clip.T
    shares = 0.5 * (clip[:, :2] / clip[:, 3:] + 1.0)
    return np.stack([shares.min(axis=0), shares.max(axis=0)])


def _field_radius(camera, scene):
    """Return `Camera.field_radius` of a camera's picture."""
    corners = np.array(camera.data.view_frame(scene=scene), np.float64)
    if camera.data.type != "ORTHO":
        corners /= -corners[:, 2:]
    return float(np.linalg.norm(corners[:, :2], axis=1).max())


def _border_in_frame(render, frame):
    if frame is None or not render.use_border:
        return _WHOLE
    return frame[0] + _corners(render, "border") * (frame[1] - frame[0])


def _corners(owner, prefix):
    return np.array(
        [[getattr(owner, f"{prefix}_{end}_{axis}") for axis in "xy"] for end in ("min", "max")]
    )


def _pixels(border, size):
    corners = np.rint(np.clip(border, 0.0, 1.0) * size).astype(int)
    (left, bottom), (right, top) = corners.tolist()
    if right <= left or top <= bottom:
        return None
    return left, bottom, right - left, top - bottom
