"""Pictures with a depth pass as one layer: names, kinds of depth, guesses that are told."""

import math

import numpy as np
import OpenEXR
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from addon.errors import InputError
from addon.layers.flat_input import FlatOptions, load_flat
from addon.layers.layer_file import load_layers, save_layers
from addon.layers.layer_stack import LayerCamera, is_world
from addon.layers.stack_checks import check_stack

HEIGHT, WIDTH = 6, 8
DEPTH = np.linspace(2.0, 30.0, HEIGHT * WIDTH, dtype=np.float32).reshape(HEIGHT, WIDTH)
COLOR = np.linspace(0.1, 0.9, HEIGHT * WIDTH * 4, dtype=np.float32).reshape(HEIGHT, WIDTH, 4)


def write(path, channels, parts=None, **header):
    """Write channels (rows from the bottom up) as one part, or `parts` by name."""

    def part(name, pixels):
        told = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION} | header
        flipped = {n: np.ascontiguousarray(p[::-1], np.float32) for n, p in pixels.items()}
        return OpenEXR.Part(told, flipped, name)

    named = parts or {"": channels}
    OpenEXR.File([part(name, pixels) for name, pixels in named.items()]).write(str(path))
    return path


def colors(stem=""):
    return {f"{stem}{letter}": COLOR[..., i] for i, letter in enumerate("RGBA")}


@pytest.mark.parametrize(
    "name",
    [
        *("Z", "depth.Z", "Depth.Z", "ViewLayer.Depth.Z", "depth.R", "depth.V", "depth", "ZDepth"),
        *("zdepth.R", "depthZ", "VRayZDepth", "View Layer.Depth.Z", "DepthPass.Y"),
    ],
)
def test_usual_names_of_depth_are_found(name, tmp_path):
    beside = {"Normal.X": DEPTH * 0, "Normal.Y": DEPTH * 0, "Normal.Z": DEPTH * 0}
    stack = load_flat(write(tmp_path / "a.exr", colors() | beside | {name: DEPTH}))
    check_stack(stack, "flat")
    assert np.array_equal(stack.layers[0].depth, DEPTH)
    assert np.array_equal(stack.layers[0].color, COLOR)
    assert any(f"'{name}'" in line for line in stack.report)


def test_parts_of_other_renderers_and_of_blender(tmp_path):
    blender = {
        "ViewLayer.Combined": colors("ViewLayer.Combined."),
        "ViewLayer.Depth": {"ViewLayer.Depth.Z": DEPTH},
        "ViewLayer.Diffuse": {f"ViewLayer.Diffuse.{c}": DEPTH for c in "RGB"},
    }
    other = {"diffuse": {c: DEPTH for c in "RGB"}, "rgba": colors(), "depth": {"Y": DEPTH}}
    for parts in (blender, other):
        stack = load_flat(write(tmp_path / "a.exr", None, parts))
        assert np.array_equal(stack.layers[0].color, COLOR)
        assert np.array_equal(stack.layers[0].depth, DEPTH)


def test_a_channel_may_be_named(tmp_path):
    path = write(tmp_path / "a.exr", colors() | {"Z": DEPTH, "odd.stuff": DEPTH * 2})
    for name in ("odd.stuff", "ODD.stuff", "odd"):
        stack = load_flat(path, FlatOptions(depth_channel=name))
        assert np.array_equal(stack.layers[0].depth, DEPTH * 2)
    with pytest.raises(InputError, match="has no such channel; it has .*odd.stuff"):
        load_flat(path, FlatOptions(depth_channel="none"))


def test_nothing_is_background_and_a_world_of_its_own(tmp_path):
    depth = DEPTH.copy()
    depth[0, :4] = (np.inf, np.nan, 1e10, -1.0)
    color = colors() | {"Z": depth}
    stack = load_flat(write(tmp_path / "a.exr", color))
    near, world = stack.layers
    check_stack(stack, "flat")
    assert is_world(world) and np.isinf(near.depth[0, :4]).all()
    assert np.array_equal(near.color + world.color, COLOR)
    assert not world.color[1:].any() and not near.color[0, :4].any()
    told = " ".join(stack.report)
    assert "no number" in told and "in front of the camera" in told and "hidden" in told


