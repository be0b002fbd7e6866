"""Reads the bokeh settings of a Blender camera into `BokehSettings`."""

import math
from functools import lru_cache

import numpy as np

from ...lens_bokeh.look.appearance import Appearance, Diffraction
from ...lens_bokeh.look.grain import Grain
from ...lens_bokeh.look.onion import OnionRings
from ...lens_bokeh.look.vignetting_model import cat_eye
from ...sampling.spectrum import rgb_weights, spectrum_wavelengths
from ...settings.bokeh_settings import BOKEH
from ...settings.setting import fields_of
from ...snapshot.camera import BokehSettings
from .irises import read_opening

# Members of the rim of the softest cat's eye; a single member makes a hard edge.
_MOST_RIMS = 8
# Wavelengths of the diffraction ringing: enough that the rings of neighbouring ones overlap.
_RINGING_WAVELENGTHS = 9


def read_bokeh(camera, real_lens, corner, opening):
    """Return a camera's bokeh settings, and warnings about those that cannot be met.

    Parameters
    ----------
    camera : bpy.types.Camera
        Evaluated in the frame that is drawn.
    real_lens : LensSettings or None
        As read from the same camera.
    corner : float
        Tangent of the field angle of the picture's corner; see `corner_tangent`.
    opening : BladedIris or PictureIris
        Of `read_opening`, with the same camera.

    Returns
    -------
    bokeh : BokehSettings or None
        None where it is switched off.
    problems : tuple of str
        One sentence each, without the camera's name.
    """
    if not camera.aplanat.bokeh.use:
        return None, ()
    return _describe(camera, real_lens, corner, opening)


def describe_bokeh(camera, real_lens, corner, irises):
    """Read bokeh as `read_bokeh`, even if it is switched off.

    `irises` is the `IrisReader` that reads a picture of an iris; `read_opening` tells what is wrong
    with one.
    """
    opening, _ = read_opening(camera, real_lens, irises)
    return _describe(camera, real_lens, corner, opening)


def _describe(camera, real_lens, corner, opening):
    settings = camera.aplanat.bokeh
    shaping = real_lens if real_lens and real_lens.shapes_bokeh else None
    appearance, problems = _read_appearance(camera, shaping, corner, opening)
    vignetting = settings.vignetting
    if vignetting == "LENS" and shaping is None:
        vignetting = "NONE"
    bokeh = BokehSettings(
        **fields_of(settings, *BOKEH),
        appearance=appearance,
        vignetting=vignetting,
    )
    return bokeh, problems + _told(camera)


def _told(camera):
    if camera.aplanat.bokeh.use and camera.aplanat.bokeh.debug_view != "NONE":
        return ("the picture is the debug view of the bokeh",)
    return ()


def corner_tangent(camera, scene):
    """Return the tangent of the field angle of a picture's farthest corner.

    Parameters
    ----------
    camera : bpy.types.Camera
    scene : bpy.types.Scene
        Its picture's shape decides where the corners are.

    Returns
    -------
    float
        0 for a parallel camera, whose rays have no angle.
    """
    if camera.type != "PERSP":
        return 0.0
    corners = np.array(camera.view_frame(scene=scene), np.float64)
    corners /= -corners[:, 2:]
    return float(np.linalg.norm(corners[:, :2], axis=1).max())


def _read_appearance(camera, real_lens, corner, opening):
    settings, dof = camera.aplanat.bokeh, camera.dof
    problems, rims = (), ()
    if settings.vignetting == "ANALYTIC":
        if corner > 0.0:
            members = 1 + round(settings.vignetting_softness * (_MOST_RIMS - 1))
            rims = cat_eye(settings.vignetting_strength, corner, members)
        else:
            problems = ("cat's eyes are left out: they need a perspective camera",)
    grain = onion = ringing = None
    if settings.grain > 0.0 or (settings.dust > 0 and settings.dust_depth > 0.0):
        grain = Grain(
            strength=settings.grain,
            cell=settings.grain_size,
            dust=settings.dust,
            dust_radius=settings.dust_size,
            dust_depth=settings.dust_depth,
            seed=settings.texture_seed,
        )
    if settings.onion > 0.0:
        onion = OnionRings(
            contrast=settings.onion,
            pitch=settings.onion_pitch,
            irregularity=settings.onion_irregularity,
            seed=settings.texture_seed,
        )
    if settings.diffraction > 0.0:
        ringing = Diffraction(settings.diffraction, *_ringing_spectrum())
    appearance = Appearance(
        iris=opening,
        grain=grain,
        onion=onion,
        rims=rims,
        diffraction=ringing,
        # An invalid ratio: the camera then has no lens, and a warning tells so.
        anamorphic_ratio=dof.aperture_ratio if 0.0 < dof.aperture_ratio < math.inf else 1.0,
        # A traced lens has its own spherical aberration.
        edge=settings.hardness if real_lens is None else 0.0,
    )
    return appearance, problems


# Memo of nothing but constants.
@lru_cache(maxsize=1)
def _ringing_spectrum():
    wavelengths = spectrum_wavelengths(_RINGING_WAVELENGTHS)
    weights = rgb_weights(wavelengths)
    return tuple(wavelengths.tolist()), tuple(map(tuple, weights.tolist()))
