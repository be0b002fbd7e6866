"""Merging of highlights against its numpy twin, and its laws: energy, order, stability."""

from dataclasses import replace

import numpy as np
import pytest

from addon.device.uniforms import uniform_buffer
from addon.engine.bokeh import clusters as bokeh_clusters
from addon.engine.frame.pipeline import FrameRenderer
from addon.passes.bokeh import clusters
from addon.passes.bokeh.clusters import Similarity
from addon.passes.bokeh.highlights import COLUMNS
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import BokehSettings
from benchmarks.reference import clusters as twin

from ..conftest import make_renderer, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

# Focus at 3 m, 40 px of scale: discs of 5 to 10 px radius between 5 and 12 m.
LENS = (3.0, 0.0, 40.0, 0.0)
PARALLEL = (3.0, 1.0, 4.0, 0.0)
PIXEL = 1.0 / 240.0
LIBERAL = Similarity(4, 0.25, 1.5, 1.0)


def view_turned(angle=0.3):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s, 0.2], [0, 1, 0, -0.1], [-s, 0, c, 0.4], [0, 0, 0, 1.0]])


def some_sources(count, seed=4, bulbs=40):
    """Return sources in bulbs of a few pixels, energies over five decades, some of a region."""
    rng = np.random.default_rng(seed)
    depth = rng.uniform(5.0, 12.0, bulbs)
    centers = np.column_stack([rng.uniform(-0.5, 0.5, (bulbs, 2)) * depth[:, None], depth])
    at = rng.integers(0, bulbs, count)
    places = centers[at] + rng.normal(0.0, 0.015, (count, 3))
    sources = np.column_stack([places, rng.uniform(0.25, 1.0, count)])
    colors = rng.uniform(0.1, 1.0, (count, 3)) * 10.0 ** rng.uniform(-2.0, 3.0, (count, 1))
    return sources.astype(np.float32), np.column_stack([colors, at % 2]).astype(np.float32)


