"""The first picture of a view: the whole lens from one drawing, near to that of all samples."""

from dataclasses import replace

import numpy as np
import pytest
from skimage.metrics import structural_similarity

from addon.engine.frame.first_picture import FirstPicture
from addon.engine.planning.plan import plan_first_picture
from addon.passes import joined_sets
from addon.sampling.iris import Iris
from addon.sampling.sequence import SETS
from addon.sampling.thin_lens import ThinLens
from tests.pictures import srgb
from tests.splat_pictures import library_lens

from .conftest import make_renderer, render_snapshot, some_triangles, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT = 96, 64
LENS = ThinLens(0.4, 3.0, Iris(5, 0.3, 1.4))


def scene(lens=LENS, **options):
    return triangles_snapshot(*some_triangles(), WIDTH, HEIGHT, lens, 128, **options)


def camera_of(snapshot, **values):
    return replace(snapshot, camera=replace(snapshot.camera, **values))


def with_lens(snapshot, lens):
    return camera_of(snapshot, lens=lens)


@pytest.fixture
def first_of():
    """Return the function that draws the first picture of a snapshot."""
    made = []

    def draw(snapshot):
        buffers = make_renderer(snapshot)._buffers
        first = FirstPicture(buffers)
        made.append(first)
        first.draw(snapshot, plan_first_picture(snapshot))
        return first.renderer.read_image()

    yield draw
    for first in made:
        first.release()


def likeness(picture, other):
    return structural_similarity(
        srgb(picture[..., :3]), srgb(other[..., :3]), data_range=1.0, channel_axis=2
    )


@pytest.mark.parametrize("parallel", [False, True])
@pytest.mark.parametrize("transparent", [False, True])
def test_it_is_near_the_picture_of_all_samples_and_not_a_pinholes(first_of, parallel, transparent):
    snapshot = scene(parallel=parallel, transparent=transparent)
    samples = render_snapshot(snapshot)["Combined"]
    pinhole = render_snapshot(with_lens(snapshot, None))["Combined"]
    first = first_of(snapshot)
    # Small and thin things have no more than one texel a pixel; the bar of 0.90 is for pictures of
    # an ordinary size.
    assert 1.0 - likeness(first, samples) < 0.5 * (1.0 - likeness(pinhole, samples))
    assert np.abs(first[..., 3] - samples[..., 3]).mean() < (0.03 if transparent else 1e-6)


def small_lamp(depth, lens):
    corners = np.array([[[-0.02, -0.02, -1], [0.02, -0.02, -1], [0.0, 0.02, -1]]]) * depth
    return triangles_snapshot(corners, [(200.0,) * 3], WIDTH, HEIGHT, lens, transparent=True)


@pytest.mark.parametrize("depth", [1.7, 9.0])
def test_a_lamp_becomes_a_disc_in_the_shape_of_the_iris_with_all_its_light(first_of, depth):
    lens = ThinLens(0.5, 3.0, Iris(3, 0.0, 1.0))
    snapshot = small_lamp(depth, lens)
    pinhole = render_snapshot(with_lens(snapshot, None))["Combined"]
    samples = render_snapshot(
        replace(snapshot, sampling=replace(snapshot.sampling, lens_samples=512))
    )
    first, whole = first_of(snapshot)[..., 0], samples["Combined"][..., 0]
    # Of few texels, each of which is seen from a whole number of places.
    assert first.sum() == pytest.approx(pinhole[..., 0].sum(), rel=0.15)
    # The lamp is in the middle of the picture.
    mirrored = whole[:, ::-1]
    # Turned as it is in front of the focus, and behind it.
    alike, turned = (np.corrcoef(first.ravel(), each.ravel())[0, 1] for each in (whole, mirrored))
    assert alike > 0.85
    assert alike > turned + 0.1


def test_it_is_seen_through_a_real_lens(first_of):
    lens = ThinLens(0.4, 3.0, Iris())
    corners, colors = some_triangles()
    snapshot = triangles_snapshot(corners, colors, WIDTH, HEIGHT, lens, 128)
    real = library_lens("double-gauss-50mm-f2")
    snapshot = replace(snapshot, camera=replace(snapshot.camera, real_lens=real))
    plan = plan_first_picture(snapshot)
    assert plan.real_lens is not None
    samples = render_snapshot(snapshot)["Combined"]
    pinhole = camera_of(snapshot, lens=None, real_lens=None)
    pinhole = render_snapshot(pinhole)["Combined"]
    first = first_of(snapshot)
    assert np.abs(first[..., 3] - 1.0).max() < 1e-5
    assert first[..., :3].sum() == pytest.approx(samples[..., :3].sum(), rel=0.02)
    assert np.abs(first - samples).mean() < 0.5 * np.abs(pinhole - samples).mean()


def test_there_is_none_where_nothing_is_blurred():
    assert plan_first_picture(scene(None)) is None
    assert plan_first_picture(scene(ThinLens(1e-6, 3.0))) is None
    nothing = triangles_snapshot([], [], WIDTH, HEIGHT, LENS)
    assert plan_first_picture(nothing) is None


def test_one_pixel_is_drawn(first_of):
    snapshot = scene(region=(48, 30, 1, 1))
    found = first_of(snapshot)
    assert found.shape == (1, 1, 4)
    assert np.isfinite(found).all() and found[0, 0, 3] == pytest.approx(1.0)


def test_pictures_are_the_same_bits_whatever_was_drawn_before():
    snapshot = scene()
    other = with_lens(snapshot, ThinLens(0.05, 2.0))
    renderer = make_renderer(snapshot)
    first = FirstPicture(renderer._buffers)
    pictures = []
    for each in (snapshot, other, snapshot):
        first.draw(each, plan_first_picture(each))
        pictures.append(first.renderer.read_image().tobytes())
        assert first.is_better_than(renderer)
    assert pictures[0] == pictures[2] != pictures[1]
    # Nothing of it is in the samples.
    renderer.advance(128)
    assert renderer.finished() and not first.is_better_than(renderer)
    assert renderer.read_image().tobytes() == render_snapshot(snapshot)["Combined"].tobytes()
    first.draw(snapshot, None)
    assert first.renderer is None and not first.is_better_than(renderer)
    first.release()
    renderer.release()


def test_joined_pixels_keep_what_is_sharp_and_lose_the_noise_of_what_is_not():
    from addon.device import geometry, readback
    from addon.device.targets import Targets, TargetSpec
    from addon.device.textures import texture_2d

    rng = np.random.default_rng(5)
    count = SETS
    noise = 2.0 * rng.random((count, count))
    # On the left sharp, on the right blurred: the noise of the sets, which repeats.
    others = np.ones((16, 24, 4), np.float32)
    others[..., 0] = np.tile(noise / noise.mean(), (4, 6))
    shares = np.zeros((16, 24, 4), np.float32)
    shares[..., 2] = 1.0
    shares[:, 12:, 1] = 50.0
    near = np.zeros((16, 24, 4), np.float32)
    textures = {"near": texture_2d(near), "others": texture_2d(others)}
    textures["shares"] = texture_2d(shares)
    with Targets(24, 16, [TargetSpec("sum", "RGBA32F")]) as targets:
        targets.clear("sum", (0.0, 0.0, 0.0, 0.0))
        with targets.framebuffer("sum").bind():
            joined_sets.join(geometry.fullscreen_batch(), textures)
        found = readback.read_color(targets.framebuffer("sum"), 24, 16)
    assert np.abs(found - others)[:, :12].max() < 1e-6
    assert np.abs(found[2:-2, 14:-2, 0] - 1.0).max() < 1e-5
