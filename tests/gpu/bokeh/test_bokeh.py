"""Highlights, from the split to the splat, against numpy and against the reference method."""

from dataclasses import replace

import numpy as np
import pytest

from addon.device import geometry, readback, shader_source
from addon.device.shaders import ShaderInfo, compile_shader, dispatch
from addon.device.targets import Targets, TargetSpec
from addon.device.textures import texture_2d, texture_array
from addon.device.uniforms import bind_resource, uniform_buffer
from addon.engine.bokeh import listing
from addon.engine.bokeh.look import BokehLook
from addon.engine.planning import bokeh_search
from addon.engine.planning.plan import plan_frame
from addon.lens_bokeh.look.iris_mask import BladedIris
from addon.lens_bokeh.look.opening import opening_layers
from addon.passes.bokeh import highlights, splat
from addon.passes.surface import surface
from addon.sampling.highlights import highlight_light
from addon.sampling.iris import Iris
from addon.sampling.thin_lens import ThinLens
from addon.snapshot.scene import BokehSettings
from benchmarks.reference.highlights import Raster
from benchmarks.reference.highlights import highlights as twin

from ..conftest import (
    WORLD_COLOR,
    make_renderer,
    orthographic,
    perspective,
    render_snapshot,
    some_triangles,
    triangles_snapshot,
)

pytestmark = pytest.mark.usefixtures("gpu_context")

PASSES = ("Combined", "Defocus", "Bokeh")
LENS = ThinLens(0.25, 3.0, Iris())
WIDTH, HEIGHT = 96, 64


def lamp(x, y, depth, size):
    """Return a triangle that faces the camera, with its centre of gravity in the middle.

    None of its sides lies along the rows of the raster, where a row more or less is much of it.
    """
    angles = 0.4 + np.arange(3) * 2 * np.pi / 3
    return np.stack([x + size * np.cos(angles), y + size * np.sin(angles), 0 * angles - depth], 1)


def with_bokeh(snapshot, passes=PASSES, **settings):
    """Splat the highlights of a snapshot of the reference method."""
    return replace(
        snapshot,
        camera=replace(snapshot.camera, bokeh=BokehSettings(**settings)),
        sampling=replace(snapshot.sampling, reference_bokeh=True),
        passes=passes,
    )


def energy(picture):
    return picture[..., :3].astype(np.float64).sum(axis=(0, 1))


# Extraction ------------------------------------------------------------------------------------

SUBPIXELS = 3
COC_SCALE, FOCUS, LEAST = 30.0, 3.0, 2.5

# What surfaces do, for light and depths that are given.
APPEND = """
void main()
{
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(texel, textureSize(color_tx, 0)))) {
    return;
  }
  vec4 color = texelFetch(color_tx, texel, 0);
  if (max(color.r, max(color.g, color.b)) > 0.0) {
    append_fragment(texel, color.rgb, texelFetch(depth_tx, texel, 0).x, color.a > 0.5, 0u);
  }
}
"""


def fragments_of(seed, parallel, width=21, height=13):
    """Return fragments of some texels, at depths that differ a little or much, and what hides."""
    rng = np.random.default_rng(seed)
    projection = (orthographic if parallel else perspective)(width, height)
    shape = (height * SUBPIXELS, width * SUBPIXELS)

    def window(depth):
        clip = projection @ np.stack([0 * depth, 0 * depth, -depth, 0 * depth + 1], axis=1)
        return (clip[:, 2] / clip[:, 3] * 0.5 + 0.5).astype(np.float32)

    fragments = []
    for _ in range(3):
        depth = np.where(
            rng.random(shape) < 0.5, rng.uniform(1, 2, shape), rng.uniform(2, 9, shape)
        )
        color = (10.0 ** rng.uniform(-2, 5, (*shape, 3))).astype(np.float32)
        color[rng.random(shape) < 0.7] = 0.0
        fragments.append((color, window(depth), rng.random(shape) < 0.5))
    scene = window(rng.uniform(1, 9, shape))
    raster = Raster(projection, parallel, FOCUS, COC_SCALE, LEAST, SUBPIXELS, 2)
    return fragments, scene, raster


