"""Shared drawings: the bits of drawing every lens sample at its rounded place of the raster."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.content import (
    InstanceGroup,
    InstanceTable,
    MaterialSnapshot,
    MeshSnapshot,
    next_uid,
)
from addon.snapshot.film import Sampling
from tests.splat_pictures import library_lens
from tests.surface_graphs import emission_graph

from .conftest import make_renderer, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

# Powers of two: whole pixels are then exact in clip space.
WIDTH, HEIGHT = 128, 64
FOCUS = 4.0


def bumpy_sheet(depth, size, count=90):
    """Return a mesh of many triangles round a place on the axis."""
    u, v = np.meshgrid(np.linspace(-1, 1, count), np.linspace(-1, 1, count))
    z = 0.02 * np.sin(9 * u) * np.cos(7 * v)
    positions = np.stack([size * u, size * v, z - depth], axis=-1).reshape(-1, 3)
    i = np.arange(count * count).reshape(count, count)
    a, b, c, d = i[:-1, :-1].ravel(), i[:-1, 1:].ravel(), i[1:, :-1].ravel(), i[1:, 1:].ravel()
    triangles = np.concatenate([np.stack([a, b, d], 1), np.stack([a, d, c], 1)]).astype(np.int32)
    slots = ((0, 0, len(triangles)),)
    return MeshSnapshot(next_uid(), "sheet", positions.astype(np.float32), triangles, slots)


def sheets_snapshot(depths, samples, size=0.5, passes=("Combined",), filter_kind="BLACKMAN_HARRIS"):
    base = triangles_snapshot(
        [], [], WIDTH, HEIGHT, lens=ThinLens(0.05, FOCUS), samples=samples, passes=passes
    )
    meshes = [bumpy_sheet(depth, size) for depth in depths]
    materials = [
        MaterialSnapshot(next_uid(), f"m{i}", emission_graph((0.3 + 0.4 * i, 0.7, 0.2)), 7.0 + i)
        for i in range(len(depths))
    ]
    content = replace(
        base.content,
        meshes={mesh.uid: mesh for mesh in meshes},
        materials={material.uid: material for material in materials},
        instances=InstanceTable(
            np.tile(np.eye(4, dtype=np.float32), (len(depths), 1, 1)),
            np.arange(1.0, len(depths) + 1, dtype=np.float32),
            names=tuple(f"o{i}" for i in range(len(depths))),
        ),
        groups=tuple(
            InstanceGroup(mesh.uid, (material.uid,), i, 1)
            for i, (mesh, material) in enumerate(zip(meshes, materials, strict=True))
        ),
    )
    sampling = Sampling("ADAPTIVE", samples, uses_levels=False, reuse_grid=2)
    film = replace(base.film, filter_kind=filter_kind, filter_size_px=1.5)
    return replace(base, content=content, sampling=sampling, film=film)


def picture(snapshot, plan):
    renderer = make_renderer(snapshot, plan)
    renderer.advance(plan.samples)
    pictures = renderer.read_passes()
    counts, found = renderer.counts, renderer._drawing._shared._members
    renderer.release()
    return pictures, counts, found


def rounded(plan, found):
    """Return the plan with each sample at the place of the drawing it shares."""
    positions, jitter = plan.lens_positions.copy(), plan.jitter.copy()
    for sample, sprites in found.items():
        (sprite,) = sprites.values()
        shift = np.array(sprite.members[sample]) * 2.0 / (plan.width, plan.height)
        positions[sample] = plan.lens_positions[sprite.parent]
        jitter[sample] = plan.jitter[sprite.parent] + shift
    return replace(plan, lens_positions=positions, jitter=jitter, reuse_grid=0)


@pytest.mark.parametrize("passes", [("Combined",), ("Combined", "Focus Matte", "CryptoObject00")])
def test_shared_drawings_are_the_bits_of_samples_at_their_rounded_places(passes):
    snapshot = sheets_snapshot([FOCUS + 0.1], 48, passes=passes)
    plan = plan_frame(snapshot)
    shared, counts, found = picture(snapshot, plan)
    assert len(found) > 0.9 * plan.samples
    assert counts.sprites_drawn < 0.5 * counts.sprites_copied
    assert any(np.any(s.members[i]) for i, each in found.items() for s in each.values())
    drawn, counts_alone, _ = picture(snapshot, rounded(plan, found))
    assert counts_alone.sprites_drawn == 0
    assert counts.triangles < 0.5 * counts_alone.triangles
    for name in passes:
        assert shared[name].tobytes() == drawn[name].tobytes(), name


def test_shared_drawings_hide_each_other_by_depth():
    # The nearer one is smaller, and lies in front of the other in every sample.
    snapshot = sheets_snapshot([FOCUS + 0.2, FOCUS - 0.1], 32, filter_kind="BOX")
    plan = plan_frame(snapshot)
    shared, counts, _ = picture(snapshot, plan)
    assert counts.sprites_copied > 0
    alone, _, _ = picture(snapshot, replace(plan, reuse_grid=0))
    # A sample moves by at most half a cell of half a pixel: only edges differ, and little.
    difference = np.abs(shared["Combined"] - alone["Combined"])
    assert difference.max() < 0.4
    assert difference.mean() < 0.004


def test_nothing_is_shared_far_from_the_focus():
    snapshot = sheets_snapshot([0.4], 32, size=0.08)
    _, counts, found = picture(snapshot, plan_frame(snapshot))
    assert not found
    assert counts.sprites_copied == 0


def test_an_object_at_the_edge_is_shared_without_gaps():
    snapshot = sheets_snapshot([FOCUS], 64, size=4.0)
    plan = plan_frame(snapshot)
    shared, counts, found = picture(snapshot, plan)
    assert counts.sprites_copied > 0
    # The sheet fills the frame: no sample shows the world behind it.
    color = shared["Combined"][..., :3]
    assert np.abs(color - [0.3, 0.7, 0.2]).max() < 1e-5


def test_drawings_are_shared_through_a_real_lens_where_it_moves_them_alike():
    snapshot = sheets_snapshot((4.0, 4.15), 48)
    lens = ThinLens(0.012, FOCUS)
    camera = replace(snapshot.camera, lens=lens, real_lens=library_lens("double-gauss-50mm-f2"))
    plan = plan_frame(replace(snapshot, camera=camera))
    assert plan.real_lens
    shared, counts, found = picture(snapshot, plan)
    alone, whole, _ = picture(snapshot, replace(plan, reuse_grid=0))
    assert counts.sprites_copied > 20 and counts.triangles < 0.7 * whole.triangles
    # No point of what shares a drawing is farther from its own place than a cell is wide.
    edges = np.abs(shared["Combined"] - alone["Combined"])
    assert edges.mean() < 0.002
    assert shared["Combined"].sum() == pytest.approx(alone["Combined"].sum(), rel=1e-3)
