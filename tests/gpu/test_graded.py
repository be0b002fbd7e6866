"""Objects that are partly in focus: coarser where they blur, and the same picture."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.drawing import graded_drawings, group_levels
from addon.engine.drawing.scene_buffers import SceneBuffers
from addon.engine.frame.pipeline import FrameRenderer
from addon.engine.planning.plan import plan_frame
from addon.levels.making.mesh_levels import simplify
from addon.snapshot.film import Sampling

from .test_reuse import FOCUS, bumpy_sheet, sheets_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

DATA = ("Combined", "Depth", "Normal", "CoC", "Detail", "Focus Matte", "CryptoObject00")


@pytest.fixture(scope="module")
def slope():
    """A sheet that leans from before the focus to behind it, and its levels of detail."""
    sheet = bumpy_sheet(0.0, 1.0, 160)
    x, y, z = sheet.positions.astype(float).T
    positions = np.stack([x, 0.6 * y, z - FOCUS - 1.5 * x], axis=1).astype(np.float32)
    mesh = replace(sheet, positions=positions)
    return mesh, simplify(mesh, 200)[0]


def snapshot_of(mesh, samples=16, passes=("Combined",), **sampling):
    base = sheets_snapshot([FOCUS], samples, passes=passes)
    group = replace(base.content.groups[0], mesh=mesh.uid)
    content = replace(base.content, meshes={mesh.uid: mesh}, groups=(group,))
    sampling = Sampling("ADAPTIVE", samples, **{"reuse_grid": 0, **sampling})
    return replace(base, content=content, sampling=sampling)


def renderer_of(snapshot, mesh, levels):
    buffers = SceneBuffers()
    buffers.update(snapshot.content)
    buffers.add_levels(mesh.uid, levels)
    return FrameRenderer(plan_frame(snapshot), snapshot, buffers)


def pictures(snapshot, mesh, levels):
    renderer = renderer_of(snapshot, mesh, levels)
    renderer.advance(renderer.plan.samples)
    found = renderer.read_passes(), renderer.counts
    renderer.release()
    return found


@pytest.fixture
def plain(monkeypatch):
    """Draw without grading from here on."""
    return lambda: monkeypatch.setattr(group_levels, "LEAST_GRADED_TRIANGLES", np.inf)


@pytest.mark.parametrize("reuse_grid", [0, 2])
def test_the_picture_is_that_of_full_detail_with_fewer_triangles(slope, plain, reuse_grid):
    snapshot = snapshot_of(slope[0], passes=DATA, reuse_grid=reuse_grid)
    graded, work = pictures(snapshot, *slope)
    plain()
    expected, full = pictures(snapshot, *slope)
    assert work.triangles < 0.6 * full.triangles
    assert full.triangles_full_detail == work.triangles_full_detail
    for name in ("Combined", "CryptoObject00", "Focus Matte"):
        # The surface is one colour: what differs are a few pixels of its outline and of its
        # blur's estimate, each by some of 16 samples.
        assert np.abs(graded[name] - expected[name]).mean() < 0.004, name
    # The data passes show full detail, whatever the samples are drawn with.
    for name in ("Depth", "Normal", "CoC"):
        assert graded[name].tobytes() == expected[name].tobytes(), name
    assert (graded["Detail"][..., 0] == 0.0).all()


def test_what_is_in_focus_is_the_same_bit_by_bit(slope, plain):
    snapshot = snapshot_of(slope[0])
    graded, _ = pictures(snapshot, *slope)
    plain()
    expected, _ = pictures(snapshot, *slope)
    middle = slice(60, 68)
    assert graded["Combined"][:, middle].tobytes() == expected["Combined"][:, middle].tobytes()


def test_no_hole_opens_inside(slope):
    graded, _ = pictures(snapshot_of(slope[0], 32), *slope)
    # Well inside, no sample sees the world.
    inside = graded["Combined"][26:38, 48:80, :3]
    assert np.abs(inside - (0.3, 0.7, 0.2)).max() < 1e-5


def test_a_frame_that_may_be_given_up_begins_at_full_detail(slope):
    snapshot = snapshot_of(slope[0], 16, progressive=True)
    renderer = renderer_of(snapshot, *slope)
    count = len(slope[0].triangles)
    seen = []
    for _ in range(16):
        before = renderer.counts.triangles
        renderer.advance(1)
        seen.append(renderer.counts.triangles - before)
    first = graded_drawings._LEAST_SAMPLES_BEFORE
    assert seen[:first] == [count] * first
    assert seen[-1] < 0.6 * count
    # The same view again: what was made is kept, and the picture is put together as before.
    renderer.restart(renderer.plan, snapshot)
    renderer.advance(16)
    assert renderer.counts.triangles == sum(seen)
    kept = renderer.geometry_bytes()
    # Moved along the picture, every vertex stays as far away and what was made is kept. Moved on,
    # all is made anew when the view has stood for a while. Neither shows in the first samples.
    for step, held in (((0.1, 0.0, 0.0), kept), ((0.0, 0.0, 0.1), None)):
        view = snapshot.camera.view.copy()
        view[:3, 3] += step
        moved = replace(snapshot, camera=replace(snapshot.camera, view=view))
        renderer.restart(plan_frame(moved), moved)
        renderer.advance(1)
        assert renderer.counts.triangles == count
        assert renderer.geometry_bytes() == held if held else renderer.geometry_bytes() < kept
    renderer.release()


def test_without_levels_or_lens_or_gain_full_detail_is_drawn(slope, monkeypatch):
    mesh, levels = slope
    count = 16 * len(mesh.triangles)
    assert pictures(snapshot_of(mesh, uses_levels=False), mesh, levels)[1].triangles == count
    assert pictures(snapshot_of(mesh), mesh, ())[1].triangles == count
    sharp = snapshot_of(mesh)
    sharp = replace(sharp, camera=replace(sharp.camera, lens=None))
    assert pictures(sharp, mesh, levels)[1].triangles == count
    # On a graphics device the triangles of 16 samples cost less than making a mesh.
    monkeypatch.setattr(graded_drawings.context, "is_software", lambda: False)
    assert pictures(snapshot_of(mesh), mesh, levels)[1].triangles == count
