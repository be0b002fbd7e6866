"""How many samples a stretch of work takes."""

from addon.engine.frame.pacing import Pacer


def test_slow_samples_are_drawn_one_at_a_time():
    pacer = Pacer(0.02)
    pacer.measured(1, 0.5)
    assert pacer.samples == 1


def test_stretch_grows_to_fill_its_time_and_not_beyond():
    pacer = Pacer(0.02)
    for _ in range(20):
        pacer.measured(pacer.samples, pacer.samples * 0.001)
    assert pacer.samples == 20


def test_growth_is_gradual():
    pacer = Pacer(0.02)
    pacer.measured(1, 1e-9)
    assert pacer.samples == 4


def test_scene_that_becomes_slow_is_answered_in_the_next_stretch():
    pacer = Pacer(0.02)
    pacer.samples = 100
    pacer.measured(100, 10.0)
    assert pacer.samples == 1


def test_nothing_drawn_teaches_nothing():
    pacer = Pacer(0.02)
    pacer.measured(0, 0.0)
    assert pacer.samples == 1
