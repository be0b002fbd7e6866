"""Sampling until the picture is good enough: what it promises, tile by tile, and in every pass."""

from dataclasses import replace

import numpy as np
import pytest

from addon.sampling.chromatic import ChromaticAberration, Dispersion
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.sampling.tile_control import TILE
from benchmarks.reference.picture_error import displayed

from ..conftest import make_renderer, some_triangles, triangles_snapshot

pytestmark = pytest.mark.usefixtures("gpu_context")

WIDTH, HEIGHT = 176, 64
LENS = ThinLens(0.1, 3.0, Iris(5, 0.3, 1.0))
PASSES = ("Combined", "Focus Matte", "CryptoObject00", "CryptoMaterial00", "Sample Count")


def frame(
    error=0.002,
    seed=3,
    least=16,
    most=4096,
    lens=LENS,
    passes=("Combined",),
    black=False,
    **options,
):
    corners, colors = some_triangles(seed, 24)
    colors = np.zeros_like(colors) if black else colors
    # All on one side: the other has nothing to sample.
    corners[..., 0] += 0.3 * corners[..., 2]
    snapshot = triangles_snapshot(
        corners, colors, width=WIDTH, height=HEIGHT, lens=lens, passes=passes, **options
    )
    sampling = replace(
        snapshot.sampling,
        method="ADAPTIVE",
        target_error=error,
        least_samples=least,
        most_samples=most,
    )
    return replace(snapshot, sampling=sampling)


def finish(renderer, step=7):
    while not renderer.sampled:
        renderer.advance(step)
    return renderer


def rendered(snapshot, step=7):
    """Return the passes and the `SamplingReport` of a snapshot that is sampled to its end."""
    renderer = finish(make_renderer(snapshot), step)
    found = renderer.read_passes(), renderer.sampling
    renderer.release()
    return found


def truth(snapshot, samples=2048):
    reference = replace(snapshot.sampling, method="REFERENCE", lens_samples=samples)
    renderer = make_renderer(replace(snapshot, sampling=reference, passes=("Combined",)))
    renderer.advance(samples)
    picture = renderer.read_passes()["Combined"]
    renderer.release()
    return picture


def dissimilarity(picture, other):
    similarity = pytest.importorskip("skimage.metrics").structural_similarity
    return 1.0 - similarity(
        displayed(picture)[..., :3],
        displayed(other)[..., :3],
        data_range=1.0,
        channel_axis=2,
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
    )


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_the_error_comes_to_the_number_against_the_reference_method(seed):
    snapshot = frame(seed=seed)
    perfect = truth(snapshot)
    for error in (0.004, 0.002):
        sampling = replace(snapshot.sampling, target_error=error)
        pictures, report = rendered(replace(snapshot, sampling=sampling))
        measured = dissimilarity(pictures["Combined"], perfect)
        assert 0.4 * error <= measured <= 1.3 * error
        assert report.error <= error


def test_the_same_frame_twice_is_the_same_bits_however_it_is_advanced():
    snapshot = frame(passes=PASSES)
    first, _ = rendered(snapshot)
    second, _ = rendered(snapshot, step=1)
    for name in PASSES:
        assert first[name].tobytes() == second[name].tobytes()


def test_looking_at_a_picture_on_the_way_does_not_change_it():
    snapshot = frame()
    expected, _ = rendered(snapshot)
    renderer = make_renderer(snapshot)
    while not renderer.sampled:
        renderer.advance(5)
        assert np.isfinite(renderer.read_image()).all()
    assert renderer.read_passes()["Combined"].tobytes() == expected["Combined"].tobytes()


def test_every_tile_is_the_mean_of_the_first_samples():
    snapshot = frame(error=0.001, passes=PASSES)
    pictures, report = rendered(snapshot)
    counts = pictures["Sample Count"][..., 0]
    numbers = np.unique(counts).astype(int)
    assert len(numbers) >= 3
    assert report.samples[0] == numbers[0]
    assert report.samples[2] == numbers[-1]
    assert report.samples[1] == pytest.approx(counts.mean())
    for number in numbers:
        fixed = replace(snapshot.sampling, least_samples=int(number), most_samples=int(number))
        whole, _ = rendered(replace(snapshot, sampling=fixed))
        tile = counts == number
        for name in PASSES[:-1]:
            # What is culled and cut off elsewhere changes no pixel of the tile.
            assert np.abs(pictures[name] - whole[name])[tile].max() < 1e-6, (name, number)


