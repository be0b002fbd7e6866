"""The passes of the bokeh: the list of highlights and the splat, against numpy."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from addon.device import geometry, readback, shader_source
from addon.device.shaders import ShaderInfo, compile_shader, dispatch
from addon.device.targets import Targets, TargetSpec
from addon.device.textures import texture_2d, texture_array
from addon.device.uniforms import bind_resource, uniform_buffer
from addon.engine.bokeh.look import BokehLook
from addon.lens_bokeh.look.opening import opening_layers
from addon.lens_bokeh.openings.blades import BladedIris
from addon.passes.bokeh import highlights, splat
from addon.passes.bokeh.highlight_list import HighlightList
from addon.passes.bokeh.split_light import SplitLight
from addon.passes.surface import surface
from benchmarks.reference.highlights import Raster
from benchmarks.reference.highlights import highlights as twin

from ..conftest import orthographic, perspective
from .bokeh_scenes import energy

pytestmark = pytest.mark.usefixtures("gpu_context")

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
    float depth = texelFetch(depth_tx, texel, 0).x;
    append_fragment(texel, color.rgb, depth, color.a == 0.0, color.a, 0u, 1.0);
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
        through = np.maximum(rng.uniform(-1.0, 1.0, shape), 0.0).astype(np.float32)
        fragments.append((color, window(depth), through))
    scene = window(rng.uniform(1, 9, shape))
    raster = Raster(projection, parallel, FOCUS, COC_SCALE, LEAST, SUBPIXELS, 2)
    return fragments, scene, raster


def list_on_device(fragments, scene, raster, capacity=4096, room=8192, times=1):
    """Return the list of highlights, listed several times, and the number of sharp ones."""
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
            raster=raster.projection,
            views=(1.0, 1.0, 1.0, 0.0),
            automatic=(0.0, 0.0, 0.0, 0.0),
            size=(width, height, 1.0, 1.0),
        )
    )
    split = SplitLight(split, None, None)
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
    for color, depth, through in fragments:
        append.bind()
        texels = texture_2d(np.concatenate([color, through[..., None]], axis=2))
        depths = texture_2d(depth[..., None], "R32F")
        append.uniform_sampler("color_tx", texels)
        append.uniform_sampler("depth_tx", depths)
        for name, resource in lists.bindings():
            bind_resource(append, name, resource)
        dispatch(append, *(-(-side // 8) for side in scene.shape[::-1]))
    number, tiles, _ = lists.read()
    assert number == sum((color.max(axis=2) > 0.0).sum() for color, _, _ in fragments)
    seen = highlights.SearchedRaster(view, split, raster.subpixels, raster.layers)
    found = HighlightList(room)
    scene = texture_2d(scene[..., None], "R32F")
    highlights.order(seen, lists, number, scene)
    for _ in range(times):
        sharp = found.append(seen, lists, tiles)
    columns = [np.array(texture.read()).reshape(-1, 4) for texture in found.textures]
    lists.release()
    found.release()
    return np.concatenate([c[: found.count] for c in columns], axis=1), sharp


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
    fragments = [(color, depth, np.ones_like(through)) for color, depth, through in fragments]
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


def test_a_full_list_grows_and_keeps_what_it_has():
    # The whole search ran once more where a frame had more highlights than there was room for.
    drawn = fragments_of(6, False)
    once, _ = list_on_device(*drawn)
    thrice, _ = list_on_device(*drawn, room=1024, times=3)
    assert 1024 < len(thrice) == 3 * len(once)
    assert (thrice == np.tile(once, (3, 1))).all()


@functools.cache
def opening_of(iris):
    return opening_layers(iris.coverage)


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
    opening = texture_array(opening_of(iris), "RGBA16F")
    look = BokehLook((), (("opening_tx", opening),), (uniform_buffer(parameters),))
    with Targets(size, size, [TargetSpec("bokeh", "RGBA32F")]) as targets:
        targets.clear("bokeh", (0.0, 0.0, 0.0, 0.0))
        with targets.framebuffer("bokeh").bind():
            densities = splat.splat(geometry.square_batch(), 1, textures, look, view)
        picture = readback.read_color(targets.framebuffer("bokeh"), size, size)
        densities.release()
        return picture


@pytest.mark.parametrize("radius", [1.0, 1.5, -2.2, 3.3, -4.1, 7.5, 20.0, -55.0, 110.0, 200.0])
def test_a_splat_holds_all_light(radius):
    size = int(2 * abs(radius)) + 8
    shares = []
    for shift in np.mgrid[0:4, 0:4].reshape(2, -1).T / 4:
        picture = splatted(radius, shift + size / 2, size=size)
        shares.append(energy(picture) / [1.0, 2.0, 4.0])
        if radius > 30.0:
            break
    # Wherever it lies on the grid of pixels; without the sum over them a disc of one pixel misses
    # 3 %, and one of few pixels up to 1 %.
    assert np.array(shares) == pytest.approx(1.0, abs=5e-4 if abs(radius) < 5.0 else 3e-3)
    assert np.mean(shares, axis=0) == pytest.approx([1.0] * 3, abs=1e-3)


@pytest.mark.parametrize(("iris", "ratio"), [(BladedIris(5, 0.3, 0.0), 1.0), (BladedIris(), 2.0)])
def test_a_splat_of_any_opening_holds_all_light(iris, ratio):
    for radius in (1.2, 25.0):
        picture = splatted(radius, (32.3, 31.6), iris, ratio)
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
