"""The debug view of the bokeh: marks against their twin, and what they say of a scene."""

from dataclasses import replace

import numpy as np
import pytest

from addon.device import geometry, readback, state
from addon.device.targets import Targets, TargetSpec
from addon.device.textures import texture_2d
from addon.device.uniforms import uniform_buffer
from addon.engine.bokeh.marks import FATE_COLORS
from addon.engine.planning.plan import plan_frame
from addon.passes.bokeh import marks as bokeh_marks
from addon.passes.bokeh.marks import FATES, Marks
from addon.passes.surface import surface
from benchmarks.reference import bokeh_marks as twin

from ..conftest import make_renderer, render_snapshot, triangles_snapshot
from .bokeh_scenes import HEIGHT, LENS, WIDTH, lamp, with_bokeh

pytestmark = pytest.mark.usefixtures("gpu_context")

SIZE = 48
DOT, LINE, OPACITY, RATIO, SHARP = 1.25, 0.75, 0.4, 1.5, 3.0
COLORS = np.linspace(0.1, 0.9, 8)[:, None] * [1.0, 0.5, 0.25]
# Places in the picture and signed radii, px; sides of squares, px; kinds and states (see
# visibility_lib and source_lib) and what they mean.
SOURCES = [
    ((12.3, 10.0), 8.0, 1.0, 0.0, 1.0, "OUTSIDE"),
    ((14.0, 13.7), -6.5, 3.4, 0.0, 2.0, "HIDDEN"),
    ((30.5, 30.5), 14.0, 8.0, 1.0, 3.0, "VISIBLE"),
    ((33.0, 22.0), 3.5, 2.0, 1.0, 5.0, "FREE"),
    ((8.0, 36.0), -9.0, 1.0, 1.0, 6.0, "VISIBLE"),
    ((40.0, 8.0), 2.5, 5.0, 2.0, 4.0, "MASKED"),
    ((46.0, 40.2), 20.0, 4.0, 3.0, 4.0, "IN_SPLAT"),
]
LIGHTS = np.random.default_rng(5).uniform(0.2, 9.0, (len(SOURCES), 3))


def drawn(marks, stride=1):
    """Return the marks of the sources on black."""
    lists = np.zeros((4, 1, 1024, 4), np.float32)
    for i, (place, coc, side, kind, found, _) in enumerate(SOURCES):
        # An orthographic camera a pixel of which is 1 m: depth sets the radius alone.
        lists[0, 0, i] = (*(np.array(place) - SIZE / 2), 10.0 + coc, side)
        lists[1, 0, i, :3] = LIGHTS[i]
        lists[2, 0, i, 3], lists[3, 0, i, 3] = kind, found
    names = ("sources_a_tx", "sources_b_tx", "tiles_tx", "states_tx")
    textures = {name: texture_2d(table) for name, table in zip(names, lists, strict=True)}
    view = uniform_buffer(
        surface.VIEW_PARAMS.pack(
            view=np.eye(4),
            view_inverse=np.eye(4),
            projection=np.diag([2.0 / SIZE, 2.0 / SIZE, -1e-3, 1.0]),
            lens=(10.0, 1.0, 10.0, 0.5),
            film=(SIZE, SIZE, 0.0, 0.0),
        )
    )
    parameters = uniform_buffer(
        bokeh_marks.MARK_PARAMS.pack(
            size=(DOT, LINE, OPACITY, RATIO),
            source=(SHARP, 0.0, 0.0, 0.0),
            colors=np.concatenate([COLORS, np.zeros((8, 1))], axis=1),
        )
    )
    square = geometry.square_batch()
    with Targets(SIZE, SIZE, [TargetSpec("marks", "RGBA32F")]) as targets:
        targets.clear("marks", (0.0, 0.0, 0.0, 0.0))
        with targets.framebuffer("marks").bind():
            count = len(SOURCES)
            bokeh_marks.draw_marks(square, marks, count, textures, view, parameters, stride)
        return readback.read_color(targets.framebuffer("marks"), SIZE, SIZE)


