"""Discs of highlights in colours, against the reference method, which knows no discs."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.bokeh_colors import plan_colors
from addon.engine.plan import plan_frame
from addon.sampling.chromatic import ChromaticAberration
from addon.sampling.field_maps import FieldMap
from addon.sampling.highlights import highlight_share
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.scene.snapshot import BokehSettings, ImageSnapshot, Sampling, World, next_uid
from tests.pictures import save_side_by_side, ssim

from .conftest import WORLD_COLOR, make_renderer, render_snapshot, triangles_snapshot
from .test_bokeh import LAMPS, LENS, LIGHTS, PASSES, energy, lamp, with_bokeh
from .test_chromatic import STRONG, black, with_chromatic

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT = 120, 80
# Multiples of the samples that share a place, and of the grid of wavelengths in a group.
MANY = 3 * 11 * 512
WHITE, BRIGHT = (20.0, 20.0, 20.0), (60.0, 60.0, 60.0)
# The largest blur is that of blue; red is in focus at 3 m.
EVERYWHERE = FieldMap("CURVE", curve_f=(0.0, 0.0))
SCENES = {
    # A lamp off the axis, behind the focus of all wavelengths.
    "behind": ([lamp(-1.5, 0.8, 8.0, 0.3)], [WHITE]),
    # In front of the focus of red, behind that of blue.
    "between": ([lamp(0.28, -0.2, 2.2, 0.1)], [WHITE]),
    "before": ([lamp(0.1, 0.12, 0.9, 0.02)], [BRIGHT]),
    "several": (LAMPS, LIGHTS),
}


def aberration(mode="SPECTRAL", axial=0.4, lateral=0.1, **others):
    return ChromaticAberration(mode, axial, lateral, STRONG, 0.05, **others)


def scene(name, chromatic, samples=96, lens=LENS, **options):
    corners, lights = SCENES[name]
    snapshot = triangles_snapshot(corners, lights, WIDTH, HEIGHT, lens, samples, **options)
    return with_chromatic(snapshot, chromatic)


def background(snapshot):
    return np.array(WORLD_COLOR) * snapshot.film.width * snapshot.film.height


def compare(snapshot, folder):
    """Compare splatted pictures with that of many samples; returns what the last one is."""
    many = replace(snapshot, sampling=Sampling("REFERENCE", MANY))
    expected = render_snapshot(many)["Combined"].astype(np.float64)
    for method in ("REFERENCE", "ADAPTIVE"):
        few = with_bokeh(snapshot)
        few = replace(few, sampling=replace(few.sampling, method=method))
        picture = render_snapshot(few)["Combined"].astype(np.float64)
        path = folder / f"{method}.png"
        save_side_by_side(path, picture[::-1], expected[::-1])
        assert ssim(picture, expected) >= 0.98, path
        # Lamps of 3 pixels, met by sub-pixels of a quarter and less: within a per cent.
        light = energy(expected) - background(snapshot)
        found = energy(picture) - background(snapshot)
        assert found / light == pytest.approx([1.0] * 3, abs=0.01), path


@pytest.mark.parametrize("mode", ["RGB", "SPECTRAL"])
@pytest.mark.parametrize("name", list(SCENES))
def test_discs_in_colors_are_what_the_reference_method_converges_to(name, mode, tmp_path):
    compare(scene(name, aberration(mode)), tmp_path)
