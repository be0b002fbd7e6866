"""The lens of a capture, given back to a camera and to the user's library."""

from ...engine.shared_resources import shelf
from ...lens_io import user_lenses
from ...lens_io.recorded_lens import differs
from ...scene.camera.lens_record import apply_lens, recorded_file
from ...scene.camera.lenses import user_folder


def restore_lens(captured, camera):
    """Give a camera the lens that it had when layers were captured.

    Parameters
    ----------
    captured : LayerCamera
        What it does not tell stays as it is.
    camera : bpy.types.Camera

    Returns
    -------
    str or None
        Id of the lens that was added to the user's library, which had none such.

    Raises
    ------
    AplanatError
        If it cannot be added; all else is restored.
    """
    dof = camera.dof
    dof.aperture_blades, dof.aperture_rotation = captured.blades, captured.blade_rotation
    dof.aperture_ratio = captured.aperture_ratio
    apply_lens(captured.lens_settings or {}, camera)
    recorded = recorded_file(captured.lens_settings)
    if recorded is None or (shelf().find(recorded[0]) and not differs(shelf(), *recorded)):
        return None
    added = user_lenses.keep_recorded(user_folder(), *recorded, shelf().ids())
    shelf().reload()
    camera.aplanat.lens = added.id
    return added.id
