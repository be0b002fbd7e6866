"""Reads the chromatic aberration of a Blender camera into a `ChromaticAberration`."""

from dataclasses import replace
from functools import lru_cache

import bpy
import numpy as np

from ...errors import AplanatError, GlassNotFoundError
from ...lens_io.glasses.dispersion import DEFAULT_GLASS, glass_dispersion, lens_dispersion
from ...optics.glass import REFERENCE_WAVELENGTH_NM
from ...sampling.chromatic import SPECTRAL_RANGE_NM, WIDEST_RANGE_NM, ChromaticAberration
from ...sampling.equalizer import FLAT, SpectralEqualizer
from ...sampling.field_maps import LIMIT, LINEAR_CURVE, FieldMap
from ...sampling.spectral_bands import middle_wavelength
from ...sampling.spectrum import LINEAR_REC709, primaries_of
from .drawn_curves import EQUALIZER, EQUALIZER_RANGE_NM, MAP_CURVES, SAMPLES, curve_values

# `k_l` at strength 1, 1/um: over the 400 nm from violet to red the corners of the picture differ by
# 2 % in size, about as much as those of a simple lens. A thin lens itself has no lateral colour.
LATERAL_UNIT = 0.05
# Least width of the spectrum, nm: a narrower one has no dispersion to show.
_NARROWEST_RANGE_NM = 1.0
_ATOM_STEPS = {"axial": ("axial_first", "axial_then"), "lateral": ("lateral_first", "lateral_then")}


def read_chromatic(camera, real_lens):
    """Return the chromatic aberration of a camera, and warnings about what cannot be met.

    Parameters
    ----------
    camera : bpy.types.Camera
        Evaluated in the frame that is drawn.
    real_lens : LensSettings or None
        As read from the same camera.

    Returns
    -------
    chromatic : ChromaticAberration or None
        None where it is switched off; the identical object as long as nothing changes.
    problems : tuple of str
        One sentence each, without the camera's name.
    """
    if not camera.aplanat.chromatic.use:
        return None, ()
    return describe_chromatic(camera, real_lens)


def describe_chromatic(camera, real_lens):
    """Read chromatic aberration as `read_chromatic`, even if it is switched off."""
    settings = camera.aplanat.chromatic
    dispersion, of_lens, problems = _read_dispersion(settings, real_lens)
    maps = []
    for which in _ATOM_STEPS:
        field_map = read_field_map(settings, which)
        maps.append(field_map)
        problems += _map_problems(settings, which, field_map)
    wavelength_range, range_problems = _read_range(settings)
    equalizer, equalizer_problems = _read_equalizer(settings, wavelength_range)
    primaries, space_problems = _read_primaries()
    aberration = _aberration(
        settings.mode,
        settings.axial,
        settings.lateral * LATERAL_UNIT,
        dispersion,
        1.0 if camera.type == "ORTHO" else camera.lens / 1000.0,
        *maps,
        wavelength_range,
        equalizer,
        primaries,
        "LENS" if of_lens else settings.focus_light,
    )
    problems += range_problems + equalizer_problems + space_problems
    return aberration, problems + _problems(aberration)


def read_field_map(settings, which):
    """Return a field map of a camera.

    Parameters
    ----------
    settings : AplanatChromaticSettings
    which : {'axial', 'lateral'}

    Returns
    -------
    FieldMap
        The identical object as long as the map does not change.
    """
    atoms = [getattr(settings, name) for name in _ATOM_STEPS[which]]
    curves = [LINEAR_CURVE, LINEAR_CURVE]
    for step, atom in enumerate(atoms):
        if atom == "CURVE":
            drawn = curve_values(settings.curves, MAP_CURVES[which, step])
            curves[step] = LINEAR_CURVE if drawn is None else drawn
    return _field_map(*atoms, *curves)


# Memos of their arguments alone: what is equal is one object, so that it is compared at once.
_field_map = lru_cache(maxsize=64)(FieldMap)
_problems = lru_cache(maxsize=64)(ChromaticAberration.problems)


