"""Reads Blender's camera into a `Camera`: projection, thin lens, real lens, aberrations."""

import math
from dataclasses import dataclass, field

import numpy as np

from ...errors import CameraError, FocusError
from ...lens_bokeh.openings.blades import BladedIris
from ...lens_bokeh.openings.shapes import iris_of
from ...lens_io.lens_shelf import LensShelf
from ...sampling.thin_lens import ThinLens, aperture_radius
from ...snapshot.camera import Camera
from .bokeh import corner_tangent, read_bokeh
from .breathing import read_breathing, with_breathing
from .chromatic import read_chromatic
from .distortion import read_distortion
from .irises import IrisReader, read_opening
from .lenses import read_artist, read_real_lens, user_folder


def _library():
    return LensShelf([user_folder()])


@dataclass(frozen=True, eq=False)
class CameraSources:
    """Where the lens and the iris image of a camera are looked up.

    Without arguments, an empty one: everything is read from files.

    Parameters
    ----------
    shelf : LensShelf
        Real lenses by id.
    irises : IrisReader
        Pictures of irises.
    """

    shelf: LensShelf = field(default_factory=_library)
    irises: IrisReader = field(default_factory=IrisReader)


def read_camera(depsgraph, camera, film, view=None, sources=None):
    """Return the scene's camera as Blender frames it.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph
    camera : bpy.types.Object or None
    film : Film
    view : engine.views.View or None
        The view of a stereoscopic render, which has its own camera, or place and shift of one.
    sources : CameraSources or None
        None: lens and iris image are read anew.

    Returns
    -------
    Camera

    Raises
    ------
    CameraError
        If there is no camera or it is panoramic or custom.
    """
    camera, world, projection = _read_pose(depsgraph, camera, film, view)
    optics = read_optics(depsgraph, camera, world, sources)
    return Camera(
        view=np.array(world.inverted(), np.float64),
        projection=with_breathing(projection, optics["breathing"]),
        orthographic=camera.data.type == "ORTHO",
        **optics,
    )


def read_pose(depsgraph, camera, film, view=None, real_lens=None):
    """Return view and projection of the scene's camera, without its lens.

    Parameters
    ----------
    depsgraph, camera, film, view
        As of `read_camera`.
    real_lens : LensSettings or None
        Of the camera, for its focus breathing.

    Returns
    -------
    view, projection : ndarray of shape (4, 4)
        As in `Camera`.
    """
    camera, world, projection = _read_pose(depsgraph, camera, film, view)
    focus = None
    if camera.data.dof.use_dof:
        focus = focus_distance(depsgraph, camera, world)
    scale, _ = read_breathing(camera.data, real_lens, focus)
    return np.array(world.inverted(), np.float64), with_breathing(projection, scale)


def _read_pose(depsgraph, camera, film, view):
    """Return the evaluated camera, its place and its projection."""
    if camera is None:
        raise CameraError("the scene has no camera; add one or set Scene > Camera")
    if view is not None:
        camera = view.camera(depsgraph)
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
    projection = np.array(projection, np.float64)
    if view is None:
        world = camera_place(camera)
    else:
        world = view.place(camera).normalized()
        _shift(projection, data, render, film, view.shift_x(camera) - data.shift_x)
    return camera, world, projection


def read_optics(depsgraph, camera, world=None, sources=None):
    """Read a camera's lens settings, for the final render and the viewport alike.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph
    camera : bpy.types.Object
        Evaluated.
    world : mathutils.Matrix or None
        As `focus_distance` takes it.
    sources : CameraSources or None
        As `read_camera` takes it.

    Returns
    -------
    dict
        Arguments of `Camera`: ``lens``, ``real_lens``, ``chromatic``, ``bokeh``,
        ``distortion``, ``breathing``, ``artist``, ``f_number``, and ``report``, warnings about
        settings that cannot be met, as lines that name the camera.
    """
    data = camera.data
    sources = sources or CameraSources()
    real_lens, of_lens = read_real_lens(data, sources.shelf)
    opening, of_iris = read_opening(data, real_lens, sources.irises)
    lens, of_focus = read_lens(depsgraph, camera, real_lens, world, opening)
    focus = lens.focus_distance if lens else None
    chromatic, of_chromatic = read_chromatic(data, real_lens)
    breathing, of_breathing = read_breathing(data, real_lens, focus)
    corner = corner_tangent(data, depsgraph.scene) / breathing
    bokeh, of_bokeh = read_bokeh(data, real_lens, corner, opening)
    distortion, of_distortion = read_distortion(data, real_lens, corner)
    if not data.dof.use_dof:
        # Nothing shows its shape.
        of_iris = ()
    of_lens = (*of_lens, *of_iris)
    problems = (*of_lens, *of_focus, *of_chromatic, *of_bokeh, *of_distortion, *of_breathing)
    return {
        "lens": lens,
        "real_lens": real_lens,
        "chromatic": chromatic,
        "bokeh": bokeh,
        "distortion": distortion,
        "breathing": breathing,
        "artist": read_artist(data, real_lens),
        "f_number": real_lens.f_number if real_lens else data.dof.aperture_fstop,
        "report": tuple(f"camera '{camera.name_full}': {line}" for line in problems),
    }