def test_distances_from_the_lens_become_depths(tmp_path):
    focal, sensor = 20.0, 36.0
    x = (np.arange(WIDTH) + 0.5) / WIDTH * sensor - sensor / 2
    y = (np.arange(HEIGHT) + 0.5) / HEIGHT * sensor * HEIGHT / WIDTH - sensor * HEIGHT / WIDTH / 2
    ray = DEPTH * np.sqrt(1.0 + (x[None] / focal) ** 2 + (y[:, None] / focal) ** 2)
    path = write(tmp_path / "a.exr", colors() | {"Z": ray})
    options = FlatOptions(ray=True, focal_length_mm=focal, sensor_width_mm=sensor)
    assert np.allclose(load_flat(path, options).layers[0].depth, DEPTH, rtol=1e-6)


@pytest.mark.parametrize("inverted", [False, True])
def test_normalised_depths_need_their_range(inverted, tmp_path):
    share = (DEPTH - 2.0) / 28.0
    alpha = COLOR.copy()
    # The last pixel is at the far end: nothing is there, and its alpha tells which end that is.
    alpha[-1, -1, 3] = 0.0
    pixels = {letter: alpha[..., i] for i, letter in enumerate("RGBA")}
    path = write(tmp_path / "a.exr", pixels | {"Z": 1.0 - share if inverted else share})
    with pytest.raises(InputError, match="--depth-range"):
        load_flat(path)
    for told in (inverted, None):
        options = FlatOptions(depth_range=(2.0, 30.0), inverted=told)
        layer = load_flat(path, options).layers[0]
        assert np.allclose(layer.depth.ravel()[:-1], DEPTH.ravel()[:-1], rtol=1e-5)
        assert np.isinf(layer.depth[-1, -1])
    assert np.nanmax(load_flat(path, FlatOptions(depth_scale=1.0)).layers[0].depth) > 0.9


def test_one_over_the_depth_and_negative_depths(tmp_path):
    path = write(tmp_path / "a.exr", colors() | {"Z": 1.0 / DEPTH})
    found = load_flat(path, FlatOptions(inverted=True)).layers[0].depth
    assert np.allclose(found, DEPTH, rtol=1e-6)
    path = write(tmp_path / "a.exr", colors() | {"Z": -DEPTH})
    stack = load_flat(path)
    assert np.array_equal(stack.layers[0].depth, DEPTH) and "negative" in " ".join(stack.report)
    path = write(tmp_path / "a.exr", colors() | {"Z": DEPTH * 100})
    found = load_flat(path, FlatOptions(depth_scale=0.01)).layers[0].depth
    assert np.allclose(found, DEPTH)


def test_the_camera_comes_from_the_header_or_options_and_guesses_are_told(tmp_path):
    words = {"nominalFocalLength": 85.0, "aperture": 2.0, "focus": 4.5, "pixelAspectRatio": 2.0}
    path = write(tmp_path / "a.exr", colors() | {"Z": DEPTH}, **words)
    stack = load_flat(path)
    camera = stack.camera
    assert (camera.focal_length_mm, camera.f_stop, camera.focus_distance) == (85.0, 2.0, 4.5)
    assert stack.pixel_aspect == 0.5
    assert math.isclose(camera.projection[0][0], 2 * 85.0 / 36.0)
    told = " ".join(stack.report)
    assert "sensor 36 mm" in told and "focal length" not in told
    assert load_flat(path, FlatOptions(f_stop=1.2)).camera.f_stop == 1.2
    own = LayerCamera(camera.projection, f_stop=9.0)
    assert load_flat(path, FlatOptions(camera=own)).camera is own
    bare = load_flat(write(tmp_path / "b.exr", colors() | {"Z": DEPTH}))
    # In focus is what is in the middle of the picture.
    assert abs(bare.camera.focus_distance - 16.0) < 4.0
    assert "focal length 50 mm" in " ".join(bare.report)


