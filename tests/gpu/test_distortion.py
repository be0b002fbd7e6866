"""Distorted pictures: places, passes, and the same picture as a finer one that is distorted."""

from dataclasses import replace

import numpy as np
import pytest

from addon.device.readback import read_color
from addon.device.targets import Targets, TargetSpec
from addon.optics.distortion import distorted, undistorted
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import BokehSettings
from addon.snapshot.content import World
from benchmarks.reference.distortion import cubic_sample, distorted_picture
from tests.pictures import ssim

from .conftest import make_renderer, render_snapshot, some_triangles, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT = 180, 120
MIDDLE, CORNER = np.array([90.0, 60.0]), np.hypot(90.0, 60.0)
PASSES = ("Combined", "Defocus", "Bokeh")


def bent(snapshot, k, **settings):
    camera = replace(snapshot.camera, distortion=terms_of(k), bokeh=BokehSettings(**settings))
    return replace(snapshot, camera=camera)


def terms_of(k):
    return k if isinstance(k, tuple) else (k,)


def expected_place(place, k):
    return MIDDLE + CORNER * distorted((place - MIDDLE) / CORNER, terms_of(k))


def dots_at(places, size=0.5, depth=4.0):
    """Corners of triangles whose centroids lie at places of the picture without distortion."""
    pixel = depth / 180.0
    centres = np.concatenate([(places - MIDDLE) * pixel, np.full((len(places), 1), -depth)], 1)
    turn = np.radians([90.0, 210.0, 330.0])
    around = np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=1)
    return centres[:, None] + size * 2.0 * pixel * around


def grid(k, across=7, up=5):
    """Places without distortion that lie inside of the distorted picture."""
    x, y = np.meshgrid(np.linspace(8, WIDTH - 8, across), np.linspace(8, HEIGHT - 8, up))
    seen = np.stack([x, y], axis=-1).reshape(-1, 2)
    return seen, MIDDLE + CORNER * undistorted((seen - MIDDLE) / CORNER, terms_of(k))


def centroid(picture, around, reach=6):
    x, y = np.floor(around).astype(int)
    left, bottom = max(x - reach, 0), max(y - reach, 0)
    part = picture[bottom : y + reach + 1, left : x + reach + 1, 0].astype(float)
    rows, columns = np.mgrid[: part.shape[0], : part.shape[1]] + 0.5
    return np.array([(part * columns).sum(), (part * rows).sum()]) / part.sum() + (left, bottom)


@pytest.mark.parametrize("k", [-0.1, 0.1])
@pytest.mark.parametrize("region", [None, (40, 30, 120, 70)])
def test_a_grid_of_dots_lands_where_the_model_says(k, region):
    seen, places = grid(k)
    corners = dots_at(places)
    snapshot = triangles_snapshot(corners, np.ones((len(corners), 3)), WIDTH, HEIGHT, None, 1024)
    snapshot = replace(snapshot, content=replace(snapshot.content, world=World((0.0, 0.0, 0.0))))
    # Blender's filter, and samples that lay out a dot to a fiftieth of a pixel.
    film = replace(snapshot.film, filter_kind="BLACKMAN_HARRIS", filter_size_px=1.5)
    snapshot = replace(snapshot, film=replace(film, region=region or film.region))
    picture = render_snapshot(bent(snapshot, k))["Combined"]
    low, size = np.array(region or (0, 0, WIDTH, HEIGHT)).reshape(2, 2)
    found = 0
    for place, straight in zip(seen, places, strict=True):
        assert np.allclose(expected_place(straight, k), place)
        here = place - low
        if (here > 7).all() and (here < size - 7).all():
            assert np.hypot(*(centroid(picture, here) - here)) < 0.1
            found += 1
    assert found >= 8


def many_triangles(width, height, samples, lens=None):
    corners, colors = some_triangles(seed=8, count=60)
    return triangles_snapshot(1.4 * corners, colors, width, height, lens, samples)


