"""Light from farther out than highlights are searched: the lens samples keep what no disc draws."""

from dataclasses import replace

import numpy as np
import pytest

from addon.snapshot.content import ImageSnapshot, World, next_uid
from addon.snapshot.film import Sampling

from ...conftest import WORLD_COLOR, perspective, render_snapshot, triangles_snapshot
from ..bokeh_scenes import HEIGHT, LENS, WIDTH, energy, lamp, with_bokeh
from .test_lens_views import glossy_ball

pytestmark = pytest.mark.usefixtures("gpu_context")


def test_what_the_search_does_not_reach_keeps_its_light():
    # Half of it outside of the search, and one that is wholly outside.
    corners = [lamp(4.3, 0.0, 8.0, 0.6), lamp(-4.4, 0.5, 8.0, 0.2)]
    plain = triangles_snapshot(corners, [(40.0, 20.0, 10.0)] * 2, WIDTH, HEIGHT, LENS, 1024)
    black = np.array(WORLD_COLOR) * WIDTH * HEIGHT
    expected = (
        energy(render_snapshot(replace(plain, sampling=Sampling("REFERENCE", 4096)))["Combined"])
        - black
    )
    pictures = render_snapshot(with_bokeh(plain, overscan=0.0))
    assert energy(pictures["Bokeh"])[0] > 0.05 * expected[0]
    # Without the light outside, a half was missing; noise of so many samples is a per cent.
    assert energy(pictures["Combined"]) - black == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("views", [1, 4])
def test_reflections_are_divided_as_each_view_sees_them(views):
    def aside(snapshot):
        # The ball lies across the edge of the search.
        projection = perspective(72, 48, 0.25)
        projection[0, 2] = 1.1
        return replace(snapshot, camera=replace(snapshot.camera, projection=projection))

    reference = energy(render_snapshot(aside(glossy_ball(1, 2048, bokeh=False)))["Combined"])
    snapshot = aside(glossy_ball(views, 512))
    bokeh = replace(snapshot.camera.bokeh, overscan=0.0)
    snapshot = replace(snapshot, camera=replace(snapshot.camera, bokeh=bokeh))
    pictures = render_snapshot(snapshot)
    assert energy(pictures["Bokeh"]).min() > 0.02 * reference.min()
    # Without the light outside, 7 % was missing. Glints are other parts of the ball for each place
    # on the lens: where one view sees them beyond the edge and another does not, it is a guess.
    assert energy(pictures["Combined"]) == pytest.approx(reference, rel=0.025)


def test_the_world_outside_of_the_search_keeps_its_light():
    snapshot = triangles_snapshot([], [], WIDTH, HEIGHT, LENS, 256)
    pixels = np.full((64, 128, 4), 0.1, np.float32)
    pixels[np.random.default_rng(0).random((64, 128)) < 0.1, :3] = 60.0
    image = ImageSnapshot(next_uid(), "world", pixels)
    content = replace(
        snapshot.content, images={image.uid: image}, world=World((1.0, 1.0, 1.0), image.uid)
    )
    view = np.eye(4)[[0, 2, 1, 3]] * np.array([1.0, 1.0, -1.0, 1.0])[:, None]
    snapshot = replace(snapshot, content=content, camera=replace(snapshot.camera, view=view))
    many = replace(snapshot, sampling=Sampling("REFERENCE", 2048))
    expected = energy(render_snapshot(many)["Combined"])
    picture = energy(render_snapshot(with_bokeh(snapshot, overscan=0.0))["Combined"])
    assert picture == pytest.approx(expected, rel=0.01)


def test_a_part_of_the_picture_has_the_discs_of_the_whole():
    # One lamp shines into the part from a third of its width beyond its edge, one lies in it.
    corners = [lamp(0.55, 0.0, 8.0, 0.2), lamp(-0.3, 0.2, 8.0, 0.2)]
    lens = replace(LENS, aperture_radius=1.0)
    x, y, width, height = region = (20, 20, 24, 24)
    options = {"lens": lens, "samples": 16}
    colors = [(40.0, 20.0, 10.0), (10.0, 20.0, 40.0)]
    whole, part = (
        render_snapshot(
            with_bokeh(triangles_snapshot(corners, colors, WIDTH, HEIGHT, region=r, **options))
        )
        for r in (None, region)
    )
    expected = whole["Bokeh"][y : y + height, x : x + width]
    # The one outside is red, the one inside blue.
    assert min(expected[..., channel].max() for channel in (0, 2)) > 0.1
    # Both lie at the same places of the pixels; only sums are done in another order.
    assert part["Bokeh"] == pytest.approx(expected, rel=0.01, abs=1e-4)
