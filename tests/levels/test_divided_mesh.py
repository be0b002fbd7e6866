"""Dividing large triangles: the same surface, in small parts, without gaps."""

import numpy as np

from addon.levels.making.divided_mesh import divided_mesh
from addon.snapshot.content import MeshSnapshot

BOUNDS = (np.array([-0.4, -0.3]), np.array([0.4, 0.3]))


def quad(motion=None):
    places = np.array([(-4.0, -4.0, 0.0), (4.0, -4.0, 0.0), (4.0, 4.0, 0.0), (-4.0, 4.0, 0.0)])
    places = places.astype(np.float32)
    triangles = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
    own = {"uv:": places[:, :2] / 8.0 + 0.5}
    return MeshSnapshot(1, "quad", places, triangles, ((0, 0, 1), (2, 1, 1)), own, motion)


def view(tilt=0.0):
    """Ten metres before the camera, tilted about the x axis."""
    cos, sin = np.cos(tilt), np.sin(tilt)
    matrix = np.eye(4)
    matrix[1:3, 1:3] = [[cos, -sin], [sin, cos]]
    matrix[2, 3] = -10.0
    return matrix


def area(mesh, slot=None):
    corners = mesh.positions[mesh.triangles].astype(float)
    areas = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return 0.5 * areas.sum() if slot is None else 0.5 * areas[slot[1] : slot[1] + slot[2]].sum()


def test_what_is_seen_is_divided_into_the_same_surface():
    mesh = quad(motion=(quad().positions + 1.0, quad().positions - 1.0))
    found = divided_mesh(mesh, view(0.6), 0.05, BOUNDS, 0.1)
    assert len(found.triangles) > 100
    assert np.isclose(area(found), area(mesh), rtol=1e-6)
    for slot in found.slots:
        assert np.isclose(area(found, slot), 32.0, rtol=1e-6)
    # Attributes are those of the places.
    assert np.allclose(found.attributes["uv:"], found.positions[:, :2] / 8.0 + 0.5, atol=1e-6)
    assert np.allclose(found.motion[0], found.positions + 1.0, atol=1e-6)
    # Without gaps: inside, each edge belongs to two triangles.
    sides = np.sort(found.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    pairs, uses = np.unique(sides, axis=0, return_counts=True)
    alone = found.positions[pairs[uses == 1]]
    assert uses.max() == 2
    assert (np.isclose(np.abs(alone[..., :2]), 4.0).any(axis=-1)).all()


def test_edges_are_no_longer_than_wanted():
    found = divided_mesh(quad(), view(), 0.05, BOUNDS, 0.1)
    corners = found.positions[found.triangles][..., :2] / 10.0
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1)
    inside = (np.abs(corners) < [0.4, 0.3]).all(axis=(1, 2))
    assert inside.any()
    assert sides[inside].max() < 0.0501


def test_small_or_hidden_triangles_stay():
    mesh = quad()
    assert divided_mesh(mesh, view(), 2.0, BOUNDS, 0.1) is mesh
    behind = view()
    behind[2, 3] = 10.0
    assert divided_mesh(mesh, behind, 0.05, BOUNDS, 0.1) is mesh


def test_a_plane_through_the_camera_ends_at_the_limit():
    floor = view(np.pi / 2.0)
    floor[:3, 3] = (0.0, -0.5, 0.0)
    found = divided_mesh(quad(), floor, 0.05, BOUNDS, 0.1, most=5000)
    assert 100 < len(found.triangles) < 20_000
