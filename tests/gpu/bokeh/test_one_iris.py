"""The blur of the picture has the shape of the discs: below the threshold and above it."""

from dataclasses import replace

import numpy as np
import pytest

from addon.lens_bokeh.look.appearance import Appearance
from addon.lens_bokeh.openings.blades import BladedIris
from addon.lens_bokeh.openings.pictures import PictureIris
from addon.lens_bokeh.openings.shapes import iris_of
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.camera import BokehSettings
from addon.snapshot.content import World
from addon.snapshot.film import Sampling
from tests.lens_bokeh.openings.shapes import heart

from ..conftest import render_snapshot, triangles_snapshot
from .bokeh_scenes import lamp

pytestmark = pytest.mark.usefixtures("gpu_context")

SIZE = 48
FOCUS = 3.0
# Behind the focus and in front of it: radii of the discs of 15 and 16 px.
FAR, NEAR = 8.0, 1.8
CURVED = BladedIris(5, 0.4, 0.3)
COMING_IN = BladedIris(5, 0.0, 0.3, 1.06)


def one_lamp(opening, light, method, depth, samples, ratio=1.0):
    lens = ThinLens(1.5, FOCUS, iris_of(opening, ratio=ratio))
    # A twentieth of the disc's area.
    made = lamp(0.0, 0.0, depth, 0.06 * depth)
    snapshot = triangles_snapshot([made], [(light,) * 3], SIZE, SIZE, lens, samples)
    appearance = Appearance(iris=opening, anamorphic_ratio=ratio)
    return replace(
        snapshot,
        content=replace(snapshot.content, world=World((0.0, 0.0, 0.0))),
        camera=replace(snapshot.camera, bokeh=BokehSettings(appearance=appearance)),
        sampling=Sampling(method, samples, 2 if method == "ADAPTIVE" else 0, reference_bokeh=True),
        passes=("Combined", "Bokeh"),
    )


def shape(picture):
    """Return where a disc is, by half of its brightness, noise smoothed over 5 x 5 pixels."""
    smooth = picture.astype(float)
    for axis in (0, 1):
        smooth = sum(np.roll(smooth, i, axis) for i in range(-2, 3)) / 5.0
    bright = smooth[smooth > 0.3 * smooth.max()]
    return smooth > 0.5 * np.median(bright)


@pytest.mark.parametrize(
    ("opening", "method", "depth", "samples"),
    [
        (PictureIris(heart()), "REFERENCE", FAR, 1024),
        (PictureIris(heart()), "ADAPTIVE", NEAR, 384),
        (PictureIris(heart()), "LAYERED", FAR, 384),
        (CURVED, "REFERENCE", NEAR, 1024),
        (CURVED, "ADAPTIVE", FAR, 384),
        (CURVED, "LAYERED", NEAR, 384),
        (COMING_IN, "REFERENCE", FAR, 1024),
    ],
)
def test_a_lamp_just_below_the_threshold_has_the_shape_of_one_far_above(
    opening, method, depth, samples
):
    below = render_snapshot(one_lamp(opening, 0.99, method, depth, samples))
    above = render_snapshot(one_lamp(opening, 100.0, method, depth, 16))
    assert below["Bokeh"][..., :3].max() == 0.0
    bokeh, all_light = (above[name][..., :3].sum() for name in ("Bokeh", "Combined"))
    assert bokeh == pytest.approx(all_light, rel=1e-3)
    first, second = shape(below["Combined"][..., 1]), shape(above["Combined"][..., 1])
    assert (first & second).sum() / (first | second).sum() >= 0.95
    # Neither a round blur nor one that is turned over would do.
    turned = second[::-1, ::-1]
    assert (first & turned).sum() / (first | turned).sum() < 0.93
    assert below["Combined"][..., 1].sum() / 0.99 == pytest.approx(
        above["Combined"][..., 1].sum() / 100.0, rel=0.06
    )
