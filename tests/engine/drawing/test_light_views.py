"""Views of lights: everything that the camera sees is in one of them, with what hides it."""

import numpy as np
import pytest

from addon.engine.drawing import light_views


class Box:
    """Receivers that fill a box."""

    def __init__(self, low, high):
        self._low, self._high = np.array(low, float), np.array(high, float)

    def box(self):
        return self._low, self._high


def contains(view, point):
    offset = point - view.origin
    depth = offset @ view.along
    places = [offset @ axis / (axis @ axis) for axis in (view.across, view.up)]
    if not view.parallel:
        places = [place / depth for place in places]
    return view.near < depth < view.far and max(np.abs(places)) < 1.0


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (0.0, 0.0, 3.0), (20.0, 4.0, 9.0)])
def test_every_point_of_a_box_is_seen_from_a_lamp(place):
    rng = np.random.default_rng(1)
    box = Box((-4, -6, -1), (5, 7, 1))
    views = light_views.lamp_views(box, np.array(place), rng.random(3))
    # Far away one frustum is enough.
    assert len(views) == 1 if place[0] else len(views) > 1
    for point in rng.uniform(*box.box(), (500, 3)):
        if np.linalg.norm(point - place) > 0.1:
            seen = [view for view in views if contains(view, point)]
            assert seen
            # Whatever lies between is drawn into the view that sees the point.
            between = place + (point - place) * rng.uniform(0.1, 0.9)
            assert seen[0].sees(between[None], np.array([0.01]))[0]


def test_matrices_say_the_same_as_the_axes():
    rng = np.random.default_rng(2)
    views = light_views.lamp_views(Box((-1, -1, -1), (1, 1, 1)), np.zeros(3), rng.random(3))
    for view in views:
        world, projection = view.matrices()
        point = view.origin + 0.7 * view.along + 0.2 * view.across - 0.4 * view.up
        clip = projection @ world @ np.array([*point, 1.0])
        np.testing.assert_allclose(clip[:2] / clip[3], (0.2 / 0.7, -0.4 / 0.7), atol=1e-9)
        stored = clip[2] / clip[3] * 0.5 + 0.5
        near, far = view.near, view.far
        assert near * far / (far - stored * (far - near)) == pytest.approx(0.7)


def test_maps_of_a_tile_do_not_overlap():
    for count in range(1, 7):
        covered = np.zeros((256, 256), int)
        for x, y, width, height in light_views.tiles(count, (0, 0), 256):
            covered[y : y + height, x : x + width] += 1
        assert covered.max() == 1
        assert covered.mean() > 0.6