@pytest.mark.parametrize("stride", [1, 3])
@pytest.mark.parametrize("color", ["OWN", "FATES", "SHARP"])
@pytest.mark.parametrize("shape", ["DOT", "OUTLINE", "RING"])
def test_marks_are_those_of_the_twin(shape, color, stride):
    chosen = [i for i in range(0, len(SOURCES), stride)]
    if color == "SHARP":
        chosen = [i for i in chosen if abs(SOURCES[i][1]) <= SHARP]
    colors = {
        "OWN": LIGHTS / LIGHTS.max(axis=1, keepdims=True),
        "FATES": COLORS[[FATES.index(source[5]) for source in SOURCES]],
        "SHARP": np.tile(COLORS[FATES.index("SHARP")], (len(SOURCES), 1)),
    }[color]
    sizes = {
        "DOT": [DOT] * len(SOURCES),
        "OUTLINE": [max(0.5 * source[2], DOT) for source in SOURCES],
        "RING": [abs(source[1]) for source in SOURCES],
    }[shape]
    expected = np.zeros((SIZE, SIZE, 4))
    places = np.array([source[0] for source in SOURCES])
    how = (shape, LINE, OPACITY, RATIO)
    twin.draw_marks(expected, places[chosen], np.array(sizes)[chosen], colors[chosen], *how)
    found = drawn(Marks(shape, color), stride)
    assert expected.any() or not chosen
    # Places come from depths of 32 bits; at the middle of an ellipse's ring nothing is drawn.
    assert found == pytest.approx(expected, abs=2e-4)


def test_a_picture_below_marks_is_dimmed_however_bright_it_is():
    rng = np.random.default_rng(7)
    picture = (10.0 ** rng.uniform(-3, 5, (9, 13, 4))).astype(np.float32)
    marks = np.zeros((9, 13, 4), np.float32)
    marks[2:5, 3:9] = (0.3, 0.2, 0.1, 0.5)
    with Targets(13, 9, [TargetSpec("out", "RGBA32F")]) as targets:
        with targets.framebuffer("out").bind():
            batch = geometry.fullscreen_batch()
            bokeh_marks.draw_picture(batch, texture_2d(picture), texture_2d(marks))
        found = readback.read_color(targets.framebuffer("out"), 13, 9)
    assert found == pytest.approx(twin.marked_picture(picture, marks), rel=1e-5)
    assert found[..., :3].max() < 0.6


# The frame -------------------------------------------------------------------------------------


def plate(x, y, depth, half_width, half_height):
    """Return the corners of two triangles that face the camera."""
    a, b = (x - half_width, y - half_height, -depth), (x + half_width, y - half_height, -depth)
    c, d = (x + half_width, y + half_height, -depth), (x - half_width, y + half_height, -depth)
    return [[a, b, c], [a, c, d]]


# Where, by what hides them: blurred to 5 px, but for the one in focus.
LAMPS = {
    "SEEN": (-2.0, 1.0, 8.0),
    "HIDDEN": (2.0, 1.0, 8.0),
    "MASKED": (0.0, -1.5, 8.0),
    "SHARP": (0.5, 0.3, 3.05),
}


def scene(samples=8, **settings):
    corners = [lamp(*place, 0.02 * place[2]) for place in LAMPS.values()]
    colors = [(30.0, 20.0, 10.0)] * len(corners)
    # The way from the lamp to the middle of the lens passes there at 5 / 8 of its depth.
    corners += plate(2.0 * 5 / 8, 1.0 * 5 / 8, 5.0, 0.5, 0.5)
    corners += plate(0.05, -1.5 * 5 / 8, 5.0, 0.06, 0.3)
    colors += [(0.2, 0.2, 0.2)] * 4
    plain = triangles_snapshot(corners, colors, WIDTH, HEIGHT, LENS, samples)
    return with_bokeh(plain, **settings)


def pixel_of(name):
    x, y, depth = LAMPS[name]
    focal = WIDTH / 2 / 0.5
    return int(HEIGHT / 2 + focal * y / depth), int(WIDTH / 2 + focal * x / depth)


def linear(color):
    c = np.array(color) / 255.0
    return ((c + 0.055) / 1.055) ** 2.4