# Memo of its arguments alone; see above.
@lru_cache(maxsize=16)
def _aberration(*settings_and_focus):
    *settings, focus = settings_and_focus
    found = ChromaticAberration(*settings)
    if focus == "LENS":
        return replace(found, focus_nm=REFERENCE_WAVELENGTH_NM, of_lens=True)
    return replace(found, focus_nm=middle_wavelength(found)) if focus == "MIDDLE" else found


# Memo of the weights alone; see above.
@lru_cache(maxsize=16)
def _equalizer(weights):
    wavelengths = np.linspace(*EQUALIZER_RANGE_NM, SAMPLES)
    return SpectralEqualizer(tuple(wavelengths.tolist()), weights)


def _read_dispersion(settings, real_lens):
    if settings.dispersion == "LENS":
        if real_lens is not None:
            return _dispersion_of_lens(real_lens)
        dispersion, _, problems = _dispersion_of_glass(settings.glass)
        told = f"has no real lens whose colors could be used; those of {settings.glass} are used"
        return dispersion, False, problems or (told,)
    return _dispersion_of_glass(settings.glass)


def _dispersion_of_glass(name):
    """Return a dispersion, whether it is the real lens', and warnings."""
    try:
        return glass_dispersion(name), False, ()
    except GlassNotFoundError as error:
        problem = f"{error}; {DEFAULT_GLASS} parts the colors instead"
    except AplanatError as error:
        problem = f"glass '{name}': {error}; {DEFAULT_GLASS} parts the colors instead"
    return glass_dispersion(DEFAULT_GLASS), False, (problem,)


def _dispersion_of_lens(real_lens):
    name = real_lens.prescription.name
    configuration = real_lens.prescription.configuration(real_lens.label)
    try:
        dispersion = lens_dispersion(configuration)
    except AplanatError as error:
        problem = f"lens '{name}' has no axial color that could be used ({error})"
        told = f"{problem}; that of {DEFAULT_GLASS} is used"
        return glass_dispersion(DEFAULT_GLASS), False, (told,)
    if not dispersion.disperses:
        told = f"the glasses of lens '{name}' are given without dispersion: it parts no colors"
        return dispersion, True, (told,)
    if not configuration.of_revolution:
        told = f"lens '{name}' has cylinders: its axial color along the height is drawn all round"
        return dispersion, True, (told,)
    return dispersion, True, ()


def _map_problems(settings, which, field_map):
    problems = []
    for step, name in enumerate(_ATOM_STEPS[which]):
        if getattr(settings, name) == "CURVE":
            drawn = curve_values(settings.curves, MAP_CURVES[which, step])
            if drawn is None:
                problems.append(f"the {which} map has no drawn curve; a straight line is used")
    if field_map.clamped:
        problems.append(
            f"the {which} map {field_map.text} grows without bound; it is clamped to {LIMIT:g}"
        )
    return tuple(problems)


def _read_range(settings):
    if settings.mode == "RGB":
        return SPECTRAL_RANGE_NM, ()
    low, high = settings.wavelength_min, settings.wavelength_max
    if WIDEST_RANGE_NM[0] <= low and low + _NARROWEST_RANGE_NM <= high <= WIDEST_RANGE_NM[1]:
        return (low, high), ()
    used = f"{SPECTRAL_RANGE_NM[0]:g} to {SPECTRAL_RANGE_NM[1]:g} nm are used"
    return SPECTRAL_RANGE_NM, (f"the wavelengths {low:g} to {high:g} nm do not rise; {used}",)


def _read_equalizer(settings, wavelength_range):
    if not settings.use_equalizer or settings.mode == "RGB":
        return FLAT, ()
    weights = curve_values(settings.curves, EQUALIZER)
    if weights is None:
        return FLAT, ("the spectral equalizer has no curve; all wavelengths count alike",)
    equalizer = _equalizer(tuple(max(weight, 0.0) for weight in weights))
    if not equalizer(np.linspace(*wavelength_range, SAMPLES)).any():
        return FLAT, ("the spectral equalizer leaves no wavelength; all count alike",)
    return equalizer, ()


def _read_primaries():
    space = bpy.data.colorspace.working_space
    primaries = primaries_of(space)
    if primaries is None:
        return LINEAR_REC709, (f"working space '{space}' is not known; its colors are Rec.709's",)
    return primaries, ()
