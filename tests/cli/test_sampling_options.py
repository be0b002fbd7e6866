"""The sampling options of `aplanat render`: what they put in force, and what they refuse."""

from types import SimpleNamespace

import pytest

from addon.cli.arguments import parse
from addon.cli.render.sampling_arguments import apply_sampling
from addon.errors import InputError

RENDER = ["render", "scene.blend"]


def in_force(*words):
    settings = SimpleNamespace(
        method="ADAPTIVE", use_target_error=True, use_levels=True, use_sharing=True
    )
    render = SimpleNamespace()
    apply_sampling(settings, render, parse([*RENDER, *words]))
    return settings


def test_a_noise_threshold_and_its_bounds():
    settings = in_force(
        *("--target-error", "0.005", "--min-samples", "32", "--max-samples", "512"),
        *("--time-limit", "60", "--level-bias", "-1.5", "--min-triangles", "64"),
    )
    assert settings.use_target_error
    assert (settings.render_error, settings.render_time_limit) == (0.005, 60.0)
    assert (settings.render_min_samples, settings.render_max_samples) == (32, 512)
    assert (settings.level_bias, settings.least_triangles) == (-1.5, 64)


def test_a_number_of_samples_takes_the_place_of_the_threshold():
    settings = in_force(
        "--samples", "64", "--subsamples", "0", "--no-levels", "--sharing-cells", "0"
    )
    assert not settings.use_target_error
    assert (settings.render_samples, settings.subsamples) == (64, 0)
    assert not settings.use_levels
    assert not settings.use_sharing


def test_without_shadows():
    assert in_force("--shadows").use_shadows
    assert not in_force("--no-shadows").use_shadows


def test_without_options_all_is_as_in_the_file():
    assert vars(in_force()) == {
        "method": "ADAPTIVE",
        "use_target_error": True,
        "use_levels": True,
        "use_sharing": True,
    }


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--target-error", "0.01", "--samples", "8"), "exclude each other"),
        (("--max-samples", "9", "--subsamples", "2"), "exclude each other"),
        (("--target-error", "0.01", "--method", "reference"), "belongs to --method adaptive"),
        (("--no-levels", "--method", "reference"), "belongs to --method adaptive"),
        (("--min-samples", "9", "--max-samples", "8"), "9 is more than --max-samples 8"),
        (("--no-levels", "--level-bias", "1"), "leaves nothing"),
        (("--target-error", "0"), "--target-error"),
        (("--time-limit", "0"), "must be greater than 0"),
        (("--level-bias", "17"), "--level-bias"),
        (("--sharing-cells", "9"), "between 0 and 8"),
        (("--min-triangles", "3"), "between 4"),
    ],
)
def test_what_makes_no_sense_is_refused(words, reason):
    with pytest.raises(InputError, match=reason):
        parse([*RENDER, *words])
