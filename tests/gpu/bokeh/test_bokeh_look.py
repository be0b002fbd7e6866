"""Discs of highlights with every appearance: their energy, and their shape against numpy."""

import numpy as np
import pytest

from addon.lens_bokeh.look.appearance import Appearance, Diffraction
from addon.lens_bokeh.look.grain import Grain
from addon.lens_bokeh.look.onion import OnionRings
from addon.lens_bokeh.look.sprite import sprite
from addon.lens_bokeh.look.vignetting_model import cat_eye
from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_bokeh.openings.pictures import PictureIris
from tests.splat_pictures import depth_of, library_lens, plan_of, splatted

pytestmark = pytest.mark.usefixtures("gpu_context")

HALF = PictureIris(np.outer(np.ones(8), [1, 1, 1, 1, 0.2, 0.2, 0.2, 0.2]))
LOOKS = {
    "bubble": {"appearance": Appearance(edge=1.0)},
    "cream": {"appearance": Appearance(edge=-1.0, iris=BladedIris(5, 0.2, 0.3))},
    "picture": {"appearance": Appearance(iris=HALF, edge=0.5)},
    "grain": {"appearance": Appearance(grain=Grain(strength=0.3))},
    "onion": {"appearance": Appearance(onion=OnionRings(contrast=0.5))},
    "ringing": {
        "appearance": Appearance(
            diffraction=Diffraction(1.0, (450.0, 600.0), ((0.2, 0.8, 1.0), (0.8, 0.2, 0.0)))
        )
    },
    "cat": {"appearance": Appearance(rims=cat_eye(0.9, 0.35)), "vignetting": "ANALYTIC"},
    "soft cat": {
        "appearance": Appearance(BladedIris(6), rims=cat_eye(0.9, 0.35, 6), edge=0.6),
        "vignetting": "ANALYTIC",
    },
}
LENS = "double-gauss-50mm-f2"


def energy(picture):
    return picture[..., :3].astype(np.float64).sum(axis=(0, 1))


def mean_energy(plan, coc, **options):
    """Energy of a disc of few pixels, averaged over its place on their grid."""
    steps = (np.mgrid[0:2, 0:2].reshape(2, -1).T + 0.25) / 2 if abs(coc) < 39.0 else [(0.0, 0.0)]
    window = np.asarray(options.get("chief", (0.0, 0.0))) * plan.focal_px
    depth = depth_of(plan, coc)
    return np.mean(
        [energy(splatted(plan, depth, window=window + s, **options)) for s in steps], axis=0
    )


@pytest.mark.parametrize("coc", [-40.0, 8.0, 40.0])
@pytest.mark.parametrize("name", LOOKS)
def test_every_look_keeps_the_light(name, coc):
    plan = plan_of(size=120, focal_px=400.0, radius=0.6, **LOOKS[name])
    chief = (0.05, 0.07) if "cat" in name else (0.0, 0.0)
    assert mean_energy(plan, coc, chief=chief) == pytest.approx([1.0] * 3, abs=1e-3)


@pytest.mark.parametrize("name", [*LOOKS, "profile", "pupil"])
def test_the_smallest_discs_keep_the_light_wherever_they_lie_among_pixels(name):
    look = LOOKS.get(name) or {"lens": library_lens(LENS)}
    if name == "pupil":
        look["vignetting"] = "LENS"
    plan = plan_of(size=40, focal_px=2000.0, **look)
    chief = (0.05, 0.07) if "cat" in name or name == "pupil" else (0.0, 0.0)
    for coc, place in ((1.2, (0.0, 0.0)), (-2.1, (0.5, 0.5)), (4.0, (0.3, 0.1))):
        window = np.asarray(chief) * plan.focal_px + place
        found = energy(splatted(plan, depth_of(plan, coc), chief=chief, window=window))
        assert found == pytest.approx([1.0] * 3, abs=1e-3), coc


@pytest.mark.parametrize("coc", [-30.0, 30.0])
@pytest.mark.parametrize("edge", [1.0, -0.6])
def test_the_edge_control_matches_the_sprite_and_turns_round_in_front_of_the_focus(edge, coc):
    appearance = Appearance(BladedIris(3, 0.0, 0.2), edge=edge)
    plan = plan_of(appearance, size=64, radius=0.6)
    drawn = splatted(plan, depth_of(plan, coc))[..., :1]
    extent = 32.0 / abs(coc)
    wanted = sprite(appearance, 64, upright=coc > 0.0, extent=extent)
    # The sprite has no pixel filter: compare means over 4 x 4 pixels.
    drawn, wanted = (p.reshape(16, 4, 16, 4).mean(axis=(1, 3)) for p in (drawn, wanted))
    assert np.abs(drawn - wanted).max() < 0.08 * wanted.max()
    assert np.abs(drawn - wanted).mean() < 0.012 * wanted.max()
    turned = wanted[::-1, ::-1]
    assert np.abs(drawn - turned).mean() > 2.0 * np.abs(drawn - wanted).mean()


@pytest.mark.parametrize("strength", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("depth", [1.2, 1.8, 2.4, 1e6])
def test_the_profile_of_a_lens_keeps_the_light(depth, strength):
    plan = plan_of(size=300, focal_px=6000.0, lens=library_lens(LENS), profile_strength=strength)
    coc = plan.coc_scale * (1.0 / plan.focus_distance - 1.0 / depth)
    assert mean_energy(plan, coc) == pytest.approx([1.0] * 3, abs=2e-3)


@pytest.mark.parametrize("chief", [(0.0, 0.0), (0.1, 0.1), (-0.02, 0.25)])
@pytest.mark.parametrize("blades", [0, 6])
def test_the_pupil_of_a_lens_keeps_the_light(chief, blades):
    appearance = Appearance(BladedIris(blades))
    plan = plan_of(
        appearance, size=500, focal_px=6000.0, lens=library_lens(LENS), vignetting="LENS"
    )
    for depth in (1.0, 1e6):
        coc = plan.coc_scale * (1.0 / plan.focus_distance - 1.0 / depth)
        picture = mean_energy(plan, coc, chief=chief)
        # What blades leave is tabulated for single tiles; between fields, the place in the stop is
        # that of the mixture. Measured up to 0.8 %.
        assert picture == pytest.approx([1.0] * 3, abs=1e-2 if blades else 3e-3)


def test_a_cat_eye_is_cut_along_the_azimuth_as_the_sprite_is():
    appearance = Appearance(rims=cat_eye(0.9, 0.35))
    plan = plan_of(appearance, size=64, radius=0.6, vignetting="ANALYTIC")
    chief = (0.2, 0.1)
    drawn = splatted(plan, depth_of(plan, 30.0), chief=chief)[..., :1]
    wanted = sprite(appearance, 64, chief=chief, extent=32.0 / 30.0)
    drawn, wanted = (p.reshape(16, 4, 16, 4).mean(axis=(1, 3)) for p in (drawn, wanted))
    assert np.abs(drawn - wanted).max() < 0.05 * wanted.max()
