"""Presets that come with Aplanat, in the order in which the menus show them.

A preset sets everything that a user's own preset of its kind keeps (`setting.kept_names`); here
stands what differs from the defaults.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from ..sampling.field_maps import FIELD_PRESETS


@dataclass(frozen=True)
class Preset:
    """A named choice of settings.

    Parameters
    ----------
    name, description : str
        For people; Blender ends the tooltip with a dot.
    values : mapping of str
        By the names of settings, where they are not the defaults.
    """

    name: str
    description: str
    values: Mapping[str, object]


def _sampling(name, description, errors, most, samples):
    """Return a preset of sampling, from pairs of numbers: for final render and viewport."""
    values = {
        "render_error": errors[0],
        "preview_error": errors[1],
        "render_max_samples": most[0],
        "preview_max_samples": most[1],
        "render_samples": samples[0],
        "preview_samples": samples[1],
    }
    return Preset(name, description, values)


SAMPLING_PRESETS = (
    _sampling(
        "Draft",
        "For blocking: noise is visible in strong blur",
        errors=(0.03, 0.08),
        most=(512, 256),
        samples=(32, 16),
    ),
    _sampling(
        "Preview",
        "For reviews: smooth but for the strongest blur",
        errors=(0.01, 0.03),
        most=(2048, 1024),
        samples=(128, 64),
    ),
    _sampling(
        "Final",
        "For delivery: strong blur and small bright lights are smooth",
        errors=(0.003, 0.01),
        most=(4096, 1024),
        samples=(1024, 256),
    ),
)

BOKEH_PRESETS = (
    Preset(
        "Clean",
        "Even discs with straight blades, or what the real lens makes of them: how a camera starts",
        {},
    ),
    Preset(
        "Soap Bubble",
        "Bright edges behind the focus, as of an overcorrected triplet",
        {
            "hardness": 0.85,
            "blade_curvature": 1.0,
            "vignetting": "ANALYTIC",
            "vignetting_strength": 0.25,
        },
    ),
    Preset(
        "Creamy",
        "Soft edges behind the focus, as of an undercorrected portrait lens",
        {"hardness": -0.8, "blade_curvature": 1.0},
    ),
    Preset(
        "Swirl",
        "Strong cat's eyes that turn round the middle of the picture, as of a Petzval lens",
        {
            "hardness": 0.2,
            "blade_curvature": 1.0,
            "vignetting": "ANALYTIC",
            "vignetting_strength": 0.6,
            "vignetting_softness": 0.15,
        },
    ),
    Preset(
        "Vintage",
        "Slightly bright edges, curved blades, soft cat's eyes, some grain and dust",
        {
            "hardness": 0.4,
            "blade_curvature": 0.4,
            "vignetting": "ANALYTIC",
            "vignetting_strength": 0.45,
            "vignetting_softness": 0.5,
            "grain": 0.08,
            "grain_size": 0.04,
            "dust": 14,
            "dust_size": 0.05,
            "dust_depth": 0.4,
            "texture_seed": 3,
        },
    ),
    Preset(
        "Dusty",
        "A lens that was not cleaned for long",
        {
            "grain": 0.2,
            "grain_size": 0.06,
            "dust": 60,
            "dust_size": 0.07,
            "dust_depth": 0.6,
            "texture_seed": 1,
        },
    ),
    Preset(
        "Aspheric",
        "Onion rings of a moulded asphere",
        {"hardness": -0.1, "blade_curvature": 1.0, "vignetting": "ANALYTIC", "onion": 0.15},
    ),
)


def _chromatic(key, description, **values):
    """Return a preset whose field maps are those of `FIELD_PRESETS`."""
    label, axial, lateral = FIELD_PRESETS[key]
    maps = {
        "axial_first": axial.f,
        "axial_then": axial.g,
        "lateral_first": lateral.f,
        "lateral_then": lateral.g,
    }
    return Preset(label, description, {"use": True} | maps | values)


CHROMATIC_PRESETS = (
    _chromatic("STANDARD", "The paper's plain model: a simple lens of crown glass"),
    Preset(
        "Subtle",
        "A corrected lens: a thin fringe, which most viewers feel more than see",
        {"use": True, "axial": 0.2, "lateral": 0.05},
    ),
    _chromatic(
        "SHOWCASE",
        "1/(1 - t) for both, the paper's showcase: fringes burst towards the corners",
        lateral=0.2,
    ),
    _chromatic(
        "SPREAD",
        "Axial colour spreads from the middle, lateral grows steeply to the corners",
        lateral=0.5,
    ),
    _chromatic("REVERSED", "Axial colour in the corners, lateral with red and blue changed round"),
    _chromatic(
        "STEEP",
        "Steep axial colour; lateral changes its direction from right to left",
        lateral=0.5,
    ),
    _chromatic(
        "WHEEL", "Axial colour turns with the angle, lateral grows to the corners", lateral=0.5
    ),
    _chromatic(
        "BUTTERFLY",
        "Axial colour as of a lens; lateral changes its direction from right to left",
    ),
    _chromatic("CENTRE", "Lateral colour is strongest in the middle", lateral=0.5),
    _chromatic("RINGS", "Both turn round in a ring halfway to the corners"),
)

ABERRATION_PRESETS = (
    Preset("None", "A thin lens without aberrations", {}),
    Preset(
        "Soft Focus", "Glow round everything bright, creamy behind the focus", {"spherical": 4.0}
    ),
    Preset(
        "Soap Bubbles",
        "Outlined discs behind the focus, as of an overcorrected triplet",
        {"spherical": -1.5},
    ),
    Preset(
        "Swirl",
        "Portrait lens whose blur runs round the middle of the picture",
        {"swirl": 0.6, "field_curvature": 1.5, "astigmatism": 0.5, "spherical": 0.5},
    ),
    Preset(
        "Single Lens",
        "Sharp in the middle alone, all aberrations towards the corners",
        {"spherical": 1.0, "coma": 1.0, "astigmatism": 1.5, "field_curvature": 4.0},
    ),
    Preset("Comets", "Wings towards the corners, as of a fast old lens", {"coma": 3.0}),
)
