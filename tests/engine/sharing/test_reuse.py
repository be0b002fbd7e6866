"""Which lens samples share a drawing: what is thinner than a cell keeps its share of the light."""

from types import SimpleNamespace

import numpy as np
import pytest

from addon.engine.sharing.reuse import find_sprites
from addon.sampling.halton import halton

SIZE = 64
# Where the object may be, in the middle of the raster; many triangles, so that sharing pays.
RECTANGLE, TRIANGLES = np.array([[24, 24, 16, 16]]), np.array([[10**6]])


def plan_of(samples, seed, coc=0.0, first=0):
    """Return what is read of a plan: samples of a square lens, and of a box as pixel filter."""
    places = halton(seed * 8192, samples, (2, 3, 5, 7))
    return SimpleNamespace(
        width=SIZE,
        height=SIZE,
        chromatic=None,
        first=first,
        reuse_grid=2,
        jitter=(places[:, :2] - 0.5) * 2.0 / SIZE,
        lens_extent=np.array([1.0, 1.0]),
        lens_positions=2.0 * places[:, 2:] - 1.0,
        coc=coc,
        source=SimpleNamespace(seed=seed),
    )


def parents(plan):
    """Return the sample that each is drawn as."""
    found = np.arange(len(plan.jitter))
    levels = np.zeros((1, len(found) - plan.first), int)
    row, coc = np.array([3]), np.array([plan.coc])
    for sprite in find_sprites(row, coc, levels, TRIANGLES, RECTANGLE, plan):
        found[list(sprite.members)] = sprite.parent
    return found


def places(plan):
    """Return where each sample puts a point, px."""
    return plan.jitter * SIZE / 2.0 + plan.lens_positions * plan.coc


@pytest.mark.parametrize("coc", [0.0, 3.0])
@pytest.mark.parametrize("axis", [0, 1])
def test_a_wire_is_met_as_often_as_without_sharing(axis, coc):
    # A wire of a tenth of a pixel at any place: the share of the samples whose parent meets it.
    wires = np.linspace(-0.4, 0.4, 33) + coc / 3.0
    wanted = 0.1 if coc == 0.0 else 0.1 / (2.0 * coc)
    shares = {}
    for samples in (128, 2048):
        plan = plan_of(samples, seed=1, coc=coc)
        shares[samples] = []
        for seed in range(8):
            plan.source = SimpleNamespace(seed=seed)
            drawn = places(plan)[parents(plan)][:, axis]
            shares[samples].append([(np.abs(drawn - w) < 0.05).mean() / wanted for w in wires])
    # All wires together, of which each parent meets a few; and more samples have more parents, so
    # that the error of a single wire goes down.
    assert np.mean(shares[2048]) == pytest.approx(1.0, rel=0.03)
    errors = [np.abs(np.array(shares[samples]) - 1.0).mean() for samples in (128, 2048)]
    assert errors[1] < 0.6 * errors[0]


def test_most_samples_share_a_drawing():
    plan = plan_of(256, seed=0)
    assert len(np.unique(parents(plan))) <= 32


def test_pictures_of_other_seeds_are_drawn_elsewhere():
    # All samples in one cell, as with the narrowest pixel filter.
    plan = plan_of(16, seed=1)
    plan.jitter *= 0.01
    drawn = []
    for seed in range(64):
        plan.source = SimpleNamespace(seed=seed)
        (parent,) = set(parents(plan))
        drawn.append(places(plan)[parent])
    # Their mean is that of all samples, which one drawing alone misses by a quarter of the filter.
    drawn, every = np.array(drawn) / 0.01, places(plan) / 0.01
    assert np.abs(drawn.mean(axis=0) - every.mean(axis=0)).max() < 0.05
    assert np.abs(drawn.std(axis=0) / every.std(axis=0) - 1.0).max() < 0.15
