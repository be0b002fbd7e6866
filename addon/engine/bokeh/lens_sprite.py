"""The picture of a point out of focus through a camera's lens, for images and nodes.

Where the camera's bokeh takes vignetting from its real lens, rays are traced through the lens'
pupil at the field; else the disc is that of the lens' profile on the axis, or of a thin lens, with
the camera's cat's eyes. Diffraction, which depends on the size of the disc in a picture, is left
out.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...errors import InputError
from ...lens_bokeh.look.deposit import open_weights
from ...lens_bokeh.look.splat_profile import distance_from_h
from ...lens_bokeh.look.sprite import sprite, sprite_of_beam
from ...lens_bokeh.tables.mapping import pattern_row
from ...lens_bokeh.tables.pupil_beam import beam_from_infinity, beam_from_point
from ...lens_bokeh.tables.pupil_tracing import build_pupil_tables
from ...optics.focus import focused
from .lens_profiles import lens_profile, lens_pupil

# Room around the disc: a margin that is black.
_MARGIN = 1.06
_MM = 1000.0
_WIDEST_DEG = 85.0
# Rays along a side that the size of a disc is found with.
_RAYS = 96


@dataclass(frozen=True)
class SpritePoint:
    """A point of light, as a camera sees it.

    Parameters
    ----------
    tangent : tuple of 2 float
        Tangents of the angles to it, to the right and up.
    distance : float
        From the camera along the optical axis, m; inf is allowed.
    focus_distance : float
        Of the camera, m.
    """

    tangent: tuple[float, float]
    distance: float
    focus_distance: float


def lens_sprite(bokeh, real_lens, point, size):
    """Compose the sprite of a point.

    Parameters
    ----------
    bokeh : BokehSettings
    real_lens : LensSettings or None
        None for a thin lens, whose f-number changes nothing but the size.
    point : SpritePoint
    size : int
        Texels along a side.

    Returns
    -------
    ndarray of float32, shape (size, size)
        Row 0 is the bottom; the brightest texel is 1; black around.

    Raises
    ------
    InputError
        If the point is in focus, or no light of it comes through the lens.
    """
    if np.isclose(point.distance, point.focus_distance, rtol=1e-3):
        raise InputError("the point is in focus and has no disc; choose another distance")
    appearance = replace(bokeh.appearance, diffraction=None)
    traced = real_lens if real_lens is not None and real_lens.shapes_bokeh else None
    upright = point.distance > point.focus_distance
    if traced is not None and bokeh.vignetting == "LENS":
        light = _of_pupil(traced, appearance, point, size)
    else:
        extent = _MARGIN * max(1.0, 1.0 / appearance.anamorphic_ratio)
        how = {"upright": upright, "chief": point.tangent, "extent": extent}
        if bokeh.vignetting != "ANALYTIC":
            appearance = replace(appearance, rims=())
        light = sprite(appearance, size, **how)
        if traced is not None and bokeh.profile_strength > 0.0:
            profile = sprite(appearance, size, row=_row(traced, point), **how)
            light = light + (profile - light) * bokeh.profile_strength
    light = light.mean(axis=-1)
    most = light.max()
    if not most > 0.0:
        raise InputError(
            "no light of the point comes through the lens; choose a place nearer to the middle"
        )
    return (light / most).astype(np.float32)


def _row(lens, point):
    profile = lens_profile(lens)
    focus = distance_from_h(profile, point.focus_distance)
    distance = np.inf
    if np.isfinite(point.distance):
        distance = distance_from_h(profile, point.distance)
    return pattern_row(profile, distance, focus, lens.f_number)


def _of_pupil(lens, appearance, point, size):
    profile = lens_profile(lens)
    focus = distance_from_h(profile, point.focus_distance)
    state = profile.focused(focus)
    tables = lens_pupil(lens)
    if lens.prescription.focus:
        # A group moves for focusing: the pupil is another one.
        configuration = lens.prescription.configuration(lens.label)
        tables = build_pupil_tables(focused(configuration, focus, lens.prescription.focus))
    # Beyond the lens' own field discs are those of its edge, as in pictures.
    limit = np.tan(np.radians(min(tables.half_field_deg, _WIDEST_DEG)))
    tangent = min(float(np.hypot(*point.tangent)), float(limit))
    if np.isinf(point.distance):
        beam = beam_from_infinity(tables, np.arctan(tangent), lens.f_number)
    else:
        # The camera stands in the entrance pupil, which lies behind surface 1.
        distance = point.distance * _MM
        depth = distance - float(state.ray_map.pupil)
        beam = beam_from_point(tables, tangent * distance, depth, lens.f_number)
    shift = state.image_plane(focus) - tables.sensor
    azimuth = float(np.arctan2(point.tangent[1], point.tangent[0])) if tangent else 0.5 * np.pi
    middle, extent = _spanned(beam, shift)
    return sprite_of_beam(
        beam, shift, appearance, size, extent=extent, azimuth=azimuth, centre=middle
    )


def _spanned(beam, shift):
    """Return the middle of a disc, as its image height, and half the width that holds it, mm."""
    fine = beam.refined(_RAYS)
    is_open = open_weights(fine) > 0.0
    if not is_open.any():
        return 0.0, 1.0
    places = fine.landing(shift)[is_open]
    low, high = places.min(axis=0), places.max(axis=0)
    middle = 0.5 * float(low[1] + high[1])
    # However the disc is turned, it is inside.
    reach = np.hypot(places[:, 0], places[:, 1] - middle).max()
    return middle, _MARGIN * max(float(reach), 1e-6)