@pytest.mark.parametrize("k", [-0.3, -0.1, 0.1, 0.25])
def test_the_picture_is_that_of_a_finer_one_that_is_distorted(k):
    # The view of the finer one reaches farther, for the barrel.
    times, wider = 3, 1.6
    lens = ThinLens(0.03, 3.0, Iris())
    snapshot = many_triangles(WIDTH, HEIGHT, 64, lens)
    drawn = render_snapshot(bent(snapshot, k))["Combined"]
    fine = many_triangles(round(wider * times * WIDTH), round(wider * times * HEIGHT), 64, lens)
    projection = fine.camera.projection.copy()
    projection[:2] /= wider
    fine = replace(fine, camera=replace(fine.camera, projection=projection))
    fine = render_snapshot(fine)["Combined"].astype(float)
    # 4 x 4 places in each pixel make its box.
    x, y = ((np.arange(4 * n) + 0.5) / 4.0 for n in (WIDTH, HEIGHT))
    places = np.stack(np.meshgrid(x, y), axis=-1)
    sources = undistorted((places - MIDDLE) / CORNER, terms_of(k)) * CORNER * times
    found = cubic_sample(fine, sources + 0.5 * np.array(fine.shape[1::-1]))
    wanted = found.reshape(HEIGHT, 4, WIDTH, 4, 4).mean(axis=(1, 3))
    assert ssim(drawn, wanted) > 0.98
    # Against half a pixel's shift, which the bar would not notice.
    assert np.abs(drawn - wanted).mean() < 0.5 * np.abs(drawn[:, 1:] - wanted[:, :-1]).mean()


@pytest.mark.parametrize("k", [-0.3, 0.2, (-0.2, 0.1, -0.06, 0.02)])
def test_the_device_samples_as_the_twin(k):
    snapshot = many_triangles(WIDTH, HEIGHT, 4)
    renderer = make_renderer(bent(snapshot, k))
    renderer.advance(4)
    found = renderer.read_image()
    plan = renderer.plan
    total = read_color(renderer._targets.framebuffer("sum"), plan.width, plan.height)
    renderer.release()
    wanted = distorted_picture(total.astype(float) / plan.weight(4), plan.distortion)
    # Places are 32-bit numbers of up to 400: good to 3e-5 px.
    assert np.abs(found - wanted).max() < 2e-4
    # What is opaque stays so.
    assert (found[..., 3] == 1.0).all()


def lamps(k, **settings):
    places = np.array([[40.0, 30.0], [150.0, 100.0], [90.0, 60.0]])
    straight = MIDDLE + CORNER * undistorted((places - MIDDLE) / CORNER, terms_of(k))
    corners = dots_at(straight, 1.0, depth=12.0)
    snapshot = triangles_snapshot(
        corners, np.full((3, 3), 400.0), WIDTH, HEIGHT, ThinLens(0.25, 4.0, Iris()), 16
    )
    snapshot = replace(
        snapshot,
        sampling=replace(snapshot.sampling, reference_bokeh=True),
        passes=PASSES,
    )
    return places, bent(snapshot, k, **settings)


@pytest.mark.parametrize("k", [-0.1, 0.1])
def test_splats_stand_where_their_points_are_after_distortion(k):
    places, snapshot = lamps(k)
    found = render_snapshot(snapshot)
    for place in places:
        # The disc itself is bent, too: its centroid moves by less than this.
        assert np.hypot(*(centroid(found["Bokeh"], place, 16) - place)) < 0.5
    total = found["Defocus"] + found["Bokeh"]
    assert total.tobytes() == found["Combined"].tobytes()
    assert found["Bokeh"].min() >= 0.0 and found["Bokeh"].max() > 0.5


def test_the_window_shows_the_picture():
    _, snapshot = lamps(-0.2)
    renderer = make_renderer(snapshot)
    renderer.advance(16)
    picture = renderer.read_image()
    with Targets(2 * WIDTH + 3, 2 * HEIGHT + 5, [TargetSpec("image", "RGBA32F")]) as targets:
        framebuffer = targets.framebuffer("image")
        with framebuffer.bind():
            renderer.resolve((3, 5), 2)
        found = read_color(framebuffer, targets.width, targets.height)[5:, 3:]
    renderer.release()
    assert np.allclose(found, np.repeat(np.repeat(picture, 2, 0), 2, 1), rtol=1e-6, atol=1e-6)


