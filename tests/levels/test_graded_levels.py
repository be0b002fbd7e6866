"""Parts of a mesh at different levels of detail: nothing opens, nothing in focus changes."""

from dataclasses import replace

import numpy as np
import pytest

from addon.levels.making.graded_levels import MergeTree
from addon.levels.making.level_surface import weld
from addon.levels.making.mesh_levels import replay, simplify

from .test_level_invariants import mean, needles
from .test_mesh_levels import areas, assert_sound, cube_sphere, mesh_of


@pytest.fixture(scope="module")
def sphere():
    """A closed sphere of six charts with seams between them, and its levels."""
    mesh = cube_sphere(40)
    return mesh, simplify(mesh, 200)[0]


def mean_area(mesh):
    return areas(mesh).sum() / len(mesh.triangles)


def wedge(mesh, direction, sharp_until=-0.2, strength=300.0):
    """Blur that grows from a plane on, in square units; none on its other side."""
    height = mesh.positions.astype(float) @ (np.array(direction) / np.linalg.norm(direction))
    return mean_area(mesh) * strength * np.maximum(height - sharp_until, 0.0) ** 2


def borders(mesh):
    """Edges that only one triangle has, by place."""
    faces = weld(mesh.positions)[mesh.triangles].astype(np.int64)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    return int((count == 1).sum())


def test_a_closed_mesh_stays_closed_under_any_gradient_of_blur(sphere):
    mesh, levels = sphere
    assert borders(mesh) == 0
    tree = MergeTree(mesh, levels)
    rng = np.random.default_rng(5)
    counts = []
    for _ in range(24):
        blur = wedge(mesh, rng.normal(size=3), rng.uniform(-1, 0.5), 10.0 ** rng.uniform(0, 5))
        graded = tree.grade(blur)
        assert borders(graded) == 0
        assert_sound(graded)
        counts.append(len(graded.triangles))
    assert min(counts) < 0.2 * len(mesh.triangles) < 0.9 * max(counts)


def test_blur_without_any_order_opens_nothing_either(sphere):
    mesh, levels = sphere
    rng = np.random.default_rng(6)
    places = weld(mesh.positions)
    for scale in (3.0, 30.0, 1000.0):
        blur = (mean_area(mesh) * scale * rng.random(places.max() + 1))[places]
        assert borders(MergeTree(mesh, levels).grade(blur)) == 0


def test_what_is_in_focus_is_exactly_as_it_was(sphere):
    mesh, levels = sphere
    blur = wedge(mesh, (1.0, 0.5, 0.2))
    graded = MergeTree(mesh, levels).grade(blur)
    assert len(graded.triangles) < 0.7 * len(mesh.triangles)

    def rows(of, triangles):
        columns = [of.positions, *of.attributes.values()]
        corners = np.concatenate(columns, axis=1)[triangles].reshape(len(triangles), -1)
        return {row.tobytes() for row in corners}

    sharp = mesh.triangles[(blur[mesh.triangles] == 0.0).all(axis=1)]
    assert len(sharp) > 0.2 * len(mesh.triangles)
    assert rows(mesh, sharp) <= rows(graded, graded.triangles)


def test_no_blur_leaves_the_mesh_and_much_blur_the_last_level(sphere):
    mesh, levels = sphere
    tree = MergeTree(mesh, levels)
    same = tree.grade(np.zeros(len(mesh.positions)))
    assert np.array_equal(same.positions[same.triangles], mesh.positions[mesh.triangles])
    assert same.slots == mesh.slots
    last = tree.grade(np.full(len(mesh.positions), 1e9))
    # A few vertices may have nothing left at their place: they stay where they last were.
    assert len(last.triangles) == pytest.approx(len(levels[-1].triangles), rel=0.02)


def test_attributes_are_those_of_the_levels(sphere):
    mesh, levels = sphere
    graded = MergeTree(mesh, levels).grade(wedge(mesh, (0.0, 0.0, 1.0)))
    known = set()
    for level in (mesh, *levels):
        columns = [level.positions, *level.attributes.values()]
        known |= {row.tobytes() for row in np.concatenate(columns, axis=1)}
    columns = [graded.positions, *graded.attributes.values()]
    assert {row.tobytes() for row in np.concatenate(columns, axis=1)} <= known
    assert list(graded.attributes) == list(mesh.attributes)
    # Every chart keeps its own part of the texture: no triangle reaches from one to the next.
    cell = np.floor(graded.attributes["uv:"] * 3.0 + 0.02)
    assert (cell[graded.triangles] == cell[graded.triangles][:, :1]).all()


def test_material_slots_keep_their_order_and_their_surface(sphere):
    mesh, levels = sphere
    half = len(mesh.triangles) // 2
    split = replace(mesh, slots=((0, 0, half), (3, half, len(mesh.triangles) - half)))
    levels, _ = simplify(split, 200)
    graded = MergeTree(split, levels).grade(wedge(mesh, (0.0, 1.0, 0.0)))
    assert [slot for slot, _, _ in graded.slots] == [0, 3]
    for (_, first, count), (_, start, number) in zip(graded.slots, split.slots, strict=True):
        old = areas(split)[start : start + number].sum()
        assert areas(graded)[first : first + count].sum() == pytest.approx(old, rel=0.02)


