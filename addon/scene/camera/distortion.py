"""Reads how a camera's lens bends straight lines: the terms of the division model."""

import math
from functools import lru_cache

import numpy as np

from ...errors import AplanatError, InputError
from ...optics.distortion import TERMS, divisor, fitted_terms, is_invertible, most_magnified
from ...optics.glass import REFERENCE_WAVELENGTH_NM
from ...optics.paraxial import first_order
from ...optics.rays.aberrations import paraxial_focus
from ...optics.rays.aiming import chief_ray
from ...optics.rays.beam import Beam
from ...optics.rays.trace import trace
from ...settings.scene_part_settings import DISTORTION
from ...settings.setting import settings_of

# Chief rays that a lens' curve is fitted to, how far beyond the corner they reach (a barrel shows
# more than the frame), and the largest tangent of a field angle.
_FIELDS = 33
_BEYOND = 1.25
_WIDEST_FIELD = 2.0
# Largest error of the fit, in distances from the axis to the corner: a fiftieth of a pixel of one
# that is 2000 pixels wide.
_EXACT = 2e-5
# A barrel shows at most twice the frame, a pincushion needs about twice the pixels.
_LEAST_DIVISOR, _MOST_MAGNIFIED = 0.5, 2.1


def read_distortion(camera, real_lens, corner):
    """Return a camera's distortion, and warnings about what cannot be met.

    Parameters
    ----------
    camera : bpy.types.Camera
        Evaluated in the frame that is drawn.
    real_lens : LensSettings or None
        As read from the same camera.
    corner : float
        Tangent of the field angle of the picture's corner.

    Returns
    -------
    terms : tuple of float
        As in `Camera`.
    problems : tuple of str
        One sentence each, without the camera's name.
    """
    own = camera.aplanat
    if own.distortion == "DIVISION":
        return ((own.distortion_k,) if own.distortion_k else ()), ()
    if own.distortion == "NONE":
        return (), ()
    if real_lens is None:
        return (), ("has no real lens whose distortion could be used; there is none",)
    prescription = real_lens.prescription
    named = f"lens '{prescription.name}'"
    configuration = prescription.configuration(real_lens.label)
    try:
        terms, drawn = _terms_of_lens(configuration, prescription.projection, corner)
    except AplanatError as error:
        return (), (f"{named} has no distortion that could be used: {error}",)
    problems = ()
    if not configuration.of_revolution:
        problems = (f"{named} has cylinders: its distortion along the height is drawn all round",)
    if drawn != terms:
        problems += (
            f"{named} has a distortion of K = {terms[0]:.3g}, more than can be drawn;"
            f" {drawn[0]:g} is drawn",
        )
    return drawn, problems


# Memo of its arguments alone: chief rays are traced for it.
@lru_cache(maxsize=64)
def _terms_of_lens(configuration, projection, corner):
    """Return the terms of a lens and those that can be drawn, the corner at a radius of 1."""
    if projection == "fisheye":
        raise InputError("a fisheye's picture is drawn rectilinear")
    tangents = np.linspace(0.0, min(_BEYOND * corner, _WIDEST_FIELD), _FIELDS)[1:]
    ideal, seen = _chief_rays(configuration, tangents)
    ideal, seen = ideal / corner, seen / corner
    terms = _least_terms(ideal, seen)
    if _can_be_drawn(terms):
        return terms, terms
    low, high = settings_of(DISTORTION)["distortion_k"].limits
    (k,), _ = fitted_terms(ideal, seen, 1, scaled=False)
    return (k,), (min(max(k, low), high),)


def _chief_rays(configuration, tangents):
    """Return the tangents of fields whose chief ray passes the rims, and those that are seen.

    Farther out a lens that does not cover the picture has no chief ray to go by: its rays bend
    wildly where rims would stop them.
    """
    values, focus = first_order(configuration), paraxial_focus(configuration)
    found = []
    for tangent in tangents.tolist():
        beam = Beam.from_infinity(math.degrees(math.atan(tangent)))
        chief = chief_ray(configuration, beam)
        if chief is None:
            break
        traced = trace(configuration, beam.rays(chief[None]), REFERENCE_WAVELENGTH_NM)
        if not traced.passed.all():
            break
        found.append((tangent, float(traced.at_plane(focus)[0, 1]) / values.efl))
    return np.array(found).reshape(-1, 2).T


def _least_terms(ideal, seen):
    """Fit as few terms as show no difference: what goes beyond the rays then goes on smoothly."""
    for count in range(1, TERMS + 1):
        terms, _ = fitted_terms(ideal, seen, count, scaled=False)
        if np.abs(ideal * divisor(seen**2, terms) - seen).max() < _EXACT:
            break
    return terms


def _can_be_drawn(terms):
    if not is_invertible(terms, 1.0):
        return False
    squares = np.linspace(0.0, 1.0, _FIELDS) ** 2
    least = float(divisor(squares, terms).min())
    return least >= _LEAST_DIVISOR and most_magnified(terms) <= _MOST_MAGNIFIED
