"""Levels of detail: what is kept, what is carried, what follows."""

import numpy as np
import pytest

from addon.levels.making.mesh_levels import replay, simplify
from addon.snapshot.content import MeshSnapshot, next_uid


def mesh_of(positions, triangles, slots=None, **attributes):
    triangles = np.asarray(triangles, np.int32).reshape(-1, 3)
    return MeshSnapshot(
        next_uid(),
        "mesh",
        np.asarray(positions, np.float32).reshape(-1, 3),
        triangles,
        slots or ((0, 0, len(triangles)),),
        {key: np.asarray(value, np.float32) for key, value in attributes.items()},
    )


def grid(count, of_place):
    """A square of count x count cells, mapped by a function of u and v in 0..1."""
    u, v = np.meshgrid(np.linspace(0, 1, count + 1), np.linspace(0, 1, count + 1))
    corner = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    a, b, c, d = (corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1])
    triangles = np.concatenate(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    )
    return of_place(u.ravel(), v.ravel()), triangles, np.stack([u.ravel(), v.ravel()], 1)


def cube_sphere(count=24):
    """A unit sphere of six charts: seams along the cube's edges, one UV island a face."""
    positions, triangles, uvs = [], [], []
    for face in range(6):
        axis, sign = face % 3, 1.0 if face < 3 else -1.0

        def place(u, v, axis=axis, sign=sign):
            p = np.empty((len(u), 3))
            p[:, axis] = sign
            p[:, (axis + 1) % 3] = sign * (2.0 * u - 1.0)
            p[:, (axis + 2) % 3] = 2.0 * v - 1.0
            # Exactly equal on both sides of a seam.
            return np.float32(p / np.linalg.norm(np.sort(np.abs(p)), axis=1, keepdims=True))

        p, t, uv = grid(count, place)
        triangles.append(t + sum(map(len, positions)))
        positions.append(p)
        uvs.append(uv * 0.3 + np.array([face % 3, face // 3]) / 3.0)
    positions, uvs = np.concatenate(positions), np.concatenate(uvs)
    color = np.concatenate([0.5 + 0.5 * positions, np.ones((len(positions), 1))], axis=1)
    return mesh_of(
        positions,
        np.concatenate(triangles),
        **{"normal": positions, "uv:": uvs, "color:": color},
    )


def areas(mesh):
    a, b, c = (mesh.positions[corner].astype(float) for corner in mesh.triangles.T)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2.0


def light(mesh):
    """The mean of the colours over the surface."""
    values = mesh.attributes["color:"][mesh.triangles].mean(axis=1)
    return (areas(mesh)[:, None] * values).sum(axis=0) / areas(mesh).sum()


def assert_sound(level):
    assert np.isfinite(level.positions).all()
    assert all(np.isfinite(values).all() for values in level.attributes.values())
    assert all(len(values) == len(level.positions) for values in level.attributes.values())
    assert level.triangles.dtype == np.int32
    assert level.positions.dtype == np.float32
    used = np.unique(level.triangles)
    assert np.array_equal(used, np.arange(len(level.positions))), "no loose vertices"
    a, b, c = level.triangles.T
    assert ((a != b) & (b != c) & (c != a)).all()
    rows = np.sort(level.triangles, axis=1)
    assert len(np.unique(rows, axis=0)) == len(rows)
    first = 0
    for _, start, count in level.slots:
        assert start == first and count > 0
        first += count
    assert first == len(level.triangles)


def test_each_level_has_about_half_the_triangles_down_to_the_least():
    mesh = cube_sphere()
    levels, _ = simplify(mesh, 200)
    counts = [len(level.triangles) for level in (mesh, *levels)]
    # A collapse takes two triangles or, at a pinch, a few more.
    assert all(0.4 <= b / a <= 0.55 for a, b in zip(counts, counts[1:], strict=False))
    assert 150 <= counts[-1] < 400
    for level in levels:
        assert_sound(level)


def test_a_sphere_keeps_its_area_and_its_light():
    mesh = cube_sphere()
    levels, _ = simplify(mesh, 400)
    for level in levels:
        # An inscribed sphere of 400 triangles lacks 2 %.
        assert areas(level).sum() == pytest.approx(areas(mesh).sum(), rel=0.02)
        assert light(level) == pytest.approx(light(mesh), rel=0.02)


def test_a_small_highlight_keeps_its_light_and_its_place():
    mesh = cube_sphere(40)
    spot = 0.1 + 8.0 * np.exp(-40.0 * (1.0 - mesh.positions @ np.array([0.6, 0.48, 0.64])))
    mesh = mesh_of(
        mesh.positions, mesh.triangles, **{"color:": np.repeat(spot[:, None], 4, axis=1)}
    )
    levels, _ = simplify(mesh, 1000)
    for level in levels:
        # With triangles of half the spot's width, a tenth is what its shape costs.
        assert light(level) == pytest.approx(light(mesh), rel=0.04)
        assert level.attributes["color:"].max() == pytest.approx(spot.max(), rel=0.15)
        assert level.attributes["color:"].min() >= 0.0


@pytest.mark.parametrize("sharpness", [20.0, 200.0, 2000.0])
def test_highlights_of_many_times_white_keep_their_light_on_every_level(sharpness):
    # Beside dark places, where the best fit would be below black.
    mesh = cube_sphere(64)
    toward = np.random.default_rng(2).normal(size=(30, 3))
    toward /= np.linalg.norm(toward, axis=1, keepdims=True)
    spots = np.exp(-sharpness * (1.0 - mesh.positions @ toward.T)).max(axis=1)
    color = np.stack([0.02 + 8.0 * spots, 0.3 + 3.0 * spots, spots, np.ones_like(spots)], axis=1)
    mesh = mesh_of(mesh.positions, mesh.triangles, **{"color:": color})
    levels, _ = simplify(mesh, 300)
    assert len(levels) >= 7
    for level in levels:
        assert light(level)[:3] == pytest.approx(light(mesh)[:3], rel=0.002)
        assert level.attributes["color:"][:, :3].min() >= 0.0
        assert (level.attributes["color:"][:, 3] == 1.0).all(), "what is constant stays so"


def test_light_stays_on_its_side_of_the_surface():
    mesh = cube_sphere(64)
    lit = 0.02 + 4.0 * np.maximum(mesh.positions @ np.array([0.6, 0.48, 0.64]), 0.0) ** 8
    mesh = mesh_of(mesh.positions, mesh.triangles, **{"color:": np.tile(lit[:, None], (1, 4))})

    def along(level):
        a, b, c = (level.positions[corner].astype(float) for corner in level.triangles.T)
        values = level.attributes["color:"][level.triangles, 0].mean(axis=1)
        return (np.cross(b - a, c - a) * values[:, None]).sum(axis=0) / 2.0

    levels, _ = simplify(mesh, 300)
    for level in levels:
        # Where the gain is limited, a little stays on the wrong side.
        assert along(level) == pytest.approx(along(mesh), rel=0.01)


def test_a_mesh_of_several_patches_stays_closed_and_its_rims_get_coarser(monkeypatch):
    monkeypatch.setattr("addon.levels.making.level_collapses._PATCH", 2000)
    mesh = cube_sphere(64)
    levels, _ = simplify(mesh, 300)
    counts = [len(level.triangles) for level in (mesh, *levels)]
    assert all(0.4 <= b / a <= 0.55 for a, b in zip(counts, counts[1:], strict=False))
    for level in levels:
        assert_sound(level)
        _, place = np.unique(level.positions, axis=0, return_inverse=True)
        faces = place.ravel()[level.triangles]
        edges = np.sort(np.concatenate([faces[:, :2], faces[:, 1:], faces[:, ::2]]), axis=1)
        _, uses = np.unique(edges, axis=0, return_counts=True)
        assert (uses == 2).all()
    # A rim that no level merges would keep its small triangles, a tenth of all or more; slivers lie
    # beside seams, onto which places were drawn.
    size = areas(levels[-1])
    assert (size < 0.1 * size.mean()).mean() < 0.06


def test_uvs_of_every_triangle_stay_in_one_chart_across_seams():
    mesh = cube_sphere()
    levels, _ = simplify(mesh, 300)
    for level in levels:
        uv = level.attributes["uv:"]
        chart = np.floor(uv * 3.0 + 1e-4).astype(int)
        inside = uv - chart / 3.0
        assert inside.min() >= -1e-5 and inside.max() <= 0.3 + 1e-5
        of_corner = chart[level.triangles]
        assert (of_corner == of_corner[:, :1]).all()


def test_generated_coordinates_stay_where_they_are_in_the_texture_space():
    sphere = cube_sphere()
    attributes = {"generated": 0.5 + 0.5 * sphere.positions}
    levels, _ = simplify(mesh_of(sphere.positions, sphere.triangles, **attributes), 300)
    assert len(levels) >= 3
    for level in levels:
        inside = 0.5 + 0.5 * level.positions
        # A texture in space shows on a level what it shows there, but for what the surface moved.
        away = np.linalg.norm(level.attributes["generated"] - inside, axis=1)
        edge = np.sqrt(areas(level).mean())
        assert away.mean() < 0.2 * edge and away.max() < edge


def test_a_seam_that_does_not_cut_the_mesh_in_two_stays_a_seam():
    # A tube: its ends of u meet, and are connected the long way round.
    def tube(u, v):
        angle = 2.0 * np.pi * np.where(u == 1.0, 0.0, u)
        return np.stack([np.cos(angle), np.sin(angle), 3.0 * v], axis=1)

    positions, triangles, uv = grid(48, tube)
    levels, _ = simplify(mesh_of(positions, triangles, **{"uv:": uv}), 300)
    assert len(levels) >= 3
    for level in levels:
        corners = level.attributes["uv:"][level.triangles][:, :, 0]
        # A triangle over a merged seam would span the whole texture.
        assert np.ptp(corners, axis=1).max() < 0.3


def test_normals_stay_unit_and_point_outwards():
    levels, _ = simplify(cube_sphere(), 300)
    for level in levels:
        normal = level.attributes["normal"]
        assert np.linalg.norm(normal, axis=1) == pytest.approx(1.0, abs=1e-5)
        outward = level.positions / np.linalg.norm(level.positions, axis=1, keepdims=True)
        assert (normal * outward).sum(axis=1).min() > 0.95


def test_a_sphere_stays_closed():
    # Its places, not its vertices: seams have a vertex on either side.
    levels, _ = simplify(cube_sphere(), 300)
    for level in levels:
        _, place = np.unique(level.positions, axis=0, return_inverse=True)
        faces = place.ravel()[level.triangles]
        edges = np.sort(np.concatenate([faces[:, :2], faces[:, 1:], faces[:, ::2]]), axis=1)
        _, uses = np.unique(edges, axis=0, return_counts=True)
        assert (uses == 2).all()


def test_material_slots_stay_sorted_and_keep_their_share():
    mesh = cube_sphere()
    half = len(mesh.triangles) // 2
    split = mesh_of(mesh.positions, mesh.triangles, ((0, 0, half), (3, half, half)))
    levels, _ = simplify(split, 300)
    for level in levels:
        assert_sound(level)
        assert [slot for slot, _, _ in level.slots] == [0, 3]
        # The halves are alike.
        assert level.slots[0][2] == pytest.approx(len(level.triangles) / 2, rel=0.15)


@pytest.mark.parametrize("count", [19, 40])
def test_materials_that_change_from_face_to_face_keep_their_shares(count):
    # Too many borders to hold: what the levels that there are show of each is what is there.
    positions, triangles, _ = grid(count, lambda u, v: np.stack([u, v, 0.0 * u], 1))
    slot_of = np.tile(np.arange(len(triangles) // 2) % 3, 2)
    numbers = np.bincount(slot_of)
    firsts = np.cumsum(numbers) - numbers
    slots = tuple((k, int(firsts[k]), int(numbers[k])) for k in range(3))
    mesh = mesh_of(positions, triangles[np.argsort(slot_of, kind="stable")], slots)
    expected = [areas(mesh)[first : first + count].sum() for _, first, count in slots]
    assert len(simplify(mesh_of(positions, triangles), 256)[0]) >= 1
    for level in simplify(mesh, 256)[0]:
        found = [areas(level)[first : first + count].sum() for _, first, count in level.slots]
        np.testing.assert_allclose(found, expected, rtol=3.1e-3)


def test_an_open_sheet_keeps_its_outline():
    positions, triangles, uv = grid(40, lambda u, v: np.stack([u, v, 0.02 * np.sin(9 * u)], 1))
    mesh = mesh_of(positions, triangles, **{"uv:": uv})
    levels, _ = simplify(mesh, 200)
    assert len(levels) >= 3
    for level in levels:
        assert_sound(level)
        assert areas(level).sum() == pytest.approx(areas(mesh).sum(), rel=0.03)
        assert np.abs(level.bounds[:, :2] - mesh.bounds[:, :2]).max() < 0.02
        # The texture is the place on the sheet, so it is still that.
        assert np.abs(level.attributes["uv:"] - level.positions[:, :2]).max() < 0.02


def test_a_mesh_full_of_holes_is_simplified_too():
    rng = np.random.default_rng(3)
    mesh = cube_sphere(40)
    kept = rng.random(len(mesh.triangles)) > 0.1
    levels, _ = simplify(mesh_of(mesh.positions, mesh.triangles[kept]), 500)
    assert len(levels) >= 3
    for level in levels:
        assert_sound(level)


def test_flat_shading_keeps_the_facets_normals():
    mesh = cube_sphere()
    corners = mesh.triangles.ravel()
    positions = mesh.positions[corners]
    across = np.cross(positions[1::3] - positions[::3], positions[2::3] - positions[::3])
    normal = np.repeat(across / np.linalg.norm(across, axis=1, keepdims=True), 3, axis=0)
    flat = mesh_of(positions, np.arange(len(corners)), normal=normal)
    levels, _ = simplify(flat, 300)
    assert len(levels) >= 3
    for level in levels:
        assert_sound(level)
        assert len(level.positions) == 3 * len(level.triangles)
        a, b, c = (level.positions[corner].astype(float) for corner in level.triangles.T)
        facet = np.cross(b - a, c - a)
        facet /= np.linalg.norm(facet, axis=1, keepdims=True)
        own = level.attributes["normal"][level.triangles[:, 0]]
        facing = (facet * own).sum(axis=1)
        assert np.abs(facing).min() > 0.999
        # A triangle that collapses turned over keeps the side that its light comes from.
        assert (facing > 0.0).mean() > 0.99


def _broken(mesh):
    """Degenerate, doubled, turned and fanned triangles, loose vertices."""
    t = mesh.triangles
    extra = [t[:50], t[50:80, ::-1], t[80:120][:, [0, 0, 1]], t[120:140][:, [0, 1, 1]]]
    fan = np.stack([t[:40, 0], t[:40, 1], t[200:240, 2]], axis=1)
    positions = np.concatenate([mesh.positions, [[9, 9, 9]] * 3])
    triangles = np.concatenate([t, *extra, fan])
    attributes = {key: np.concatenate([v, v[:3]]) for key, v in mesh.attributes.items()}
    return mesh_of(positions, triangles, **attributes)


def test_broken_triangles_give_sound_levels():
    levels, halvings = simplify(_broken(cube_sphere()), 300)
    assert len(levels) >= 3
    assert len(halvings) == len(levels)
    for level in levels:
        assert_sound(level)
        assert np.abs(level.positions).max() < 1.5, "loose vertices are gone"


@pytest.mark.parametrize("count", [0, 1, 2])
def test_next_to_nothing_has_no_levels(count):
    mesh = mesh_of(np.eye(3), np.array([[0, 1, 2], [0, 2, 1]][:count]))
    assert simplify(mesh, 256) == ((), ())
    for level in simplify(mesh, 1)[0]:
        assert_sound(level)


def test_a_mesh_without_area_ends_at_once():
    mesh = mesh_of(np.zeros((300, 3)), np.arange(300))
    assert simplify(mesh, 10)[0] == ()
    line = np.zeros((300, 3))
    line[:, 0] = np.arange(300)
    assert simplify(mesh_of(line, np.arange(300)), 10)[0] == ()


def test_the_same_mesh_gives_the_same_bits():
    first, second = simplify(cube_sphere(), 300)[0], simplify(cube_sphere(), 300)[0]
    for a, b in zip(first, second, strict=True):
        assert a.positions.tobytes() == b.positions.tobytes()
        assert a.triangles.tobytes() == b.triangles.tobytes()
        for key in a.attributes:
            assert a.attributes[key].tobytes() == b.attributes[key].tobytes()


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_size_does_not_matter(scale):
    mesh = cube_sphere()
    large = mesh_of(mesh.positions * np.float32(scale), mesh.triangles)
    levels, _ = simplify(large, 300)
    assert areas(levels[-1]).sum() == pytest.approx(areas(large).sum(), rel=0.03)


def test_replay_repeats_what_simplify_made():
    mesh = cube_sphere()
    levels, halvings = simplify(mesh, 300)
    for a, b in zip(levels, replay(mesh, halvings), strict=True):
        assert a.uid != b.uid
        assert a.positions.tobytes() == b.positions.tobytes()
        assert a.triangles.tobytes() == b.triangles.tobytes()


def test_replay_follows_a_deformation_with_the_same_triangles():
    mesh = cube_sphere()

    def bend(p):
        p = p.astype(float)
        angle = 0.6 * p[:, 2]
        cos, sin = np.cos(angle), np.sin(angle)
        x, y = cos * p[:, 0] - sin * p[:, 1], sin * p[:, 0] + cos * p[:, 1]
        return np.float32(np.stack([x + 2.0, y, 1.3 * p[:, 2]], 1))

    levels, halvings = simplify(mesh, 300)
    bent = mesh_of(bend(mesh.positions), mesh.triangles, **mesh.attributes)
    for rest, level in zip(levels, replay(bent, halvings), strict=True):
        assert_sound(level)
        assert len(level.triangles) == len(rest.triangles)
        assert np.array_equal(level.triangles, rest.triangles)
        # The coarsest triangles are 0.3 across; they may sag by a fifth of that.
        assert np.abs(level.positions - bend(rest.positions)).max() < 0.06
        assert areas(level).sum() == pytest.approx(areas(bent).sum(), rel=0.03)


def test_check_may_end_the_work():
    def check(done):
        if done:
            raise InterruptedError

    with pytest.raises(InterruptedError):
        simplify(cube_sphere(), 300, check)