def test_tiles_are_squares_that_keep_their_number():
    pictures, _ = rendered(frame(passes=("Combined", "Sample Count")))
    counts = pictures["Sample Count"][..., 0]
    for y in range(0, HEIGHT, TILE):
        for x in range(0, WIDTH, TILE):
            assert np.ptp(counts[y : y + TILE, x : x + TILE]) == 0.0


def test_mattes_have_the_weights_of_the_picture():
    pictures, _ = rendered(frame(passes=PASSES))
    assert np.unique(pictures["Sample Count"]).size > 1
    coverage = pictures["CryptoObject00"][..., 1::2].sum(axis=-1)
    assert coverage.max() <= 1.0 + 1e-5
    assert pictures["Focus Matte"].max() <= 1.0 + 1e-5
    # The world has no matte: whole where no gap shows it.
    assert coverage.max() > 0.99


def test_bounds_of_samples_hold():
    _, report = rendered(frame(error=0.0005, most=40))
    assert report.samples[2] == 40
    assert report.error > 0.0005
    assert report.above > 0
    _, report = rendered(frame(error=0.5, least=100))
    # Looks are after 96 and 128 samples.
    assert report.samples == pytest.approx((128, 128, 128))
    _, report = rendered(frame(error=0.01, least=1, most=5))
    assert report.samples == pytest.approx((5, 5, 5))
    assert report.error is None


def test_fringe_is_sampled_as_the_picture_it_belongs_to():
    dispersion = Dispersion((380.0, 780.0), (0.97, 1.0))
    aberration = ChromaticAberration("SPECTRAL", 1.0, 0.05, dispersion, 0.05)
    snapshot = frame(passes=("Combined", "Fringe", "Sample Count"))
    snapshot = replace(snapshot, camera=replace(snapshot.camera, chromatic=aberration))
    pictures, report = rendered(snapshot)
    assert report.samples[0] < report.samples[2]
    assert report.samples[0] % 3 == report.samples[2] % 3 == 0
    camera = replace(snapshot.camera, chromatic=None)
    plain, _ = rendered(replace(snapshot, camera=camera, passes=("Combined",)))
    without = pictures["Combined"][..., :3] - pictures["Fringe"]
    # Both are good to the number (0.002), at other places of the lens: a root of it apart.
    assert dissimilarity(without, plain["Combined"][..., :3]) < 0.01
    # The side with nothing in it has no fringe, whatever the weights of its tiles are.
    empty = pictures["Sample Count"][..., 0] == report.samples[0]
    assert np.abs(pictures["Fringe"][empty]).max() < 1e-5


def test_what_is_stopped_keeps_what_it_has():
    renderer = make_renderer(frame(error=0.0005))
    renderer.advance(21)
    renderer.stop()
    assert renderer.sampled
    renderer.advance(10)
    assert renderer.samples_done == 21
    assert renderer.sampling.samples[::2] == (16, 21)
    assert np.isfinite(renderer.read_passes()["Combined"]).all()
    renderer.release()


def test_a_parallel_camera_stops_wherever_its_far_plane_is():
    def samples(far):
        snapshot = frame(lens=ThinLens(0.05, 3.0, Iris(5, 0.3, 1.0)), parallel=True)
        projection = snapshot.camera.projection.copy()
        projection[2, 2] = -2.0 / (far - 0.1)
        projection[2, 3] = -(far + 0.1) / (far - 0.1)
        camera = replace(snapshot.camera, projection=projection)
        return rendered(replace(snapshot, camera=camera))[1].samples

    assert samples(10000.0)[1] == pytest.approx(samples(20.0)[1], rel=0.25)
    assert samples(10000.0)[2] <= 512


def test_a_transparent_film_is_sampled_for_its_mattes():
    # Black on nothing: only alpha has edges.
    pictures, report = rendered(frame(transparent=True, black=True))
    assert (pictures["Combined"][..., :3] == 0.0).all()
    assert report.samples[2] > 16
