"""A view change is array work: its calls of Python do not grow with the number of instances."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from addon.engine.drawing.scene_buffers import SceneBuffers
from addon.engine.frame.pipeline import FrameRenderer
from addon.engine.planning.plan import plan_frame
from addon.levels.choosing import meshes_with_levels
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.content import InstanceGroup, InstanceTable, MaterialSnapshot, next_uid
from addon.snapshot.film import Sampling
from tests.surface_graphs import emission_graph

from .conftest import triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")


def field_snapshot(count):
    """Triangles at random places all around, with the settings of a 3D view."""
    corners = [(-0.02, 0.0, 0.0), (0.02, 0.0, 0.0), (0.0, 0.03, 0.0)]
    base = triangles_snapshot([corners], [(0.5, 0.4, 0.3)], 96, 64, lens=ThinLens(0.1, 6.0))
    world = np.tile(np.eye(4, dtype=np.float32), (count, 1, 1))
    world[:, :3, 3] = np.random.default_rng(3).uniform(-20.0, 20.0, (count, 3))
    (mesh,) = base.content.meshes
    material = MaterialSnapshot(next_uid(), "paint", emission_graph((0.5, 0.4, 0.3)))
    content = replace(
        base.content,
        materials={material.uid: material},
        instances=InstanceTable(world, np.zeros(count, np.float32)),
        groups=(InstanceGroup(mesh, (material.uid,), 0, count),),
    )
    sampling = Sampling("ADAPTIVE", target_error=0.02, progressive=True)
    return replace(base, content=content, sampling=sampling)


def calls_of_a_view_change(count):
    first = field_snapshot(count)
    buffers = SceneBuffers()
    buffers.update(first.content)
    renderer = FrameRenderer(plan_frame(first), first, buffers, "LATER")
    turned = first.camera.view.copy()
    turned[:3, :3] = np.roll(np.eye(3), 1, axis=0) @ turned[:3, :3]
    moved = replace(first, camera=replace(first.camera, view=turned))
    calls = 0

    def note(_frame, event, _argument):
        nonlocal calls
        calls += event in {"call", "c_call"}

    sys.setprofile(note)
    try:
        plan = plan_frame(moved)
        meshes_with_levels(moved.content, plan)
        renderer.restart(plan, moved, "LATER")
    finally:
        sys.setprofile(None)
    renderer.release()
    return calls


def test_a_view_change_makes_no_calls_for_each_instance():
    few, many = calls_of_a_view_change(2_000), calls_of_a_view_change(20_000)
    # A twentieth: batches of a thousand boxes are looked at one after another.
    assert many - few < 18_000 / 20
