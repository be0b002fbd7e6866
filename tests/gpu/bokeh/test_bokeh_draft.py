"""A view that moves has a draft of the bokeh; one at rest has the final render's."""

from dataclasses import replace

import numpy as np
import pytest

from addon.engine.planning.plan import plan_frame
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import BokehSettings
from tests.splat_pictures import library_lens

from ..conftest import make_renderer, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT = 96, 64
STEPS = 8


def many_lamps(count=60, seed=4):
    rng = np.random.default_rng(seed)
    # No side lies along the rows or columns of the raster of all of them.
    angles = rng.uniform(0.0, 2 * np.pi, (count, 1)) + np.arange(3) * 2 * np.pi / 3
    around = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=2)
    place = rng.uniform(-1.0, 1.0, (count, 1, 3)) * (3.0, 2.0, 1.0) - (0.0, 0.0, 9.0)
    turn = rng.uniform(0.5, 1.0, (count, 1, 1))
    corners = place + 0.2 * turn * around
    snapshot = triangles_snapshot(
        corners, rng.uniform(5.0, 30.0, (count, 3)), WIDTH, HEIGHT, ThinLens(0.3, 3.0, Iris()), 4
    )
    return replace(
        snapshot,
        camera=replace(snapshot.camera, bokeh=BokehSettings()),
        sampling=replace(snapshot.sampling, reference_bokeh=True),
        passes=("Combined", "Bokeh"),
    )


def moved(snapshot, distance):
    view = snapshot.camera.view.copy()
    view[0, 3] += distance
    return replace(snapshot, camera=replace(snapshot.camera, view=view))


def begin(renderer, snapshot):
    renderer.restart(plan_frame(snapshot), snapshot, bokeh="DRAFT")


@pytest.fixture(scope="module")
def snapshot():
    return many_lamps()


@pytest.fixture
def renderer(snapshot):
    renderer = make_renderer(snapshot)
    # However quick the device is.
    renderer._bokeh.seconds = np.inf
    begin(renderer, snapshot)
    yield renderer
    renderer.release()


def bokeh_of(renderer):
    return renderer.read_passes(("Bokeh",))["Bokeh"]


def refine(renderer):
    for _ in range(STEPS):
        renderer.refine_bokeh()
    assert not renderer.bokeh_drafted


def test_the_draft_has_the_light_of_the_whole_from_fewer_sources(renderer):
    renderer.advance(1)
    assert renderer.bokeh_drafted
    draft, sources = bokeh_of(renderer)[..., :3], renderer.highlights.clustered
    refine(renderer)
    whole = bokeh_of(renderer)[..., :3]
    assert sources < 0.5 * renderer.highlights.clustered
    # Half as many sub-pixels meet each lamp.
    assert draft.sum() == pytest.approx(whole.sum(), rel=0.05)
    assert np.abs(draft - whole).sum() < 0.25 * whole.sum()


def test_at_rest_the_picture_is_the_one_without_a_draft(renderer, snapshot):
    renderer.advance(2)
    refine(renderer)
    renderer.advance(2)
    assert renderer.finished()
    plain = make_renderer(snapshot)
    plain.advance(4)
    assert renderer.read_image().tobytes() == plain.read_image().tobytes()
    assert vars(renderer.highlights) == vars(plain.highlights)
    plain.release()


def test_the_draft_is_shown_until_the_last_step(renderer):
    renderer.advance(4)
    assert not renderer.finished()
    draft = bokeh_of(renderer).tobytes()
    renderer.refine_bokeh()
    assert renderer.bokeh_drafted
    assert bokeh_of(renderer).tobytes() == draft


def test_a_movement_in_between_begins_anew(renderer, snapshot):
    renderer.advance(1)
    renderer.refine_bokeh()
    other = moved(snapshot, 0.4)
    begin(renderer, other)
    renderer.advance(4)
    refine(renderer)
    plain = make_renderer(other)
    plain.advance(4)
    assert renderer.read_image().tobytes() == plain.read_image().tobytes()
    plain.release()


def test_a_bokeh_of_later_leaves_the_samples_alone_till_it_is_made(renderer, snapshot):
    renderer.restart(plan_frame(snapshot), snapshot, bokeh="LATER")
    renderer.advance(4)
    assert renderer.sampled and not renderer.finished()
    assert renderer.highlights.found == 0
    refine(renderer)
    plain = make_renderer(snapshot)
    plain.advance(4)
    assert renderer.read_image().tobytes() == plain.read_image().tobytes()
    plain.release()


def test_a_quick_bokeh_has_no_draft(renderer, snapshot):
    renderer._bokeh.seconds = 0.001
    begin(renderer, snapshot)
    assert not renderer.bokeh_drafted
    renderer.advance(4)
    assert renderer.finished()


def test_a_lens_that_cannot_focus_so_near_is_told_and_a_thin_one_draws(renderer, snapshot):
    # The same blur from a focus nearer than the focal length of the lens.
    near = replace(snapshot.camera, lens=ThinLens(0.003, 0.03, Iris()))
    lens = library_lens("double-gauss-50mm-f2")
    pictures, reports = [], []
    for camera in (near, replace(near, real_lens=lens)):
        begin(renderer, replace(snapshot, camera=camera))
        renderer.advance(1)
        reports.append(renderer.report)
        refine(renderer)
        pictures.append(bokeh_of(renderer))
        reports.append(renderer.report)
    assert pictures[0].any() and np.array_equal(*pictures)
    assert reports[:2] == [(), ()]
    assert all("double" in problem.lower() for (problem,) in reports[2:])
