"""Discs of a lens with cylinders against lens samples of the same lens."""

import pytest

from benchmarks.bokeh.discs import compare_discs_of

pytestmark = [
    pytest.mark.usefixtures("aplanat_bpy", "gpu_context"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]


@pytest.mark.parametrize("depth", [0.5, 10.0])
def test_discs_through_cylinders_are_what_lens_samples_draw(depth):
    fields = ((0.6, 150.0),)
    (lamp,), _ = compare_discs_of("anamorphic-60mm-f2", (depth,), fields, samples=1024)
    # The noise of so few samples is most of it; a disc without the lens' pattern has 6 dB less.
    assert lamp["psnr_raw_db"] > lamp["noise_db"] - 2.0
    assert lamp["energy"] == pytest.approx(1.0, abs=0.05)
