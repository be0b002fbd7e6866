"""A GPU context, and snapshots made by hand: no Blender scene is needed to test a pass."""

import numpy as np
import pytest

from addon.engine.drawing.scene_buffers import SceneBuffers
from addon.engine.frame.pipeline import FrameRenderer
from addon.engine.planning.plan import plan_frame
from addon.errors import DeviceUnavailableError
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import Camera
from addon.snapshot.content import (
    InstanceGroup,
    InstanceTable,
    MaterialSnapshot,
    MeshSnapshot,
    SceneContent,
    World,
    next_uid,
)
from addon.snapshot.film import Film, Sampling
from addon.snapshot.scene import SceneSnapshot
from tests.surface_graphs import emission_graph

WORLD_COLOR = (0.125, 0.25, 0.5)


@pytest.fixture(scope="session")
def gpu_context(aplanat_bpy):
    """A graphics context; skips where there is none."""
    from addon.device import context

    try:
        context.ensure_context()
    except DeviceUnavailableError as error:
        pytest.skip(str(error))


def perspective(width, height, slope=0.5, near=0.1, far=100.0):
    """Return an OpenGL projection whose half width at distance 1 is `slope`."""
    matrix = np.zeros((4, 4))
    matrix[0, 0] = 1.0 / slope
    matrix[1, 1] = width / height / slope
    matrix[2, 2] = -(far + near) / (far - near)
    matrix[2, 3] = -2.0 * far * near / (far - near)
    matrix[3, 2] = -1.0
    return matrix


def orthographic(width, height, half_width=2.0, near=0.1, far=100.0):
    """Return an OpenGL parallel projection."""
    matrix = np.eye(4)
    matrix[0, 0] = 1.0 / half_width
    matrix[1, 1] = width / height / half_width
    matrix[2, 2] = -2.0 / (far - near)
    matrix[2, 3] = -(far + near) / (far - near)
    return matrix


def triangles_snapshot(
    corners,
    colors,
    width=48,
    height=32,
    lens=None,
    samples=4,
    passes=("Combined",),
    region=None,
    parallel=False,
    transparent=False,
    view=None,
):
    """Return a snapshot of triangles, each an object of its own with an emission of its own."""
    meshes, materials, groups, names = {}, {}, [], []
    for i, (triangle, color) in enumerate(zip(corners, colors, strict=True)):
        mesh = MeshSnapshot(
            next_uid(),
            f"triangle {i}",
            np.asarray(triangle, np.float32),
            np.array([[0, 1, 2]], np.int32),
            ((0, 0, 1),),
        )
        # Ids that are easy to tell apart.
        material = MaterialSnapshot(
            next_uid(), f"m{i}", emission_graph(color), cryptomatte_id=100.0 + i
        )
        meshes[mesh.uid] = mesh
        materials[material.uid] = material
        groups.append(InstanceGroup(mesh.uid, (material.uid,), i, 1))
        names.append(f"o{i}")
    count = len(names)
    instances = InstanceTable(
        world=np.tile(np.eye(4, dtype=np.float32), (count, 1, 1)),
        cryptomatte_id=np.arange(1, count + 1, dtype=np.float32),
        names=tuple(names),
    )
    projection = (orthographic if parallel else perspective)(width, height)
    return SceneSnapshot(
        content=SceneContent(
            meshes=meshes,
            images={},
            materials=materials,
            instances=instances,
            groups=tuple(groups),
            world=World(WORLD_COLOR),
        ),
        camera=Camera(np.eye(4) if view is None else view, projection, lens, parallel),
        film=Film(
            width, height, region or (0, 0, width, height), transparent, "BOX", filter_size_px=1.0
        ),
        sampling=Sampling("REFERENCE", samples, 0),
        passes=passes,
    )


def make_renderer(snapshot, plan=None):
    """Return a `FrameRenderer` ready to advance."""
    buffers = SceneBuffers()
    buffers.update(snapshot.content)
    return FrameRenderer(plan or plan_frame(snapshot), snapshot, buffers)


def render_snapshot(snapshot, plan=None):
    """Return the passes of a snapshot, rendered with all its samples."""
    renderer = make_renderer(snapshot, plan)
    renderer.advance(renderer.plan.samples)
    pictures = renderer.read_passes()
    renderer.release()
    return pictures


def some_triangles(seed=3, count=7):
    """Return random triangles between 1.5 and 7 m in front of the camera, and their colours."""
    rng = np.random.default_rng(seed)
    depth = rng.uniform(1.5, 7.0, (count, 1, 1))
    corners = rng.uniform(-1.0, 1.0, (count, 3, 3))
    corners[..., 2] *= 0.4
    corners[..., :2] *= 0.45 * depth
    corners[..., 2:] -= depth
    return corners, rng.uniform(0.0, 1.0, (count, 3))


LENS = ThinLens(0.15, 3.0, Iris(5, 0.3, 1.4))
