"""A noise threshold from the command line: what the statistics tell of it, and that it is kept."""

from benchmarks.scenes.small_scene import SIZE


def test_statistics_tell_the_error_and_the_samples(aplanat, small_blend, tmp_path):
    words = ("render", small_blend, "-o", tmp_path / "a.png", "--method", "adaptive", "--json")
    done = aplanat(*words, "--target-error", "0.02", "--max-samples", "64", "--min-samples", "20")
    assert done.code == 0, done
    settings, noise = done.answer["settings"], done.answer["noise"]
    assert (settings["samples"], settings["subsamples"]) == (None, None)
    assert (settings["min_samples"], settings["max_samples"]) == (20, 64)
    assert abs(settings["target_error"] - 0.02) < 1e-6
    assert noise["target"] == settings["target_error"]
    assert noise["tiles"] == (SIZE[0] // 16) * (SIZE[1] // 16)
    assert 20 <= noise["samples_least"] <= noise["samples_mean"] + 1e-6
    assert noise["samples_mean"] <= noise["samples_most"] + 1e-6
    assert noise["samples_most"] == done.answer["lens_samples"] <= 64
    assert (noise["error"] <= 0.02) == (noise["samples_most"] < 64)
    assert noise["tiles_above"] <= noise["tiles"]
    assert done.answer["frames"][0]["noise"] == noise


def test_a_number_of_samples_has_no_threshold(aplanat, small_blend, tmp_path):
    words = ("render", small_blend, "-o", tmp_path / "a.png", "--method", "adaptive", "--json")
    done = aplanat(*words, "--samples", "5")
    assert done.code == 0, done
    assert done.answer["settings"]["target_error"] is None
    noise = done.answer["noise"]
    assert (noise["target"], noise["error"]) == (None, None)
    assert (noise["samples_least"], noise["samples_most"]) == (5, 5)


def test_a_time_limit_ends_either_method(aplanat, small_blend, tmp_path):
    words = ("render", small_blend, "-o", tmp_path / "a.png", "--json", "--time-limit", "0.05")
    for method in ("reference", "adaptive"):
        done = aplanat(*words, "--method", method, "--samples", "4000")
        assert done.code == 0, done
        assert 1 <= done.answer["lens_samples"] < 4000
        assert done.answer["settings"]["time_limit_s"] > 0.0