def test_overscan_and_smaller_data_windows(tmp_path):
    def corners(left, top, right, bottom):
        return np.array([left, top], np.int32), np.array([right, bottom], np.int32)

    path = write(
        tmp_path / "a.exr",
        colors() | {"Z": DEPTH},
        dataWindow=corners(-1, -1, 6, 4),
        displayWindow=corners(0, 0, 5, 3),
    )
    stack = load_flat(path)
    assert (stack.width, stack.height, stack.overscan) == (6, 4, (1, 1))
    assert np.array_equal(stack.layers[0].depth, DEPTH)
    path = write(
        tmp_path / "a.exr",
        colors() | {"Z": DEPTH},
        dataWindow=corners(1, 2, 8, 7),
        displayWindow=corners(0, 0, 9, 9),
    )
    stack = load_flat(path)
    assert (stack.width, stack.height, stack.overscan) == (10, 10, (0, 0))
    # Two rows below the data, and two above.
    assert np.array_equal(stack.layers[0].depth[2:8, 1:9], DEPTH)
    assert np.isinf(stack.layers[0].depth[0]).all() and not stack.layers[0].color[9].any()


def test_a_depth_that_ends_before_the_colours_is_told(tmp_path):
    told = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    told["displayWindow"] = np.array([0, 0], np.int32), np.array(DEPTH.shape[::-1], np.int32) - 1
    window = np.array([0, 0], np.int32), np.array([3, 2], np.int32)
    parts = [
        OpenEXR.Part(dict(told), {n: p[::-1].copy() for n, p in colors().items()}, "colors"),
        OpenEXR.Part(told | {"dataWindow": window}, {"Z": DEPTH[:3, :4].copy()}, "depth"),
    ]
    OpenEXR.File(parts).write(str(tmp_path / "a.exr"))
    (line,) = [line for line in load_flat(tmp_path / "a.exr").report if "4 x 3 pixels" in line]
    assert f"{DEPTH.size - 12} of the picture's {DEPTH.size} " in line


def test_colours_in_lower_case_are_found_and_ids_are_not(tmp_path):
    small = {f"beauty.{letter}": COLOR[..., i] for i, letter in enumerate("rgba")}
    stack = load_flat(write(tmp_path / "a.exr", small | {"z": DEPTH}))
    assert np.array_equal(stack.layers[0].color, COLOR)
    ids = {f"CryptoObject00.{letter}": DEPTH for letter in "rgba"}
    stack = load_flat(write(tmp_path / "a.exr", ids | colors() | {"Z": DEPTH}))
    assert np.array_equal(stack.layers[0].color, COLOR)
    with pytest.raises(InputError, match="no colours"):
        load_flat(write(tmp_path / "a.exr", ids | {"Z": DEPTH}))


def test_files_without_colours_or_depth_are_refused_in_one_line(tmp_path):
    for channels, told in (
        ({"Z": DEPTH}, "no colours"),
        (colors(), "--depth-channel"),
        (colors() | {f"P.{c}": DEPTH for c in "XYZ"}, "--depth-channel"),
        (colors() | {"Z": DEPTH * np.nan}, "no depth that is a finite number"),
        (colors() | {"Z": DEPTH * 0}, "depth 0 everywhere"),
    ):
        path = write(tmp_path / "a.exr", channels)
        with pytest.raises(InputError, match=told) as caught:
            load_flat(path)
        assert "\n" not in str(caught.value) and "a.exr" in str(caught.value)
    path = write(tmp_path / "a.exr", colors() | {"Z": DEPTH})
    path.write_bytes(path.read_bytes()[:-50])
    with pytest.raises(InputError, match="not whole"):
        load_flat(path)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=30)
@given(
    values=st.lists(st.floats(width=32), min_size=12, max_size=12),
    scale=st.floats(1e-3, 1e3),
    inverted=st.sampled_from([None, False, True]),
)
def test_whatever_the_depth_holds_a_stack_comes_out_or_a_line(values, scale, inverted, tmp_path):
    depth = np.array(values, np.float32).reshape(3, 4)
    pixels = {letter: np.ones((3, 4), np.float32) for letter in "RGB"}
    path = write(tmp_path / "a.exr", pixels | {"Z": depth})
    try:
        stack = load_flat(path, FlatOptions(depth_scale=scale, inverted=inverted))
    except InputError as error:
        assert "\n" not in str(error)
        return
    check_stack(stack, "flat")
    save_layers(tmp_path / "b.exr", stack)
    assert len(load_layers(tmp_path / "b.exr").layers) == len(stack.layers)
