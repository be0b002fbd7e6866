"""How many samples a stretch of work takes."""

from addon.engine.frame.pacing import Coarseness, Pacer


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


def sides(cost, wanted, pictures=12):
    """Sides of the pixels of pictures that take `cost(side)` seconds."""
    pixels, found = Coarseness(), []
    for _ in range(pictures):
        found.append(pixels.side)
        pixels.measured(cost(pixels.side), wanted)
    return found


def test_pixels_grow_until_a_picture_takes_its_time_and_shrink_again():
    assert sides(lambda side: 1.0 / side**2, 0.3)[-3:] == [2, 2, 2]
    assert sides(lambda side: 1.0 / side**2, 0.1)[-3:] == [4, 4, 4]
    assert set(sides(lambda side: 1.0 / side**2, 0.0)) == {1}
    pixels = Coarseness()
    pixels.side = 4
    for _ in range(3):
        pixels.measured(0.02 / pixels.side**2, 0.1)
    assert pixels.side == 1


def test_pixels_stay_fine_where_the_geometry_takes_the_time():
    assert sides(lambda side: 1.0 + 0.2 / side**2, 0.3)[-6:] == [1] * 6
    # What is drawn has become lighter, and the pixels count again.
    pixels = Coarseness()
    for _ in range(4):
        pixels.measured(1.0 + 0.2 / pixels.side**2, 0.3)
    for _ in range(4):
        pixels.measured(0.5 / pixels.side**2, 0.3)
    assert pixels.side == 2