def _shift(projection, data, render, film, shift_x):
    """Move a picture sideways as Blender's camera shift does; changes `projection`."""
    aspect = render.pixel_aspect_y / render.pixel_aspect_x
    width, height = film.width, aspect * film.height
    fit = data.sensor_fit
    if fit == "AUTO":
        fit = "HORIZONTAL" if width >= height else "VERTICAL"
    # In half pictures, as the projection counts; the filled side of the sensor has length 1.
    moved = 2.0 * shift_x * (width if fit == "HORIZONTAL" else height) / width
    if data.type == "ORTHO":
        projection[0, 3] -= moved
    else:
        projection[0, 2] += moved


def camera_place(camera):
    """Return a camera's place and orientation, without its scale and that of its parents.

    Raises
    ------
    CameraError
        If it is scaled to zero along an axis and has no direction.
    """
    place = camera.matrix_world.normalized()
    if abs(place.determinant()) < 1e-6:
        raise CameraError(
            f"camera '{camera.name_full}' or one of its parents has a scale of 0 and looks nowhere;"
            " set the scale to 1 (Object > Apply > Scale, or the scale of the parent)"
        )
    return place


def evaluated_camera(depsgraph, camera):
    """Return a camera as it is in the depsgraph's frame.

    Raises
    ------
    CameraError
        If it is panoramic or custom.
    """
    camera = camera.evaluated_get(depsgraph)
    check_kind(camera)
    return camera


_KINDS = {"PANO": "panoramic"}


def check_kind(camera):
    """Refuse a camera that is neither perspective nor orthographic.

    Raises
    ------
    CameraError
    """
    kind = camera.data.type
    if kind not in {"PERSP", "ORTHO"}:
        raise CameraError(
            f"camera '{camera.name_full}' is {_KINDS.get(kind, kind.lower())}; Aplanat renders"
            " perspective and orthographic cameras (Camera > Lens > Type)"
        )


def read_lens(depsgraph, camera, real_lens=None, world=None, opening=None):
    """Return the thin lens of a camera with depth of field.

    The aperture follows Cycles: focal length over f-number, and 1 m over it where an orthographic
    camera has no focal length. A real lens opens no wider than it can. `world` is as
    `focus_distance` takes it, `opening` of `read_opening`; without one it is round.

    Returns
    -------
    lens : ThinLens or None
        None without depth of field, and where focus or iris cannot form a picture.
    problems : tuple of str
        Warnings about settings that cannot be met, without the camera's name.
    """
    data = camera.data
    dof = data.dof
    if not dof.use_dof:
        return None, ()
    focal_length = 1.0 if data.type == "ORTHO" else data.lens / 1000.0
    f_number = real_lens.f_number if real_lens else dof.aperture_fstop
    iris = iris_of(opening or BladedIris(), dof.aperture_rotation, dof.aperture_ratio)
    distance = focus_distance(depsgraph, camera, world)
    try:
        lens = ThinLens(aperture_radius(focal_length, f_number), distance, iris)
    except FocusError as error:
        return None, (f"{error}; everything is drawn sharp",)
    problems = ()
    if real_lens and real_lens.limits(dof.aperture_fstop):
        problems += (
            f"asks for f/{dof.aperture_fstop:.3g}, and lens '{real_lens.prescription.name}' opens"
            f" no wider than f/{f_number:.3g}, which is drawn",
        )
    if dof.focus_object is not None and _focus_depth(depsgraph, camera, world) < 0.0:
        problems += (
            f"focus object '{dof.focus_object.name}' is behind the camera; its distance counts, as"
            " in Cycles",
        )
    if data.type == "PERSP" and distance < focal_length:
        problems += (
            f"focuses at {distance:.3g} m, nearer than its focal length of {focal_length:.3g} m, as"
            " no lens can; what is farther is blurred beyond recognition (see Focus Distance)",
        )
    return lens, problems


def focus_distance(depsgraph, camera, world=None):
    """Return the distance of the focus plane along the optical axis, in m.

    As in Cycles and EEVEE, a focus object behind the camera counts as if it were in front.

    Parameters
    ----------
    depsgraph : bpy.types.Depsgraph
    camera : bpy.types.Object
        Evaluated.
    world : mathutils.Matrix or None
        Camera to world, for an eye of a stereoscopic render: it focuses on a focus object by its
        own distance from it, as in Cycles. None: the camera's own place.

    Returns
    -------
    float
        Not finite, or 0, where nothing can be in focus.
    """
    if camera.data.dof.focus_object is None:
        return camera.data.dof.focus_distance
    return abs(_focus_depth(depsgraph, camera, world))


def _focus_depth(depsgraph, camera, world):
    """Return how far in front of a camera its focus object is, in m; negative behind it."""
    dof = camera.data.dof
    target = dof.focus_object.evaluated_get(depsgraph)
    matrix = target.matrix_world
    if dof.focus_subtarget and target.pose and dof.focus_subtarget in target.pose.bones:
        matrix = matrix @ target.pose.bones[dof.focus_subtarget].matrix
    world = camera_place(camera) if world is None else world
    place = world.inverted() @ matrix.translation
    return -place.z


def sensor_diagonal(camera, scene):
    """Return the diagonal of the part of the sensor that the picture uses, in mm.

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
