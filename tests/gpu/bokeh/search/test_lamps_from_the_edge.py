"""Lamps that the middle of the lens sees from the edge have the light that the rest sees."""

from dataclasses import replace

import numpy as np
import pytest

from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.content import InstanceGroup, InstanceTable, MeshSnapshot, next_uid

from ...conftest import WORLD_COLOR, render_snapshot, triangles_snapshot
from ..bokeh_scenes import HEIGHT, WIDTH, energy, with_bokeh

pytestmark = pytest.mark.usefixtures("gpu_context")

BLACK = np.array(WORLD_COLOR) * WIDTH * HEIGHT
LIGHT = (20.0, 10.0, 5.0)


def _boxes(places, sides, lens, samples, parallel=False):
    """Return a snapshot of lamps: boxes with their middles at some places."""
    nothing = ([np.zeros((3, 3))], [LIGHT])
    made = triangles_snapshot(*nothing, WIDTH, HEIGHT, lens, samples, parallel=parallel)
    corners = np.array(np.meshgrid((-0.5, 0.5), (-0.5, 0.5), (-0.5, 0.5), indexing="ij"))
    corners = corners.reshape(3, 8).T * sides
    faces = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    mesh = MeshSnapshot(
        next_uid(),
        "box",
        corners.astype(np.float32),
        np.array(triangles, np.int32),
        ((0, 0, len(triangles)),),
    )
    material = next(iter(made.content.materials))
    world = np.tile(np.eye(4, dtype=np.float32), (len(places), 1, 1))
    world[:, :3, 3] = places
    names = tuple(f"box {i}" for i in range(len(places)))
    table = InstanceTable(world, np.arange(1.0, len(places) + 1.0, dtype=np.float32), names)
    content = replace(
        made.content,
        meshes={mesh.uid: mesh},
        groups=(InstanceGroup(mesh.uid, (material,), 0, len(places)),),
        instances=table,
    )
    return replace(made, content=content)


@pytest.mark.parametrize("parallel", [False, True])
def test_a_card_in_the_plane_of_the_axis_has_its_light(parallel):
    lens = ThinLens(0.25, 3.0, Iris())
    card = [((0.0, 0.1, -9.0),), (0.0, 2.0, 4.0), lens]
    samples = render_snapshot(_boxes(*card, 256, parallel))["Combined"]
    found = render_snapshot(with_bokeh(_boxes(*card, 256, parallel)))["Combined"]
    expected = energy(samples) - BLACK
    assert expected.min() > 50.0
    # Searched from the middle alone nothing was found, and left out of the samples: all was lost.
    np.testing.assert_allclose(energy(found) - BLACK, expected, rtol=0.01)


@pytest.mark.parametrize("parallel", [False, True])
def test_a_box_on_the_axis_has_the_light_of_its_sides(parallel):
    # The lens' middle sees the front alone, a tenth less than the lens.
    lens = ThinLens(0.25, 3.0, Iris())
    side = 0.4 if parallel else 0.8
    box = [((0.0, 0.0, -8.0),), (side, side, side), lens]
    many = render_snapshot(_boxes(*box, 1024, parallel))["Combined"]
    pictures = render_snapshot(with_bokeh(_boxes(*box, 64, parallel)))
    assert energy(pictures["Bokeh"]).min() > 100.0
    found = energy(pictures["Combined"]) - BLACK
    np.testing.assert_allclose(found, energy(many) - BLACK, rtol=0.01)