def test_triangles_stay_smaller_than_the_blur(sphere):
    mesh, levels = sphere
    bare = replace(mesh, attributes={})
    blur = wedge(mesh, (0.3, 0.1, 1.0), strength=100.0)
    graded = MergeTree(bare, levels_without(levels)).grade(blur)
    direction = np.array((0.3, 0.1, 1.0)) / np.linalg.norm((0.3, 0.1, 1.0))
    height = graded.positions[graded.triangles].mean(axis=1) @ direction
    allowed = mean_area(mesh) * 100.0 * np.maximum(height + 0.2, 0.0) ** 2
    coarse = areas(graded) > 2.0 * mean_area(mesh)
    assert coarse.sum() > 50
    # The mean round a place is held, single triangles may be twice as large.
    assert (areas(graded)[coarse] <= 2.5 * allowed[coarse]).mean() > 0.98


def levels_without(levels):
    return tuple(replace(level, attributes={}) for level in levels)


def test_sharp_edges_of_colour_need_more_blur_than_smooth_colours(sphere):
    mesh, _ = sphere
    left = {}
    for name, shade in (
        ("smooth", 0.5 + 0.5 * mesh.positions[:, :1]),
        ("sharp", (np.sin(9.0 * mesh.positions[:, :1]) > 0.0).astype(float)),
    ):
        color = np.repeat(np.append(shade, shade, axis=1), 2, axis=1)
        painted = mesh_of(mesh.positions, mesh.triangles, **{"color:": color})
        tree = MergeTree(painted, simplify(painted, 200)[0])
        left[name] = len(tree.grade(np.full(len(color), 40.0 * mean_area(mesh))).triangles)
    # A ball facetted by an eighth of its triangles has moved by as much as shows.
    assert left["smooth"] < 0.15 * len(mesh.triangles)
    assert left["sharp"] > 2.0 * left["smooth"]


def test_the_estimate_is_near_what_is_left(sphere):
    mesh, levels = sphere
    tree = MergeTree(mesh, levels)
    for direction in np.eye(3):
        blur = wedge(mesh, direction)
        left = len(tree.grade(blur).triangles) / len(mesh.triangles)
        # It counts halvings of vertices, where triangles vanish between levels, too.
        assert tree.share(blur[tree.probes]) == pytest.approx(left, abs=0.08)


def test_levels_of_a_bent_mesh_are_graded_by_the_same_collapses(sphere):
    mesh, _ = sphere
    _, halvings = simplify(mesh, 200)
    p = mesh.positions.astype(float)
    bent = np.stack([p[:, 0], p[:, 1] + 0.4 * p[:, 0] ** 2, p[:, 2]], axis=1)
    bent = replace(mesh, positions=bent.astype(np.float32))
    graded = MergeTree(bent, replay(bent, halvings)).grade(wedge(bent, (0.0, 0.0, 1.0)))
    assert borders(graded) == 0
    assert len(graded.triangles) < 0.8 * len(mesh.triangles)
    assert areas(graded).sum() == pytest.approx(areas(bent).sum(), rel=0.02)


def test_loose_and_broken_triangles_do_no_harm():
    mesh = cube_sphere()
    t = mesh.triangles
    extra = [t[:50], t[50:80, ::-1], t[80:120][:, [0, 0, 1]], t[120:140][:, [0, 1, 1]]]
    positions = np.concatenate([mesh.positions, [[9, 9, 9]] * 3])
    attributes = {key: np.concatenate([v, v[:3]]) for key, v in mesh.attributes.items()}
    broken = mesh_of(positions, np.concatenate([t, *extra]), **attributes)
    levels, _ = simplify(broken, 300)
    graded = MergeTree(broken, levels).grade(wedge(broken, (1.0, 0.0, 0.0)))
    assert np.isfinite(graded.positions).all()
    assert graded.triangles.max() == len(graded.positions) - 1
    assert len(graded.triangles) < 0.8 * len(broken.triangles)


def test_needles_that_go_two_by_two_keep_their_area_where_parts_are_graded():
    mesh = needles(3000)
    tree = MergeTree(mesh, simplify(mesh, 500)[0])
    counts = []
    for blur in (0.0, 1.0, 2.0, 4.0, 1e3):
        graded = tree.grade(np.full(len(mesh.positions), blur))
        assert areas(graded).sum() == pytest.approx(areas(mesh).sum(), rel=1e-4)
        assert mean(graded, "color:") == pytest.approx(mean(mesh, "color:"), rel=1e-3)
        counts.append(len(graded.triangles))
    assert counts[0] == len(mesh.triangles)
    assert counts[-1] < 0.2 * counts[0]