def upload(values):
    import gpu

    rows = -(-len(values) // COLUMNS)
    texels = np.zeros((rows * COLUMNS, 4), np.float32)
    texels[: len(values)] = values
    buffer = gpu.types.Buffer("FLOAT", texels.size, texels.ravel())
    return gpu.types.GPUTexture((COLUMNS, rows), format="RGBA32F", data=buffer)


def merged(sources, energies, similarity=LIBERAL, view=None, lens=LENS):
    view = np.eye(4) if view is None else view
    parameters = uniform_buffer(clusters.cluster_params(similarity, view, lens, PIXEL))
    textures = (upload(sources), upload(energies))
    lists, count, unpaired = clusters.cluster(textures, len(sources), parameters, similarity)
    assert unpaired == 0
    found = [np.asarray(lists[name].read(), np.float32).reshape(-1, 4)[:count] for name in "ab"]
    lists.release()
    return found


@pytest.mark.parametrize("lens", [LENS, PARALLEL])
@pytest.mark.parametrize("length", [1.0, 16.0])
def test_clusters_are_those_of_the_twin(lens, length):
    sources, energies = some_sources(1500)
    view = view_turned()
    similarity = replace(LIBERAL, length=length)
    a, b = merged(sources, energies, similarity, view, lens)
    expected_a, expected_b = twin.cluster(sources, energies, similarity, view, lens, PIXEL)
    assert 0.02 < len(a) / len(sources) < 0.5
    assert len(a) == len(expected_a)
    # Rounding to float32 of places some metres away, and of means over spans of millimetres.
    np.testing.assert_allclose(a[:, :3], expected_a[:, :3], rtol=2e-5, atol=2e-5)
    np.testing.assert_allclose(a[:, 3], expected_a[:, 3], rtol=2e-3, atol=2e-3)
    np.testing.assert_allclose(b, expected_b, rtol=2e-6)


@pytest.mark.parametrize("count", [2, 3000, 40000])
def test_no_energy_is_lost(count):
    sources, energies = some_sources(count)
    _, b = merged(sources, energies)
    for region in (0, 1):
        before = energies[energies[:, 3] == region, :3].astype(float).sum(axis=0)
        after = b[b[:, 3] == region, :3].astype(float).sum(axis=0)
        # A rounding to float32 for every cluster and pass, of either sign.
        np.testing.assert_allclose(after, before, rtol=1e-6)


def test_very_bright_sources_take_nothing_from_faint_ones():
    sources, energies = some_sources(64, bulbs=1)
    energies[:] = (1e-3, 1e-3, 1e-3, 0.0)
    energies[0, :3] = 1e5
    everything = Similarity(4, 8.0, 1e9, 1e30)
    _, b = merged(sources, energies, everything)
    assert len(b) == 1
    np.testing.assert_allclose(b[0, :3], energies[:, :3].astype(float).sum(axis=0), rtol=1e-6)


def test_threads_in_any_order_give_the_same_bits():
    sources, energies = some_sources(20000)
    first = merged(sources, energies)
    for _ in range(3):
        again = merged(sources, energies)
        assert all(np.array_equal(x, y) for x, y in zip(first, again, strict=True))


def test_sources_in_another_order_give_the_same_clusters():
    sources, energies = some_sources(2000)
    order = np.random.default_rng(0).permutation(len(sources))
    a, b = (x[np.lexsort(x.T)] for x in merged(sources, energies))
    c, d = (x[np.lexsort(x.T)] for x in merged(sources[order], energies[order]))
    # The list's order is another; sums of whole numbers are not.
    np.testing.assert_array_equal(a, c)
    np.testing.assert_array_equal(b, d)


def test_a_moving_camera_finds_the_same_clusters():
    sources, energies = some_sources(1500)
    world = np.column_stack([sources[:, :2], -sources[:, 2], np.ones(len(sources))])
    counts, places = [], []
    for step in range(8):
        view = view_turned(0.002 * step)
        eye = world @ view.T
        moved = np.column_stack([eye[:, :2], -eye[:, 2], sources[:, 3]])
        a, _ = merged(moved, energies, view=view)
        counts.append(len(a))
        own = np.column_stack([a[:, :2], -a[:, 2], np.ones(len(a))]) @ np.linalg.inv(view).T
        places.append(own[:, :3])
    assert max(counts) - min(counts) <= 0.05 * counts[0]
    # Most clusters stay where they are in the world to a tenth of a millimetre.
    for own in places[1:]:
        nearest = np.linalg.norm(own[:, None] - places[0][None], axis=2).min(axis=1)
        assert np.mean(nearest < 1e-4) > 0.85


def test_regions_of_the_lens_stay_apart():
    sources, energies = some_sources(500, bulbs=1)
    energies[:, 3] = np.arange(500) % 3
    _, b = merged(sources, energies, Similarity(4, 8.0, 1e9, 1e30))
    assert sorted(b[:, 3]) == [0.0, 1.0, 2.0]


def test_bright_discs_stay_apart_where_faint_ones_merge():
    sources = np.array([[0.0, 0.0, 8.0, 1.0], [0.06, 0.0, 8.0, 1.0]], np.float32)
    faint = np.tile(np.float32([1.0, 1.0, 1.0, 0.0]), (2, 1))
    assert len(merged(sources, faint)[0]) == 1
    assert len(merged(sources, faint * np.float32([1e4, 1e4, 1e4, 1.0]))[0]) == 2


def test_pairs_merge_what_cells_part():
    sources, energies = some_sources(1500)
    energies[:, :3] *= 1e-3
    cells, few, many = (
        merged(sources, energies, Similarity(1, 0.25, 1.5, 1.0, pairs)) for pairs in (0, 1, 6)
    )
    assert len(many[0]) < len(few[0]) < len(cells[0])
    before = energies[:, :3].astype(float).sum(axis=0)
    np.testing.assert_allclose(many[1][:, :3].astype(float).sum(axis=0), before, rtol=1e-6)


def stage_bokeh(size=1.0, beam=3.0, **settings):
    """Return the bokeh of three lamps behind a beam, and what became of the highlights."""
    shape = np.array([(0.0, 0.06, -8.0), (-0.05, -0.03, -8.0), (0.05, -0.03, -8.0)])
    shape[:, :2] *= size
    corners = [shape + (x, 0.1, 0.0) for x in (-1.1, 0.1, 1.4)]
    corners.append([(-0.1, -1.0, -beam), (0.1, -1.0, -beam), (0.0, 1.0, -beam)])
    colors = [(40, 30, 20), (20, 40, 40), (50, 20, 20), (0.02, 0.02, 0.02)]
    lens = ThinLens(0.1, 3.0, Iris())
    snapshot = triangles_snapshot(corners, colors, 160, 96, lens, 16, passes=("Bokeh",))
    camera = replace(snapshot.camera, bokeh=BokehSettings(**settings))
    sampling = replace(snapshot.sampling, reference_bokeh=True)
    renderer = make_renderer(replace(snapshot, camera=camera, sampling=sampling))
    renderer.advance(1)
    picture = renderer.read_passes()["Bokeh"][..., :3].astype(float)
    counts = renderer.highlights
    renderer.release()
    return picture, counts


def stage_report(**settings):
    """Return what the renderer has to say about the same scene."""
    told = []
    release = FrameRenderer.release

    def listening(renderer):
        told.append(renderer.report)
        release(renderer)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(FrameRenderer, "release", listening)
        stage_bokeh(**settings)
    return told[-1]


def test_the_clustered_model_shows_nearly_the_same_with_fewer_sources():
    point, found = stage_bokeh()
    clustered, counts = stage_bokeh(model="CLUSTERED")
    assert found.clustered == counts.found - counts.culled_size
    assert counts.clustered < 0.3 * found.clustered
    assert counts.masked > 0
    # What the beam hides of a lamp of two pixels differs by a part of its shadow's edge.
    np.testing.assert_allclose(clustered.sum(axis=(0, 1)), point.sum(axis=(0, 1)), rtol=0.01)
    error = np.sqrt(((clustered - point) ** 2).mean() / (point**2).mean())
    assert error < 0.1


def test_beyond_the_budget_automatic_merges_without_visible_change_and_points_never(monkeypatch):
    point, before = stage_bokeh()
    monkeypatch.setattr(bokeh_clusters, "POINT_BUDGET", 4)
    thrifty, after = stage_bokeh()
    assert after.clustered < before.clustered
    exact, all_of_them = stage_bokeh(model="POINT")
    assert all_of_them.clustered == before.clustered
    assert np.array_equal(exact, point)
    error = np.sqrt(((thrifty - point) ** 2).mean() / (point**2).mean())
    assert error < 0.01


def test_merging_all_says_where_there_are_too_many_to_compare(monkeypatch):
    monkeypatch.setattr(clusters, "MOST_PAIRED", 2)
    report = stage_report(model="CLUSTERED", global_merge=True, similarity=0.1)
    (line,) = report
    assert "more than the 2 that Merge All compares" in line
    monkeypatch.setattr(clusters, "MOST_PAIRED", 8192)
    assert stage_report(model="CLUSTERED", global_merge=True, similarity=0.1) == ()


def test_rays_cast_in_the_splat_soften_shadows_of_clusters_as_masks_do():
    """Of lamps of 8 px, behind a beam in front of the focus."""
    scene = {"size": 4.0, "beam": 2.0}
    point, _ = stage_bokeh(visibility="RASTER", **scene)
    masked, counts = stage_bokeh(visibility="RASTER", model="CLUSTERED", **scene)
    cast, _ = stage_bokeh(visibility="SPLAT", model="CLUSTERED", **scene)
    assert counts.masked > 0

    def error(picture):
        return np.sqrt(((picture - point) ** 2).mean() / (point**2).mean())

    # Rays from the middles of the clusters alone are off by 1.32 times as much as masks.
    assert error(cast) < 1.15 * error(masked)
