"""`aplanat bench`: its numbers on a small scene, and how alike two pictures are."""

import numpy as np
import OpenEXR
import pytest

from addon.cli.picture_metrics import compare, read_picture
from addon.errors import InputError


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