@pytest.mark.parametrize("visibility", ["RASTER", "WARP", "SPLAT"])
def test_colours_say_what_became_of_the_lamps(visibility):
    picture = render_snapshot(scene(visibility=visibility, debug_view="VISIBILITY"))["Combined"]
    renderer = make_renderer(scene(visibility=visibility))
    renderer.advance(1)
    counts = renderer.fates
    renderer.release()
    partly = "IN_SPLAT" if visibility == "SPLAT" else "MASKED"
    for name in ("HIDDEN", partly, "SHARP"):
        assert counts[name] > 0, name
        found = picture[pixel_of("MASKED" if name == partly else name)][:3]
        assert found == pytest.approx(linear(FATE_COLORS[name]), abs=2e-3), name
    seen = picture[pixel_of("SEEN")][:3]
    assert counts["VISIBLE"] + counts["FREE"] > 0
    assert any(
        seen == pytest.approx(linear(FATE_COLORS[name]), abs=2e-3) for name in ("VISIBLE", "FREE")
    )


def test_sources_and_clusters_have_their_own_colour_and_clusters_their_discs():
    for model in ("POINT", "CLUSTERED"):
        sources = render_snapshot(scene(model=model, debug_view="SOURCES"))["Combined"]
        clusters = render_snapshot(scene(model=model, debug_view="CLUSTERS"))["Combined"]
        row, column = pixel_of("SEEN")
        assert sources[row, column, :3] == pytest.approx([1.0, 2 / 3, 1 / 3], abs=2e-3)
        # 5 px from its middle is the disc's edge, where no dot is.
        rim = [clusters[row, column + side, :3].max() for side in (-5, 5)]
        assert min(rim) > 0.3
        assert sources[row, column - 9, :3].max() < 0.3
        # Nothing is listed that is sharp.
        assert sources[pixel_of("SHARP")][:3].max() <= 0.25 + 1e-6


@pytest.mark.parametrize("view", ["SOURCES", "CLUSTERS", "VISIBILITY"])
def test_the_other_passes_and_the_counts_stay_what_they_are(view):
    plain, marked = (
        render_snapshot(scene(model="CLUSTERED", debug_view=kind)) for kind in ("NONE", view)
    )
    for name in ("Defocus", "Bokeh"):
        assert marked[name].tobytes() == plain[name].tobytes()
    assert plain["Combined"].tobytes() == (plain["Defocus"] + plain["Bokeh"]).tobytes()
    below = plain["Combined"]
    untouched = (marked["Combined"] == twin.marked_picture(below, 0.0 * below)).all(axis=-1)
    assert 0.2 < untouched.mean() < 0.99


def test_marks_lie_where_the_distorted_picture_has_the_lamps():
    snapshot = scene(debug_view="SOURCES")
    snapshot = replace(snapshot, camera=replace(snapshot.camera, distortion=(-0.3,)))
    plan = plan_frame(snapshot)
    picture = render_snapshot(snapshot, plan)["Combined"]
    for name in ("SEEN", "HIDDEN"):
        x, y, depth = LAMPS[name]
        clip = plan.projection @ (x, y, -depth, 1.0)
        place = (clip[:2] / clip[3] * 0.5 + 0.5) * (plan.width, plan.height)
        column, row = np.floor(plan.distortion.pictured(place)).astype(int)
        assert (row, column) != pixel_of(name)
        assert picture[row, column, 0] > 0.8, name


def test_where_nothing_may_shine_the_picture_is_as_it_is():
    found, plain = (
        render_snapshot(scene(threshold=1e4, debug_view=view)) for view in ("VISIBILITY", "NONE")
    )
    assert found["Combined"].tobytes() == plain["Combined"].tobytes()


def test_the_viewport_draws_what_the_render_has():
    renderer = make_renderer(scene(debug_view="VISIBILITY"))
    renderer.advance(8)
    expected = renderer.read_image()
    with Targets(2 * WIDTH + 3, 2 * HEIGHT + 5, [TargetSpec("out", "RGBA32F")]) as targets:
        framebuffer = targets.framebuffer("out")
        with framebuffer.bind(), state.confined(3, 5, 2 * WIDTH, 2 * HEIGHT):
            renderer.resolve((3, 5), 2)
        found = readback.read_color(framebuffer, 2 * WIDTH + 3, 2 * HEIGHT + 5)
    renderer.release()
    assert np.array_equal(found[5::2, 3::2], expected)
