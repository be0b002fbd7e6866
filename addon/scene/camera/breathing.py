"""Focus breathing: a lens focused near draws larger than one focused far (methods 1)."""

from functools import lru_cache

import numpy as np

from ...errors import PrescriptionError
from ...optics.focus import focused
from ...optics.paraxial import first_order, magnification


def read_breathing(camera, real_lens, focus_distance):
    """Return how much larger a camera draws than with its focus at infinity, and warnings.

    The thin lens has the magnification ``F / (d - F)`` at a focus distance d, and a camera without
    breathing ``F / d``. A real lens has that of its paraxial image of an object at d before its
    entrance pupil, where the camera stands, focused by its focus group.

    Parameters
    ----------
    camera : bpy.types.Camera
        Evaluated in the frame that is drawn.
    real_lens : LensSettings or None
        As read from the same camera.
    focus_distance : float or None
        In m; None without depth of field.

    Returns
    -------
    scale : float
        1 where breathing is switched off, or the lens cannot be focused there.
    problems : tuple of str
        One sentence each, without the camera's name.
    """
    if not camera.aplanat.use_breathing or focus_distance is None:
        return 1.0, ()
    if camera.type != "PERSP":
        return 1.0, ("has no focus breathing: it needs a perspective camera",)
    if real_lens is not None:
        prescription = real_lens.prescription
        configuration = prescription.configuration(real_lens.label)
        try:
            scale = _of_lens(configuration, prescription.focus, 1000.0 * focus_distance)
        except PrescriptionError as error:
            return 1.0, (
                f"lens '{prescription.name}' has no focus breathing that could be drawn: {error}",
            )
        return scale, ()
    focal_length = camera.lens / 1000.0
    if not focus_distance > focal_length:
        return 1.0, (
            f"has no focus breathing: it focuses at {focus_distance:.3g} m, nearer than its focal"
            f" length of {focal_length:.3g} m",
        )
    if np.isinf(focus_distance):
        return 1.0, ()
    return focus_distance / (focus_distance - focal_length), ()


def with_breathing(projection, scale):
    """Return a perspective projection that draws larger, about the optical axis.

    Parameters
    ----------
    projection : ndarray of shape (4, 4)
    scale : float

    Returns
    -------
    ndarray of shape (4, 4)
    """
    if scale == 1.0:
        return projection
    projection = projection.copy()
    projection[[0, 1], [0, 1]] *= scale
    return projection


# Memo of its arguments alone.
@lru_cache(maxsize=256)
def _of_lens(configuration, focus_group, distance):
    """Return the scale of a real lens focused at a distance before its entrance pupil, mm."""
    if np.isinf(distance):
        return 1.0
    lens, before = configuration, distance
    # The entrance pupil moves with the group, little against the distance.
    for _ in range(8):
        before = distance - first_order(lens).enp_z
        lens = focused(configuration, before, focus_group)
    return abs(magnification(lens, before)) * distance / first_order(configuration).efl
