"""Blender's camera to a `Camera`."""

import math

import numpy as np

from ..errors import CameraError, FocusError
from ..sampling.iris import Iris
from ..sampling.thin_lens import ThinLens, aperture_radius
from .bokeh import corner_tangent, read_bokeh
from .chromatic import read_chromatic
from .lenses import read_real_lens
from .snapshot import Camera


def read_camera(depsgraph, camera, film):
    """Return the scene's camera as Blender frames it.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph
    camera : bpy.types.Object or None
    film : Film

    Returns
    -------
    Camera

    Raises
    ------
    CameraError
        If there is no camera or it is panoramic or custom.
    FocusError
        If its focus distance or iris cannot form a picture.
    """
    if camera is None:
        raise CameraError("the scene has no camera; add one or set Scene > Camera")
    camera = evaluated_camera(depsgraph, camera)
    data = camera.data
    render = depsgraph.scene.render
    projection = camera.calc_matrix_camera(
        depsgraph,
        x=film.width,
        y=film.height,
        scale_x=render.pixel_aspect_x,
        scale_y=render.pixel_aspect_y,
    )
    world = camera.matrix_world.normalized()
    real_lens, problems = read_real_lens(data)
    lens = read_lens(depsgraph, camera, real_lens) if data.dof.use_dof else None
    focus = lens.focus_distance if lens else None
    chromatic, chromatic_problems = read_chromatic(data, real_lens, focus)
    corner = corner_tangent(data, depsgraph.scene)
    bokeh, bokeh_problems = read_bokeh(data, real_lens, corner)
    problems = (*problems, *chromatic_problems, *bokeh_problems)
    return Camera(
        view=np.array(world.inverted(), np.float64),
        projection=np.array(projection, np.float64),
        lens=lens,
        orthographic=data.type == "ORTHO",
        real_lens=real_lens,
        report=tuple(f"camera '{camera.name}': {problem}" for problem in problems),
        chromatic=chromatic,
        bokeh=bokeh,
    )


def evaluated_camera(depsgraph, camera):
    """Return a camera as it is in the depsgraph's frame.

    Raises
    ------
    CameraError
        If it is panoramic or custom.
    """
    camera = camera.evaluated_get(depsgraph)
    kind = camera.data.type
    if kind not in {"PERSP", "ORTHO"}:
        raise CameraError(
            f"camera '{camera.name}' is {kind.lower()}; Aplanat renders perspective and"
            " orthographic cameras (Camera > Lens > Type)"
        )
    return camera


def read_lens(depsgraph, camera, real_lens=None):
    """Return the thin lens of a camera with depth of field.

    The aperture follows Cycles: focal length over f-number, and 1 m over it where an orthographic
    camera has no focal length. A real lens opens no wider than it can.
    """
    data = camera.data
    dof = data.dof
    focal_length = 1.0 if data.type == "ORTHO" else data.lens / 1000.0
    f_number = real_lens.f_number if real_lens else dof.aperture_fstop
    iris = Iris(dof.aperture_blades, dof.aperture_rotation, dof.aperture_ratio)
    return ThinLens(
        aperture_radius(focal_length, f_number), focus_distance(depsgraph, camera), iris
    )


def focus_distance(depsgraph, camera):
    """Return the distance of the focus plane along the optical axis, in m.

    Raises
    ------
    FocusError
        If the focus object lies behind the camera.
    """
    dof = camera.data.dof
    if dof.focus_object is None:
        return dof.focus_distance
    target = dof.focus_object.evaluated_get(depsgraph)
    matrix = target.matrix_world
    if dof.focus_subtarget and target.pose and dof.focus_subtarget in target.pose.bones:
        matrix = matrix @ target.pose.bones[dof.focus_subtarget].matrix
    place = camera.matrix_world.normalized().inverted() @ matrix.translation
    if place.z >= 0.0 or not math.isfinite(place.z):
        raise FocusError(
            f"focus object '{target.name}' is not in front of camera '{camera.name}';"
            " move it or choose another one"
        )
    return -place.z


def sensor_diagonal(camera, scene):
    """Return the diagonal of what the picture takes of the sensor, in mm.

    Parameters
    ----------
    camera : bpy.types.Camera
    scene : bpy.types.Scene
        Its picture's shape decides which side of the sensor is filled.

    Returns
    -------
    float
    """
    render = scene.render
    width = render.resolution_x * render.pixel_aspect_x
    height = render.resolution_y * render.pixel_aspect_y
    fit = camera.sensor_fit
    if fit == "AUTO":
        filled, side = camera.sensor_width, max(width, height)
    elif fit == "HORIZONTAL":
        filled, side = camera.sensor_width, width
    else:
        filled, side = camera.sensor_height, height
    return filled * math.hypot(width, height) / side