def test_ids_and_geometry_are_not_mixed():
    names = ("Depth", "CoC", "Normal", "CryptoObject00")
    snapshot = replace(many_triangles(WIDTH, HEIGHT, 1), passes=names)
    straight, found = render_snapshot(snapshot), render_snapshot(bent(snapshot, -0.1))
    ids = set(np.unique(straight["CryptoObject00"][..., 0])) | {0.0}
    assert set(np.unique(found["CryptoObject00"][..., 0])) <= ids | set(range(1, 61))
    lengths = np.linalg.norm(found["Normal"], axis=-1)
    assert np.allclose(lengths[lengths > 0], 1.0, atol=1e-5)
    # In the middle nothing is distorted.
    middle = np.s_[HEIGHT // 2 - 2 : HEIGHT // 2 + 2, WIDTH // 2 - 2 : WIDTH // 2 + 2]
    for name in names:
        assert np.allclose(found[name][middle], straight[name][middle], rtol=1e-3, atol=1e-3)
    assert found["Depth"].shape == (HEIGHT, WIDTH, 1)


@pytest.mark.parametrize("k", [-0.1, 0.1])
def test_movement_is_that_of_the_distorted_picture(k):
    snapshot = replace(triangles_snapshot(*some_triangles(), WIDTH, HEIGHT), passes=("Vector",))
    plane = np.array([[[-30.0, -30.0, -4.0], [30.0, -30.0, -4.0], [0.0, 30.0, -4.0]]])
    snapshot = replace(
        snapshot, content=triangles_snapshot(plane, np.ones((1, 3)), WIDTH, HEIGHT).content
    )
    views = [snapshot.camera.view.copy() for _ in range(2)]
    views[0][0, 3] -= 0.2
    views[1][1, 3] += 0.1
    camera = snapshot.camera
    camera = replace(
        camera, previous=(views[0], camera.projection), next=(views[1], camera.projection)
    )
    found = render_snapshot(bent(replace(snapshot, camera=camera), k))["Vector"]
    x, y = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    here = np.stack([x, y], axis=-1)
    straight = MIDDLE + CORNER * undistorted((here - MIDDLE) / CORNER, terms_of(k))
    pixel = 180.0 / 4.0
    before = expected_place(straight - (0.2 * pixel, 0.0), k) - here
    after = here - expected_place(straight + (0.0, 0.1 * pixel), k)
    wanted = np.concatenate([before, after], axis=-1)
    # What leaves the frame beyond its corner goes on as it went there.
    inside = np.hypot(*np.moveaxis(here - MIDDLE, -1, 0)) < CORNER - 12.0
    assert np.allclose(found[inside], wanted[inside], rtol=0, atol=0.01)
    camera = replace(snapshot.camera, previous=None, next=None)
    still = render_snapshot(bent(replace(snapshot, camera=camera), k))["Vector"]
    assert np.abs(still).max() < 1e-3


def test_the_circle_of_confusion_is_in_pixels_of_the_picture():
    lens = ThinLens(0.1, 3.0, Iris())
    snapshot = replace(many_triangles(WIDTH, HEIGHT, 1, lens), passes=("CoC", "Depth"))
    for k in (-0.1, 0.1):
        found = render_snapshot(bent(snapshot, k))
        plain = render_snapshot(snapshot)
        row, column = HEIGHT // 2, WIDTH // 2
        assert found["CoC"][row, column] == pytest.approx(plain["CoC"][row, column], rel=1e-3)
        # In the corner a barrel is smaller by both scales, 1 / (u / d) and 1 / (du / dd).
        empty = plain["CoC"][plain["Depth"] > 1e9].mean()
        corner = found["CoC"][0, 0, 0]
        if found["Depth"][0, 0] > 1e9:
            scale = (1.0 + k) * np.sqrt((1.0 + k) / (1.0 - k))
            assert corner / empty == pytest.approx(scale, rel=0.02)