def list_on_device(fragments, scene, raster, capacity=4096):
    """Return the list of highlights and the number of sharp ones."""
    height, width = (side // raster.subpixels for side in scene.shape)
    view = uniform_buffer(
        surface.VIEW_PARAMS.pack(
            view=np.eye(4),
            view_inverse=np.eye(4),
            projection=raster.projection,
            lens=(raster.focus_distance, float(raster.orthographic), raster.coc_scale, 0.5),
            film=(width * raster.subpixels, height * raster.subpixels, 0.0, 0.0),
        )
    )
    split = uniform_buffer(
        surface.HIGHLIGHT_PARAMS.pack(
            split=(1.0, raster.least_coc, 1.0, 0.0),
            world=(0.0, 0.0, 0.0, 0.0),
        )
    )
    append = compile_shader(
        ShaderInfo(
            name="append",
            compute=shader_source.join(
                ("passes/bokeh/highlights_append.glsl", shader_source.Text(APPEND))
            ),
            samplers=(("FLOAT_2D", "color_tx"), ("FLOAT_2D", "depth_tx")),
            images=highlights.APPEND_IMAGES,
            push_constants=highlights.APPEND_CONSTANTS,
            defines=highlights.APPEND_DEFINES,
            local_size=(8, 8, 1),
        )
    )
    lists = highlights.FragmentLists(width, height, raster.subpixels, capacity)
    lists.clear()
    for color, depth, opaque in fragments:
        append.bind()
        texels = texture_2d(np.concatenate([color, opaque[..., None]], axis=2))
        depths = texture_2d(depth[..., None], "R32F")
        append.uniform_sampler("color_tx", texels)
        append.uniform_sampler("depth_tx", depths)
        for name, resource in lists.bindings():
            bind_resource(append, name, resource)
        dispatch(append, *(-(-side // 8) for side in scene.shape[::-1]))
    number, tiles = lists.read()
    assert number == sum((color.max(axis=2) > 0.0).sum() for color, _, _ in fragments)
    seen = highlights.SearchedRaster(view, split, raster.subpixels, raster.layers)
    with Targets(1024, 8, [TargetSpec(name, "RGBA32F") for name in "ab"]) as sources:
        scene = texture_2d(scene[..., None], "R32F")
        highlights.order(seen, lists, number, scene)
        found, sharp = highlights.emit(seen, lists, tiles, (sources["a"], sources["b"]), 0)
        columns = [readback.read_color(sources.framebuffer(name), 1024, 8) for name in "ab"]
    lists.release()
    return np.concatenate([c.reshape(-1, 4)[:found] for c in columns], axis=1), sharp


@pytest.mark.parametrize("parallel", [False, True])
def test_highlights_are_listed_as_by_the_twin(parallel):
    drawn = fragments_of(2, parallel)
    found, sharp = list_on_device(*drawn)
    expected, expected_sharp = twin(*drawn)
    assert sharp == expected_sharp > 0
    assert len(found) == len(expected) > 500
    # Depths come from a depth buffer of 32 bits, and near the least radius, where the share grows
    # from nothing, a small error of the radius is a large one of the share.
    np.testing.assert_allclose(found, expected, rtol=5e-3, atol=1e-5)
    error = np.abs(found - expected) / np.maximum(np.abs(expected), 1e-5)
    assert np.quantile(error, 0.99) < 1e-4


def test_the_list_holds_the_energy_of_the_picture():
    fragments, scene, raster = fragments_of(4, False)
    # Nothing in front, nothing opaque, and every light is blurred more than nothing.
    fragments = [(color, depth, np.zeros_like(opaque)) for color, depth, opaque in fragments]
    found, _ = list_on_device(
        fragments, np.ones_like(scene), replace(raster, least_coc=1e-6, layers=3)
    )
    total = sum(color.astype(np.float64).sum(axis=(0, 1)) for color, _, _ in fragments)
    # To the bar of 1e-5.
    assert found[:, 4:7].astype(np.float64).sum(axis=0) == pytest.approx(
        total / SUBPIXELS**2, rel=1e-5
    )


def test_the_list_is_the_same_every_time():
    drawn = fragments_of(6, False)
    first, second = (list_on_device(*drawn)[0] for _ in range(2))
    assert first.tobytes() == second.tobytes()


# Splat -----------------------------------------------------------------------------------------


def splatted(
    radius, center, iris=None, ratio=1.0, size=64, light=(1.0, 2.0, 4.0), region=0, side=1
):
    """Return the picture of one source with a circle of confusion of a signed radius."""
    iris = iris or BladedIris()
    # An orthographic camera a pixel of which is 1 m: depth sets the radius alone.
    projection = np.diag([2.0 / size, 2.0 / size, -1e-3, 1.0])
    depth = 10.0 + radius
    view = uniform_buffer(
        surface.VIEW_PARAMS.pack(
            view=np.eye(4),
            view_inverse=np.eye(4),
            projection=projection,
            lens=(10.0, 1.0, 10.0, 0.5),
            film=(size, size, 0.0, 0.0),
        )
    )
    parameters = splat.SPLAT_PARAMS.pack(
        opening=(ratio, 1.0, 1.0, side),
        rows=(-1.0, 0.5, 0.0, 0.0),
        field=(1.0, 0.0, 1.0, 0.0),
        rims=np.zeros((splat.MOST_RIMS, 4)),
        wavelength=(1.0, 1.0, 1.0, 0.1),
        dispersion=(0.0, 0.0, 0.0, 0.0),
        spread=(0.0, 0.0, 0.0, 0.0),
    )
    place = np.asarray(center, float) - size / 2
    lists = np.zeros((3, 1, 1024, 4), np.float32)
    lists[0, 0, 0] = (*place, depth, 1.0)
    lists[1, 0, 0] = (*light, region)
    # Nothing hides it.
    lists[2, 0, 0] = (0.0, 0.0, 0.0, 1.0)
    textures = [texture_2d(table) for table in lists]
    textures.append(texture_2d(np.ones((1, 1, 4), np.float32)))
    opening = texture_array(opening_layers(iris.coverage), "RGBA16F")
    look = BokehLook((), (("opening_tx", opening),), (uniform_buffer(parameters),))
    with Targets(size, size, [TargetSpec("bokeh", "RGBA32F")]) as targets:
        targets.clear("bokeh", (0.0, 0.0, 0.0, 0.0))
        with targets.framebuffer("bokeh").bind():
            splat.splat(geometry.square_batch(), 1, textures, look, view)
        return readback.read_color(targets.framebuffer("bokeh"), size, size)


@pytest.mark.parametrize("radius", [3.0, 3.3, -4.1, 7.5, 20.0, -55.0, 110.0, 200.0])
def test_a_splat_holds_all_light(radius):
    size = int(2 * abs(radius)) + 8
    shares = []
    for shift in np.mgrid[0:4, 0:4].reshape(2, -1).T / 4:
        picture = splatted(radius, shift + size / 2, size=size)
        shares.append(energy(picture) / [1.0, 2.0, 4.0])
        if radius > 30.0:
            break
    # What one disc of few pixels loses or wins by their grid, others win or lose.
    assert np.mean(shares, axis=0) == pytest.approx([1.0] * 3, abs=1e-3)
    assert np.array(shares) == pytest.approx(1.0, abs=0.05 * abs(radius) ** -1.5 + 1e-3)


@pytest.mark.parametrize(("iris", "ratio"), [(BladedIris(5, 0.3, 0.0), 1.0), (BladedIris(), 2.0)])
def test_a_splat_of_any_opening_holds_all_light(iris, ratio):
    picture = splatted(25.0, (32.3, 31.6), iris, ratio)
    assert energy(picture) == pytest.approx([1.0, 2.0, 4.0], rel=1e-3)


def test_a_splat_ends_at_its_radius():
    picture = splatted(20.0, (32.0, 32.0))[..., 0]
    y, x = np.mgrid[0:64, 0:64] + 0.5 - 32.0
    radius = np.hypot(x, y)
    even = picture[radius < 18.0]
    # Half precision.
    assert even == pytest.approx(1.0 / (np.pi * 400), rel=2e-3)
    assert (picture[radius > 23.0] == 0.0).all()
    half = np.interp(0.5 / (np.pi * 400), picture[32, 48:60][::-1], x[32, 48:60][::-1])
    assert half == pytest.approx(20.0, abs=0.1)


def test_a_splat_in_front_of_focus_is_point_mirrored():
    iris = BladedIris(3, 0.0, 0.4)
    behind = splatted(15.0, (32.0, 32.0), iris)
    before = splatted(-15.0, (32.0, 32.0), iris)
    assert np.abs(before - behind[::-1, ::-1]).max() < 1e-6
    assert np.abs(before - behind).max() > 1e-3


def test_very_bright_light_neither_overflows_nor_loses_its_neighbours():
    picture = splatted(3.0, (32.0, 32.0), light=(1e5, 1e5, 1e5))
    assert np.isfinite(picture).all()
    assert energy(picture) == pytest.approx([1e5] * 3, rel=1e-2)


# The frame -------------------------------------------------------------------------------------

LAMPS = [lamp(-0.8, 0.3, 8.0, 0.25), lamp(1.2, -0.6, 8.0, 0.3), lamp(-0.15, -0.2, 1.5, 0.05)]
LIGHTS = [(20.0, 10.0, 5.0), (30.0, 30.0, 10.0), (4.0, 16.0, 4.0)]


def lamps(lens=LENS, samples=16, **options):
    return triangles_snapshot(LAMPS, LIGHTS, WIDTH, HEIGHT, lens, samples, **options)


def test_combined_is_the_sum_of_defocus_and_bokeh_to_the_last_bit():
    pictures = render_snapshot(with_bokeh(lamps()))
    assert energy(pictures["Bokeh"]).min() > 0.0
    total = pictures["Defocus"] + pictures["Bokeh"]
    assert pictures["Combined"].tobytes() == total.tobytes()
    # Light alone: what covers the film is all in the samples.
    assert (pictures["Bokeh"][..., 3] == 0.0).all()


def test_without_bokeh_the_passes_are_the_picture_and_black():
    pictures = render_snapshot(replace(lamps(), passes=PASSES))
    assert pictures["Defocus"].tobytes() == pictures["Combined"].tobytes()
    assert (pictures["Bokeh"] == 0.0).all()
    assert pictures["Combined"].tobytes() == render_snapshot(lamps())["Combined"].tobytes()


def test_dark_scenes_keep_their_bits():
    corners, colors = some_triangles()
    plain = triangles_snapshot(corners, colors, WIDTH, HEIGHT, LENS)
    split = render_snapshot(with_bokeh(plain))
    assert split["Combined"].tobytes() == render_snapshot(plain)["Combined"].tobytes()


@pytest.mark.parametrize("iris", [Iris(), Iris(3, 0.4), Iris(5, 0.1, 1.8)])
@pytest.mark.parametrize("parallel", [False, True])
def test_splats_are_what_the_reference_method_converges_to(iris, parallel):
    lens = ThinLens(0.25, 3.0, iris)
    few = with_bokeh(lamps(lens, samples=64, parallel=parallel))
    picture = render_snapshot(few)["Combined"].astype(np.float64)
    many = render_snapshot(lamps(lens, samples=4096, parallel=parallel))["Combined"]
    # Lamps of 3 pixels, met by sub-pixels of a half to a quarter: a few per cent.
    black = np.array(WORLD_COLOR) * WIDTH * HEIGHT
    assert energy(picture) - black == pytest.approx(energy(many) - black, rel=0.03)
    peak = many[..., :3].max()
    error = np.abs(picture - many)[..., :3]
    # Noise of 4096 samples; a disc of another size, place or orientation would differ by its
    # whole brightness along its edges.
    assert np.sqrt((error**2).mean()) < 0.02 * peak
    assert error.max() < 0.25 * peak


@pytest.mark.parametrize("diameter_px", [3.0, 1.2, 0.5])
def test_a_lone_lamp_keeps_its_energy_in_a_slow_pan(diameter_px):
    depth = 8.0
    pixel = 2.0 * 0.5 * depth / WIDTH
    light, found = (20.0, 10.0, 5.0), []
    for step in range(8):
        place = (0.3 + 0.17 * step * pixel, -0.2 + 0.07 * step * pixel)
        corners = lamp(*place, depth, 0.5 * diameter_px * pixel)
        a, b = (corners[i, :2] - corners[0, :2] for i in (1, 2))
        area = 0.5 * abs(a[0] * b[1] - a[1] * b[0]) / pixel**2
        snapshot = triangles_snapshot([corners], [light], WIDTH, HEIGHT, LENS, 4)
        picture = render_snapshot(with_bokeh(snapshot, passes=("Bokeh",)))["Bokeh"]
        found.append(energy(picture)[0] / (area * light[0]))
    assert found == pytest.approx([1.0] * len(found), abs=0.01)


def test_discs_do_not_depend_on_how_finely_the_samples_are_drawn(monkeypatch):
    coarse = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    monkeypatch.setattr("addon.engine.planning.plan.subpixels", lambda *_: 2)
    plan = plan_frame(with_bokeh(lamps()))
    assert plan.subpixels == 2
    assert render_snapshot(with_bokeh(lamps()), plan)["Bokeh"].tobytes() == coarse.tobytes()


def test_light_from_outside_the_frame_reaches_in():
    corners = [lamp(4.25, 0.0, 8.0, 0.1)]
    lights = [(300.0, 300.0, 300.0)]
    plain = triangles_snapshot(corners, lights, WIDTH, HEIGHT, LENS, 16)
    picture = render_snapshot(with_bokeh(plain, overscan=1.0))["Bokeh"]
    assert energy(picture)[0] > 1.0
    assert (picture[:, : WIDTH // 2] == 0.0).all()


def test_tiles_find_what_the_whole_raster_does(monkeypatch):
    whole = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    monkeypatch.setattr(bokeh_search, "_LARGEST_TILE", 1 << 14)
    plan = plan_frame(with_bokeh(lamps())).bokeh
    assert len(bokeh_search.tiles_of(plan.part, plan.subpixels)) > 3
    tiles = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    # The same highlights in another order.
    assert tiles == pytest.approx(whole, abs=1e-5 * float(whole.max()))


def test_surfaces_are_searched_once_however_many_layers_there_are():
    drawn = []
    for layers in (1, 32):
        renderer = make_renderer(with_bokeh(lamps(), layers=layers))
        renderer.advance(1)
        drawn.append(renderer.counts.draw_calls)
        renderer.release()
    assert drawn[0] == drawn[1]


def test_more_fragments_than_there_is_room_for_are_all_found(monkeypatch):
    whole = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    monkeypatch.setattr(listing, "_LEAST_ROOM", 1 << 10)
    monkeypatch.setattr(listing, "_ROOM", 0.0)
    again = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    assert again.tobytes() == whole.tobytes()
    # Now the tile is divided.
    monkeypatch.setattr(listing, "_MOST_ROOM", 1 << 10)
    divided = render_snapshot(with_bokeh(lamps()))["Bokeh"]
    # The same highlights in another order.
    assert divided == pytest.approx(whole, abs=1e-5 * float(whole.max()))


def test_gain_multiplies_what_lies_above_the_threshold():
    gains = (0.0, 1.0, 2.0)
    none, once, twice = (render_snapshot(with_bokeh(lamps(), gain=gain)) for gain in gains)
    above = energy(once["Bokeh"]) - energy(none["Bokeh"])
    assert energy(twice["Bokeh"]) - energy(once["Bokeh"]) == pytest.approx(above, rel=1e-5)
    assert twice["Defocus"].tobytes() == none["Defocus"].tobytes()


def test_the_split_on_the_device_is_that_of_the_twin():
    # A lamp that fills the frame, far out of focus: every sample keeps the same.
    corners = [lamp(0.0, 0.0, 1.0, 9.0)]
    light = (3.0, 0.3, 0.03)
    snapshot = triangles_snapshot(corners, [light], 16, 16, ThinLens(1.0, 3.0), 1)
    kept = render_snapshot(with_bokeh(snapshot, threshold=2.0))["Defocus"]
    expected = np.array(light) - highlight_light(np.array(light), 2.0)
    assert kept[..., :3].reshape(-1, 3) == pytest.approx(np.tile(expected, (256, 1)), rel=1e-6)


def test_highlights_are_counted():
    renderer = make_renderer(with_bokeh(lamps()))
    renderer.advance(1)
    counts = renderer.highlights
    assert counts.found == counts.clustered + counts.culled_size > 0
    assert counts.splatted <= counts.clustered
    renderer.release()


def test_samples_go_on_from_the_same_bokeh():
    renderer = make_renderer(with_bokeh(lamps()))
    renderer.advance(1)
    first = renderer.read_passes(("Bokeh",))["Bokeh"]
    renderer.advance(15)
    assert renderer.read_passes(("Bokeh",))["Bokeh"].tobytes() == first.tobytes()
    renderer.release()
