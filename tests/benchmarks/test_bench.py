"""`aplanat bench`: its numbers on a small scene, and how alike two pictures are."""

import numpy as np
import OpenEXR
import pytest

from addon.errors import InputError
from benchmarks.benches import focus_pull
from benchmarks.benches.curve import Curve, samples_to_reach
from benchmarks.benches.focus_pull import mean_of_nine
from benchmarks.referees.picture_metrics import compare, read_picture


def save(path, picture):
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    OpenEXR.File(header, {"RGB": picture}).write(str(path))


@pytest.fixture
def noise():
    return np.random.default_rng(3).random((48, 64, 3)).astype(np.float32)


def test_a_picture_is_like_itself(noise):
    assert compare(noise, noise) == {"ssim_srgb": 1.0, "ssim_tile": 1.0, "energy": 1.0}


def test_one_bad_place_shows_in_the_worst_tile(noise):
    spoiled = noise.copy()
    spoiled[8:16, 8:16] = 0.0
    found = compare(spoiled, noise)
    assert found["ssim_srgb"] > 0.95
    # The spot covers one of the 8 x 6 tiles of 8 x 8 pixels.
    assert found["ssim_tile"] < 0.3


def test_energy_is_the_ratio_of_sums(noise):
    assert compare(0.5 * noise, noise)["energy"] == pytest.approx(0.5)


def test_metrics_agree_with_the_shared_ones(shared, noise, monkeypatch):
    monkeypatch.syspath_prepend(shared / "scenes")
    import compare as theirs

    other = np.clip(noise + 0.1 * np.roll(noise, 1, axis=0), 0, 2)
    expected, found = theirs.metrics(other, noise), compare(other, noise)
    for key in found:
        assert found[key] == pytest.approx(expected[key], abs=1e-6)


def test_sizes_must_agree(noise):
    with pytest.raises(InputError, match="--resolution 64x48"):
        compare(noise[:24], noise)


def test_unreadable_reference_is_named(tmp_path):
    path = tmp_path / "a.exr"
    path.write_bytes(b"no picture")
    with pytest.raises(InputError, match=r"a\.exr"):
        read_picture(path)


def test_bench_measures_cost_and_likeness(aplanat, small_blend, tmp_path):
    words = ("bench", "--scene", small_blend, "--samples", "8", "--resolution", "48x32", "--json")
    first = aplanat(*words, "--pictures", tmp_path)
    assert first.code == 0, first
    lens = tmp_path / f"{small_blend.stem}_lens.exr"
    again = aplanat(*words, "--reference", lens, "-o", tmp_path / "bench.json")
    assert again.code == 0, again
    run = again.answer["runs"][0]
    assert run["lens"]["compared"] == {"ssim_srgb": 1.0, "ssim_tile": 1.0, "energy": 1.0}
    assert run["lens"]["lens_samples"] == 8
    assert run["cost_of_sample_in_pinhole_passes"] > 0
    assert (tmp_path / "bench.json").stat().st_size > 100
    # With the lens the near plane's edge is soft, without it is not.
    assert read_picture(lens).shape == (32, 48, 3)


def test_bench_refuses_what_it_cannot_find(refused, tmp_path, small_blend):
    assert "nothing.blend" in refused("bench", "--scene", tmp_path / "nothing.blend")
    assert "one scene" in refused(
        *("bench", "--scene", small_blend, "--scene", small_blend, "--reference", "a.exr")
    )


def test_samples_to_reach_a_likeness_are_found_between_two_marks():
    # An error of 0.8 over the number of samples.
    curve = Curve((8, 32, 128), (1.0, 4.0, 16.0), (0.9, 0.975, 0.99375))
    samples, reached = samples_to_reach(curve, 0.95)
    assert (samples, reached) == (pytest.approx(16.0), True)
    assert samples_to_reach(curve, 0.8) == (8.0, True)
    assert samples_to_reach(curve, 0.999) == (128.0, False)


def test_a_mean_of_nine_is_that_of_the_pixel_and_its_neighbours(noise):
    found = mean_of_nine(noise.astype(float))
    assert found.shape == (46, 62, 3)
    assert found[4, 9] == pytest.approx(noise[4:7, 9:12].mean(axis=(0, 1)), abs=1e-6)


def test_bench_compares_the_adaptive_method_with_accumulation(aplanat, small_blend, tmp_path):
    done = aplanat(
        *("bench", "--method", "adaptive", "--scene", small_blend, "--samples", "64"),
        *("--resolution", "48x32", "--json", "--pictures", tmp_path, "-o", tmp_path / "a.json"),
    )
    assert done.code == 0, done
    run = done.answer["runs"][0]
    assert (run["samples"], run["subsamples"]) == (32, 4)
    assert run["work"]["lens_samples"] == 32
    # Two planes against 64 samples of the same places.
    assert run["compared"]["ssim_srgb"] > 0.97
    assert run["compared"]["energy"] == pytest.approx(1.0, abs=0.01)
    for plain in run["accumulation"].values():
        ssim = [mark["ssim_srgb"] for mark in plain["curve"]]
        assert ssim == sorted(ssim)
        assert plain["speedup"] > 0.0
        assert len(plain["ratios"]) == 5
    assert {"plan", "prepare", "surfaces", "sum"} == set(run["seconds_by_stage"])
    for name in ("adaptive", "truth"):
        path = tmp_path / f"{small_blend.stem}_{name}.exr"
        assert read_picture(path).shape == (32, 48, 3)
    assert (tmp_path / "a.json").stat().st_size > 100


def test_a_truth_from_a_file_takes_the_place_of_one_that_is_rendered(
    aplanat, small_blend, tmp_path
):
    words = ("bench", "--method", "adaptive", "--scene", small_blend, "--samples", "32")
    words += ("--resolution", "48x32", "--json")
    first = aplanat(*words, "--pictures", tmp_path)
    again = aplanat(*words, "--reference", tmp_path / f"{small_blend.stem}_truth.exr")
    found = [run.answer["runs"][0]["compared"] for run in (first, again)]
    assert found[0] == pytest.approx(found[1], abs=1e-6)


def test_bench_measures_a_focus_pull(aplanat, small_blend, monkeypatch):
    monkeypatch.setattr(focus_pull, "_FRAMES", 3)
    done = aplanat(
        *("bench", "--method", "adaptive", "--focus-pull", "--scene", small_blend),
        *("--resolution", "48x32", "--json"),
    )
    assert done.code == 0, done
    pull = done.answer["runs"][0]["focus_pull"]
    assert pull["frames"] == 3
    assert pull["reference_samples"] == 32 * 5
    assert pull["focus_distance_m"] == pytest.approx([3.0, 16.0 / 3.0])
    assert len(pull["excess_by_frame"]) == 2
    # What the adaptive method changes more than the reference is part of what it changes.
    assert pull["excess"] <= pull["largest_change"]["adaptive"]
    assert pull["largest_change"]["reference"] > 0.001


def test_bench_refuses_peers_without_a_reference_and_options_of_another_method(
    refused, small_blend
):
    words = ("bench", "--scene", small_blend)
    assert "no reference" in refused(*words, "--method", "adaptive", "--peers")
    assert "--method adaptive" in refused(*words, "--peers")
    assert "--method adaptive" in refused(*words, "--focus-pull")
