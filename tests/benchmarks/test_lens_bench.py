"""`aplanat bench --lens`: what it measures of a lens, on a small scale."""

import pytest

from addon.errors import LensFileError
from addon.lens_io.library import Library
from benchmarks.benches.lens import rays_per_second


def test_rays_a_second_are_counted_through_the_whole_lens():
    lens = Library().open("tessar-50mm-f2.8").prescription.configuration()
    # A loop over rays in Python makes some thousands a second.
    assert rays_per_second(lens, 20000, 1) > 100_000


def test_bench_refuses_what_is_no_lens():
    from types import SimpleNamespace

    from benchmarks.benches.lens import bench_lenses

    with pytest.raises(LensFileError, match="no lens"):
        bench_lenses(SimpleNamespace(lens=["nothing"], output=None), None)
