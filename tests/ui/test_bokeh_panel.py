"""The Bokeh panel: counts in words, pictures of discs, the legend of its debug view."""

import numpy as np
import pytest

from addon.engine.bokeh.marks import FATE_COLORS
from addon.lens_bokeh.look.appearance import Appearance
from addon.lens_bokeh.look.grain import Grain
from addon.lens_bokeh.look.vignetting_model import cat_eye
from addon.lens_bokeh.openings.blades import BladedIris
from addon.passes.bokeh.marks import FATES
from addon.ui.panels import bokeh_panel
from addon.ui.panels.bokeh_panel import counts_as_lines
from addon.ui.previews.bokeh_previews import disc_pictures
from addon.ui.properties.bokeh_properties import APPEARANCE_NAMES

COUNTS = dict.fromkeys(
    ("found", "clustered", "culled_size", "culled_occlusion", "culled_cone", "masked", "splatted"),
    0,
)


@pytest.fixture
def bokeh(camera):
    return camera.aplanat.bokeh


def test_counts_are_told_in_words():
    assert counts_as_lines(COUNTS) == ["No highlights in the last picture"]
    lines = counts_as_lines(
        COUNTS
        | {"found": 12000, "culled_size": 2000, "clustered": 1000, "culled_occlusion": 300}
        | {"masked": 150, "splatted": 700}
    )
    assert lines == [
        "12,000 highlights found, 700 discs drawn",
        "10,000 merged into 1,000",
        "2,000 sharp, 300 out of sight, 150 partly hidden",
    ]


def test_pictures_of_discs_show_hardness_on_its_side_of_the_focus():
    look = Appearance(edge=0.9)
    front, behind, corner = disc_pictures(look, (0.3, 0.2))
    middle = slice(40, 56)

    def rim_over_middle(picture):
        line = picture[48, :, 0]
        return line[4:14].max() / line[middle].mean()

    assert rim_over_middle(behind) > 1.2
    assert rim_over_middle(front) < 0.8
    assert np.array_equal(behind, corner)


def test_pictures_of_discs_are_dark_around_and_mirrored_in_front():
    front, behind, _ = disc_pictures(Appearance(iris=BladedIris(3)), (0.3, 0.2))
    assert behind[0, 0, 0] < 0.05 < behind[48, 48, 0]
    # Texels on the rim of a triangle are shared in another way from the other side.
    assert np.abs(front - behind[::-1, ::-1])[..., 0].mean() < 0.01
    assert np.abs(front - behind)[..., 0].mean() > 0.05


def test_cats_eyes_are_seen_in_the_corner_only_and_lose_light():
    _, behind, corner = disc_pictures(Appearance(rims=cat_eye(0.8, 0.5)), (0.4, 0.3))
    assert corner[..., 0].sum() < 0.8 * behind[..., 0].sum()
    # What is left is as bright as before.
    assert corner[48, 48, 0] == pytest.approx(behind[48, 48, 0], rel=0.02)


def test_grain_and_a_wide_iris_fit_into_the_picture():
    wide = Appearance(grain=Grain(0.3, dust=5), anamorphic_ratio=0.5)
    for picture in disc_pictures(wide, (0.3, 0.2)):
        assert np.isfinite(picture).all() and picture.max() <= 1.0
        assert picture[:, 0, 0].max() < 0.05
        assert picture[:10].max(axis=(0, 1))[0] < 0.05


def test_the_legend_of_the_debug_view_has_every_colour_of_its_marks(aplanat_bpy):
    assert set(bokeh_panel.LEGEND) == set(FATE_COLORS) == set(FATES)
    label = aplanat_bpy.types.UILayout.bl_rna.functions["label"]
    icons = label.parameters["icon"].enum_items.keys()
    assert all(icon in icons for _, icon in bokeh_panel.LEGEND.values())


def test_the_debug_view_is_off_and_no_part_of_a_preset(bokeh):
    assert bokeh.debug_view == "NONE"
    assert "debug_view" not in APPEARANCE_NAMES
