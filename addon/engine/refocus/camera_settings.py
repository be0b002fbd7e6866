"""The settings of a Blender camera, for a captured picture to be seen through its lens."""

from dataclasses import replace

import numpy as np

from ...lens_bokeh.openings.shapes import iris_of
from ...lens_io.recorded_lens import differs
from ...scene.camera.bokeh import read_bokeh
from ...scene.camera.camera import CameraSources, focus_distance
from ...scene.camera.chromatic import read_chromatic
from ...scene.camera.distortion import read_distortion
from ...scene.camera.irises import read_opening
from ...scene.camera.lens_record import recorded_file
from ...scene.camera.lenses import read_artist, read_real_lens
from ..planning.field_table import picture_radius
from .settings import RefocusSettings


def camera_settings(
    stack,
    depsgraph,
    camera,
    sources=None,
    samples=RefocusSettings.samples,
    seed=RefocusSettings.seed,
):
    """Read everything that a captured picture takes of a camera.

    Depth of field counts as switched on. Place, framing and focal length are the capture's.

    Parameters
    ----------
    stack : LayerStack
    depsgraph : bpy.types.Depsgraph
    camera : bpy.types.Object
        Evaluated in the frame that is seen.
    sources : CameraSources or None
        Of the session: its library of lenses, its irises. None: they are read anew.
    samples, seed : int
        As of `RefocusSettings`.

    Returns
    -------
    settings : RefocusSettings
    problems : tuple of str
        Warnings about settings that cannot be met, as lines that name the camera.
    """
    sources = sources or CameraSources()
    data, captured = camera.data, stack.camera
    real_lens, of_lens = read_real_lens(data, sources.shelf)
    recorded = recorded_file(captured.lens_settings)
    if recorded and data.aplanat.lens == recorded[0]:
        of_lens += _against(recorded, sources.shelf, real_lens is not None)
    focus = focus_distance(depsgraph, camera)
    chromatic, of_chromatic = read_chromatic(data, real_lens)
    corner = 0.0
    if captured.orthographic:
        real_lens = None
    else:
        corner = picture_radius(np.array(captured.projection), False)
    if chromatic is not None:
        focal_length = 1.0 if captured.orthographic else captured.focal_length_mm / 1000.0
        chromatic = replace(chromatic, focal_length=focal_length)
    opening, of_iris = read_opening(data, real_lens, sources.irises)
    bokeh, of_bokeh = read_bokeh(data, real_lens, corner, opening)
    distortion, of_distortion = read_distortion(data, real_lens, corner)
    dof = data.dof
    settings = RefocusSettings(
        focus_distance=focus,
        f_stop=dof.aperture_fstop,
        iris=iris_of(opening, dof.aperture_rotation, dof.aperture_ratio),
        real_lens=real_lens,
        bokeh=bokeh,
        chromatic=chromatic,
        distortion=distortion,
        samples=samples,
        seed=seed,
        artist=None if captured.orthographic else read_artist(data, real_lens),
    )
    problems = (*of_lens, *of_iris, *of_chromatic, *of_bokeh, *of_distortion)
    return settings, tuple(f"camera '{camera.name}': {line}" for line in problems)


def _against(recorded, shelf, found):
    """Return a warning if a library's lens is not the one that was captured with."""
    restore = "Refocus > Restore as Captured adds the capture's to the library"
    if not found and shelf.find(recorded[0]) is None:
        return (restore,)
    if differs(shelf, *recorded):
        return (
            f"lens '{recorded[0]}' of the library is not the one of that name that the layers were"
            f" captured with; {restore}",
        )
    return ()
