"""When a viewport refines its bokeh: not while the view moves, and soon after."""

from types import SimpleNamespace

import pytest

pytestmark = pytest.mark.usefixtures("aplanat_bpy")


class FakeRenderer:
    """Counts what it is asked for."""

    def __init__(self, samples):
        self.plan = SimpleNamespace(samples=samples)
        self.samples_done = 0
        self.refined = 0

    def advance(self, samples):
        self.samples_done = min(self.samples_done + samples, self.plan.samples)

    @property
    def sampled(self):
        return self.samples_done >= self.plan.samples

    def is_late(self, _seconds):
        return False

    def wait(self):
        """Be done at once."""

    def refine_bokeh(self):
        self.refined += 1


@pytest.fixture
def clock(monkeypatch):
    """A clock that is moved by hand."""
    from addon.engine import viewport

    clock = SimpleNamespace(now=100.0)
    monkeypatch.setattr(
        viewport, "time", SimpleNamespace(perf_counter=lambda: clock.now), raising=True
    )
    return clock


@pytest.fixture
def viewport():
    from addon.engine.viewport import Viewport

    return Viewport()


def test_a_view_that_moves_keeps_its_draft(viewport, clock):
    for _ in range(20):
        # Every movement restarts the samples.
        renderer = FakeRenderer(16)
        clock.now += 1.0
        viewport._refine(renderer)
        assert renderer.refined == 0


def test_a_view_at_rest_is_refined_step_by_step(viewport, clock):
    renderer = FakeRenderer(4)
    viewport._refine(renderer)
    clock.now += 0.1
    viewport._refine(renderer)
    assert renderer.refined == 0
    clock.now += 0.15
    viewport._refine(renderer)
    viewport._refine(renderer)
    assert renderer.refined == 2
