"""The real lens that a Blender camera names: looked up in the library, at its zoom and f-number."""

from pathlib import Path

import bpy

from ...lens_bokeh.tables.artist_lens import ArtistLens
from ...settings.scene_part_settings import ABERRATIONS
from ...settings.setting import settings_of
from ...snapshot.camera import LensSettings

_EXTENSIONS = "bl_ext."


def user_folder():
    """Return the folder of the user's own lens files; it may not be there yet.

    Returns
    -------
    Path
        That of the extension, which stays when it is updated; for a checkout one among Blender's
        data files.
    """
    package = __package__
    if package.startswith(_EXTENSIONS):
        # Blender, repository, extension.
        extension = ".".join(package.split(".")[:3])
        return Path(bpy.utils.extension_path_user(extension, path="lenses"))
    return Path(bpy.utils.user_resource("DATAFILES", path="aplanat/lenses"))


def read_real_lens(camera, shelf):
    """Return the real lens of a camera, and warnings about settings that cannot be met.

    Parameters
    ----------
    camera : bpy.types.Camera
    shelf : LensShelf
        The library that is looked into.

    Returns
    -------
    lens : LensSettings or None
        None if the camera names none or it cannot be used.
    problems : tuple of str
        One sentence each, without the camera's name.
    """
    wanted = camera.aplanat
    if not wanted.lens:
        return None, ()
    found = shelf.find(wanted.lens)
    if found is None:
        near = shelf.near_ids(wanted.lens)
        hint = f" (near names: {', '.join(near)})" if near else ""
        return None, (
            f"lens '{wanted.lens}' is not in the library{hint}; import its file or choose another"
            " lens; it is drawn as a thin lens",
        )
    if found.lens is None:
        return None, (f"its lens cannot be used, it is drawn as a thin lens: {found.error}",)
    if camera.type != "PERSP":
        return None, (f"lens '{found.name}' is left out: it needs a perspective camera",)
    prescription = found.lens.prescription
    problems = ()
    label = wanted.zoom_label or None
    if label not in (None, *prescription.labels):
        problems = (f"lens '{found.name}' has no zoom position '{label}'; it is at its first one",)
        label = None
    return _at_camera(found, label, camera), problems


def read_compared_lens(camera, shelf):
    """Return the lens that a camera's lens is compared with, as it would be on the camera.

    Parameters
    ----------
    camera : bpy.types.Camera
    shelf : LensShelf

    Returns
    -------
    LensSettings or None
        None if the camera names none or it cannot be used.
    """
    found = shelf.find(camera.aplanat.compared_lens) if camera.aplanat.compared_lens else None
    if found is None or found.lens is None:
        return None
    wanted = camera.aplanat.zoom_label
    label = wanted if wanted in found.lens.prescription.labels else None
    return _at_camera(found, label or None, camera)


def _at_camera(found, label, camera):
    prescription = found.lens.prescription
    configuration = prescription.configuration(label)
    f_number = max(camera.dof.aperture_fstop, configuration.f_number)
    own = (found.id, configuration.label, f_number, prescription, camera.aplanat.exposure)
    return LensSettings(*own)


def read_artist(camera, real_lens):
    """Return the aberrations of a camera without a real lens.

    Parameters
    ----------
    camera : bpy.types.Camera
    real_lens : LensSettings or None

    Returns
    -------
    ArtistLens or None
        None where there are none: with a real lens, with a parallel projection.
    """
    if real_lens is not None or camera.type != "PERSP":
        return None
    lens = ArtistLens(**{name: getattr(camera.aplanat, name) for name in settings_of(ABERRATIONS)})
    return None if lens.is_plain else lens
