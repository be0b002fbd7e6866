"""Where places in a lens' stop are counted: on its plane, or on a face as hollow as the glass.

Places in the stop tell rays apart as long as no ray is turned back before the rim. Fast lenses
whose stop stands close behind a deep hollow face may do that: near the rim the plane lies within
the glass, rays are followed back to it, and the steeper they left the face the nearer to the axis
they meet it. A face that touches the stop in the middle and is as hollow as the glass lies in the
open, where rays go forwards; places are counted on it, out to where the axial beam ends. The stop
stays where it is, one of the rims.
"""

from dataclasses import replace

import numpy as np

from ...errors import PrescriptionError
from ...optics.rays.trace import Rays, trace
from .stop_rays import StopAim

_PARAXIAL = 1e-4
# Axial rays, out to this many radii of the paraxial pupil.
_RAYS, _FARTHEST = 4001, 2.0


def paraxial_pupil(configuration, pupil, focus, wavelength_nm, along=(0.0, 1.0)):
    """Return the scale of the picture and the size of the stop's image in front of the lens.

    Parameters
    ----------
    configuration : Configuration
        Focused, its stop as far open as it is used.
    pupil : float
        z of the paraxial entrance pupil, mm.
    focus : float
        Vergence of the focus, 1/mm.
    wavelength_nm : float
    along : tuple of 2 float
        The meridian: (0, 1), or (1, 0), which is another one if the lens has cylinders.

    Returns
    -------
    scale : float
        mm a tangent.
    radius : float
        mm, negative if the stop is seen upside down.

    Raises
    ------
    PrescriptionError
        If rays near the axis do not get through.
    """
    aim = StopAim(configuration, pupil, 1.0, wavelength_nm)
    focus = np.array([focus])
    along = np.array(along)
    stops, _ = aim.through(np.zeros(2), focus, _PARAXIAL * along[None])
    _, landing = aim.through(_PARAXIAL * along, focus, np.zeros((1, 2)))
    stop, land = float(stops[0] @ along), float(landing[0] @ along)
    if stop == 0.0 or land == 0.0:
        raise PrescriptionError("rays near the axis do not get through the lens")
    return land / _PARAXIAL, _PARAXIAL / stop


def stop_shapes(configuration, pupil, radius, focus, wavelength_nm):
    """Return lenses whose stop surface is one to count places on, the likeliest first.

    Parameters
    ----------
    configuration, pupil, focus, wavelength_nm
        As of `paraxial_pupil`.
    radius : float
        That it returns.

    Yields
    ------
    configuration : Configuration
        The lens itself, then such with a face added behind its stop.
    places : float
        Radius of the face over that of the stop.
    """
    yield configuration, 1.0
    stop = configuration.surfaces[configuration.stop - 1]
    for neighbour in (configuration.stop - 2, configuration.stop):
        if not 0 <= neighbour < len(configuration.surfaces):
            continue
        shape = configuration.surfaces[neighbour]
        if shape.curvature == 0.0 and not shape.asphere:
            continue
        face = replace(
            stop,
            radius=shape.radius,
            conic=shape.conic,
            asphere=shape.asphere,
            curved_along=shape.curved_along,
        )
        surfaces = list(configuration.surfaces)
        surfaces[configuration.stop - 1] = replace(stop, thickness=0.0, is_stop=False)
        surfaces.insert(configuration.stop, face)
        hollow = replace(configuration, surfaces=tuple(surfaces))
        edge = _axial_edge(hollow, pupil, abs(radius), focus, wavelength_nm)
        if edge > 0.0:
            number = hollow.stop - 1
            surfaces[number] = replace(face, semi_diameter=edge)
            yield replace(hollow, surfaces=tuple(surfaces)), edge / stop.semi_diameter


def _axial_edge(configuration, pupil, radius, focus, wavelength_nm):
    """Return how far from the axis the outermost axial ray in focus meets the stop, mm."""
    places = np.linspace(0.0, _FARTHEST * radius, _RAYS)
    origins = np.column_stack([np.zeros(_RAYS), places, np.full(_RAYS, pupil)])
    directions = np.column_stack([np.zeros(_RAYS), places * focus, np.ones(_RAYS)])
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    traced = trace(configuration, Rays(origins, directions), wavelength_nm, clip=False, record=True)
    limits = np.array([surface.semi_diameter for surface in configuration.surfaces])
    hits = np.linalg.norm(traced.hits[..., :2], axis=-1)
    inside = hits <= limits[:, None]
    # The face has no rim yet.
    inside[configuration.stop - 1] = True
    passed = traced.reached & inside.all(axis=0)
    count = _RAYS if passed.all() else int(np.argmin(passed))
    return float(hits[configuration.stop - 1, :count].max(initial=0.0))
