"""Passes that tell the blur of a real lens: against its traced tables."""

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from benchmarks.benches.frames import BenchScene
from benchmarks.scenes.capture_scene import add_plane
from tests.render.test_adaptive import FOCUS, passes, render, scene

__all__ = ["scene"]

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")


@pytest.fixture
def wall(scene, aplanat_bpy):
    """A wall in focus that fills the left half of the picture, through a strongly curved field."""
    for thing in list(scene.objects):
        if thing.type == "MESH":
            aplanat_bpy.data.objects.remove(thing)
    scene.render.resolution_x, scene.render.resolution_y = 96, 54
    data = scene.camera.data
    data.clip_start = 0.01
    data.dof.focus_distance, data.dof.aperture_fstop = 0.1 * FOCUS, 1.4
    data.dof.aperture_blades = 0
    data.aplanat.lens, data.aplanat.bokeh.use = "petzval-51mm-f1.4", False
    size = 2.0
    add_plane(aplanat_bpy, "Wall", (-0.5 * size, 0.1 * FOCUS, 0.0), size, np.pi / 2)
    layer = scene.view_layers[0]
    layer.use_pass_z = layer.aplanat.use_pass_coc = layer.aplanat.use_pass_focus_matte = True
    return scene


def test_circles_of_confusion_are_those_of_the_traced_lens(wall):
    found = passes(render(wall, "REFERENCE", 16))
    read = BenchScene(wall)
    plan = plan_frame(read.sampled("REFERENCE", 16))
    read.close()
    tables = plan.real_lens.tables
    grid = plan.real_lens.grid
    y, x = np.mgrid[0:54, 0:96] + 0.5
    place = grid.low + np.stack([x / 96, y / 54], axis=-1) * (grid.high - grid.low)
    index, weights = tables.moves_grid.taps(place)
    blur = np.einsum("yxt,yxtk->yxk", weights, tables.blur.reshape(-1, 4)[index])
    # Rows of `found` go downwards.
    found = {name: picture[::-1] for name, picture in found.items()}
    depth = found["Depth"][..., 0]
    behind = depth > 1e9
    assert behind[:, 50:].all() and not behind[:, :46].any()
    vergence = np.where(behind, 0.0, 1.0 / depth)
    focus = tables.focus_vergence
    powers = (vergence / tables.largest_vergence)[..., None] ** np.arange(4)
    added = (powers * blur).sum(axis=-1) * plan.coc_scale / tables.aperture_radius
    wanted = plan.coc_scale * (focus - vergence) + added
    coc = found["CoC"][..., 0]
    # The wall's field is that of its middle ray, a little beside the pixel.
    assert coc == pytest.approx(wanted, abs=0.02)
    # Spherical aberration is a blur in the middle, too; the field is curved.
    assert abs(coc[2, 2]) > 2.0 * abs(coc[27, 44]) > 0.1
    matte = found["Focus Matte"][..., 0]
    assert matte[26:28, 40:44].mean() > matte[:3, :3].mean() + 0.05


def test_focus_mattes_of_layers_are_those_of_the_reference(wall):
    # Of the wall in focus without its edge.
    part = np.s_[2:-2, 2:30]
    reference = passes(render(wall, "REFERENCE", 16))["Focus Matte"][::-1, :, 0][part]
    layered = passes(render(wall, "LAYERED", 16))
    found = layered["Focus Matte"][::-1, :, 0][part]
    # The field is curved: a thin lens has the same matte everywhere.
    assert np.ptp(reference) > 0.2
    # Through few places on the lens, others in each pixel: a pixel's sides have other blurs.
    assert np.abs(found - reference).mean() < 0.01
    assert found == pytest.approx(reference, abs=0.1)
    # There is a pixel that none of its places sees through the cut opening.
    assert layered["Combined"][..., 3].min() > 0.999
