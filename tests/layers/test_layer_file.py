"""Files of depth layers: what is written is read, and what is broken is refused in one line."""

import json
import math
from dataclasses import fields, replace

import numpy as np
import OpenEXR
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from addon.errors import InputError, UnfinishedFileError
from addon.layers.exr_file import read_exr
from addon.layers.layer_file import is_layer_file, load_layers, load_words, save_layers
from addon.layers.layer_stack import DepthLayer, LayerCamera, LayerStack

EYE = tuple(tuple(map(float, row)) for row in np.eye(4))
_numbers = st.floats(1e-30, 1e30)
_text = st.text(st.characters(codec="ascii", exclude_categories=["C"]), max_size=20)


def assert_same(found, expected):
    for each in fields(LayerStack):
        if each.name != "layers":
            assert getattr(found, each.name) == getattr(expected, each.name), each.name
    assert len(found.layers) == len(expected.layers)
    for one, other in zip(found.layers, expected.layers, strict=True):
        assert (one.near, one.far) == (other.near, other.far)
        assert list(one.passes) == list(other.passes)
        for a, b in (
            (one.color, other.color),
            (one.depth, other.depth),
            *((one.passes[name], other.passes[name]) for name in one.passes),
        ):
            assert a.dtype == np.float32 and np.array_equal(a, b)


@st.composite
def stacks(draw):
    width, height = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    overscan = draw(st.tuples(st.integers(0, 3), st.integers(0, 2)))
    size = height + 2 * overscan[1], width + 2 * overscan[0]
    finite = st.floats(-(2.0**120), 2.0**120, width=32)
    names = draw(
        st.lists(
            st.tuples(
                st.sampled_from(["Normal", "Diffuse Direct", "UV", "my.aov", "CryptoObject00"]),
                st.integers(1, 5),
            ),
            unique_by=lambda pair: pair[0],
            max_size=3,
        )
    )
    layers = []
    nears = draw(st.lists(st.floats(0.0, 1e30), min_size=1, max_size=3).map(sorted))
    for near in nears:
        depth = draw(hnp.arrays(np.float32, size, elements=st.floats(0.0, 2.0**120, width=32)))
        color = draw(hnp.arrays(np.float32, (*size, 4), elements=finite))
        color[..., 3] = np.clip(color[..., 3], 0.0, 1.0)
        empty = draw(hnp.arrays(bool, size))
        depth[empty], color[empty] = np.inf, 0.0
        layers.append(
            DepthLayer(
                color,
                depth,
                near,
                draw(st.floats(0.0, allow_nan=False)),
                {
                    name: draw(hnp.arrays(np.float32, (*size, count), elements=finite))
                    for name, count in names
                },
            )
        )
    matrix = tuple(draw(st.tuples(*[st.floats(-1e3, 1e3)] * 4)) for _ in range(4))
    assume(np.linalg.matrix_rank(np.array(matrix)) == 4)
    camera = LayerCamera(
        projection=matrix,
        orthographic=draw(st.booleans()),
        f_stop=draw(_numbers),
        focus_distance=draw(_numbers),
        focal_length_mm=draw(_numbers),
        aperture_radius=draw(st.none() | _numbers),
        blades=draw(st.integers(0, 16)),
        blade_rotation=draw(st.floats(-7.0, 7.0)),
        aperture_ratio=draw(_numbers),
        view=draw(st.none() | st.just(matrix)),
    )
    return LayerStack(
        layers=tuple(layers),
        camera=camera,
        width=width,
        height=height,
        overscan=overscan,
        pixel_aspect=draw(st.floats(0.1, 10.0)),
        frame=draw(st.integers(-1000, 1000)),
        color_space=draw(_text),
        engine=draw(_text),
        report=tuple(draw(st.lists(_text, max_size=2))),
    )


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
@given(stack=stacks())
def test_a_stack_that_is_read_back_is_the_stack_that_was_written(stack, tmp_path):
    save_layers(tmp_path / "a.exr", stack, words={"settings": "x"})
    assert_same(load_layers(tmp_path / "a.exr"), stack)
    assert load_words(tmp_path / "a.exr")["settings"] == "x"


def small_stack():
    color = np.linspace(0.0, 1.0, 6 * 8 * 4, dtype=np.float32).reshape(6, 8, 4)
    depth = np.full((6, 8), 3.0, np.float32)
    world = DepthLayer(np.ones_like(color), np.full_like(depth, np.inf), 9.0)
    passes = {"Normal": color[..., :3].copy()}
    layers = (
        DepthLayer(color, depth, 0.0, 4.0, passes),
        DepthLayer(color, depth, 4.0, np.inf, passes),
        world,
    )
    return LayerStack(layers, LayerCamera(EYE, focus_distance=7.0, view=EYE), 6, 4, (1, 1))


@pytest.fixture
def written(tmp_path):
    save_layers(tmp_path / "layers.exr", small_stack())
    return tmp_path / "layers.exr"


def test_half_precision_keeps_depth_and_rounds_colours(tmp_path):
    stack = small_stack()
    save_layers(tmp_path / "a.exr", stack, half=True)
    found = load_layers(tmp_path / "a.exr").layers[0]
    assert np.array_equal(found.depth, stack.layers[0].depth)
    expected = stack.layers[0].color.astype(np.float16).astype(np.float32)
    assert np.array_equal(found.color, expected)


def test_other_software_finds_picture_overscan_and_lens(written):
    with OpenEXR.File(str(written), separate_channels=True) as file:
        header, channels = file.parts[0].header, file.parts[0].channels
        assert [part.name() for part in file.parts] == ["layer.00", "layer.01", "layer.02"]
        assert {"R", "G", "B", "A", "Z", "Normal.X", "Normal.Y", "Normal.Z"} == set(channels)
        assert [list(map(int, corner)) for corner in header["displayWindow"]] == [[0, 0], [5, 3]]
        assert [list(map(int, corner)) for corner in header["dataWindow"]] == [[-1, -1], [6, 4]]
        assert header["focus"] == 7.0 and header["cuts_m"] == "4"
        # Rows of the file run from the top.
        top = small_stack().layers[0].color[-1, :, 0]
        assert np.array_equal(np.asarray(channels["R"].pixels)[0], top)
    assert is_layer_file(written)


def refusal(path):
    with pytest.raises(InputError) as caught:
        load_layers(path)
    line = str(caught.value)
    assert str(path) in line and "\n" not in line
    return line


@pytest.mark.parametrize("share", [0.0, 0.02, 0.3, 0.5, 0.7, 0.9, 0.999])
def test_a_file_that_was_cut_off_is_refused(written, share):
    whole = written.read_bytes()
    written.write_bytes(whole[: int(share * len(whole))])
    refusal(written)


def test_a_file_that_is_not_there_or_something_else_is_refused(tmp_path):
    assert "does not exist" in refusal(tmp_path / "none.exr")
    (tmp_path / "a.exr").write_bytes(b"\x89PNG\r\n" * 9)
    assert "no EXR file" in refusal(tmp_path / "a.exr")
    pixels = np.zeros((4, 4, 3), np.float32)
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": pixels}).write(str(tmp_path / "b.exr"))
    assert "without depth layers" in refusal(tmp_path / "b.exr")
    assert not is_layer_file(tmp_path / "b.exr")


def rewritten(path, change):
    """Write a file's parts anew after `change(number, name, header, channels)`; None drops one."""
    parts = []
    for number, part in enumerate(read_exr(path)):
        header = {k: v for k, v in part.header.items() if k not in {"channels", "chunkCount"}}
        channels = {n: np.ascontiguousarray(p[::-1]) for n, p in part.channels.items()}
        if change(number, header, channels) is not False:
            parts.append(OpenEXR.Part(header, channels, part.name))
    OpenEXR.File(parts).write(str(path))


def test_a_missing_layer_or_channel_is_named(written, tmp_path):
    rewritten(written, lambda number, _header, _channels: number != 1)
    assert "lacks layer 1 of 3" in refusal(written)
    save_layers(written, small_stack())
    rewritten(written, lambda number, _header, channels: channels.pop("Z") is not None)
    assert "lacks channel 'Z'" in refusal(written)


def test_sizes_that_do_not_fit_are_refused(written):
    def change(number, header, _channels):
        if number == 0:
            told = json.loads(header["stack"])
            header["stack"] = json.dumps(told | {"width": 77})

    rewritten(written, change)
    assert "8 x 6 pixels" in refusal(written) or "79" in refusal(written)


@pytest.mark.parametrize(
    ("channel", "value", "told"),
    [
        ("Z", np.nan, "no numbers"),
        ("Z", -1.0, "negative"),
        ("Z", np.inf, "infinite depth"),
        ("R", np.nan, "no finite numbers"),
        ("G", np.inf, "no finite numbers"),
    ],
)
def test_values_that_are_no_numbers_are_refused(written, channel, value, told):
    def change(number, _header, channels):
        if number == 0:
            channels[channel][2, 3] = value

    rewritten(written, change)
    line = refusal(written)
    assert told in line and "layer 0" in line and "1 pixel" in line


def test_another_version_and_broken_numbers_are_refused(written):
    rewritten(written, lambda _n, header, _c: header.update(formatVersion="2"))
    assert "version 2" in refusal(written)
    save_layers(written, small_stack())

    def change(number, header, _channels):
        if number == 0:
            header["stack"] = header["stack"].replace('"camera"', '"kamera"')

    rewritten(written, change)
    assert "'stack'" in refusal(written)


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("projection", ((0.0,) * 4,) * 4, "projection"),
        ("f_stop", 0.0, "f-number is 0"),
        ("f_stop", math.nan, "f-number is nan"),
        ("focus_distance", -1.0, "focus distance is -1"),
        ("focus_distance", "near", "focus distance is 'near'"),
        ("blades", "five", "number of blades is 'five'"),
        ("blades", -3, "number of blades is -3"),
        ("blade_rotation", math.inf, "blade rotation is inf"),
        ("aperture_radius", -1.0, "aperture radius is -1"),
        ("sensor_mm", (0.0, 0.0), "sensor is"),
        ("unit_scale", math.nan, "unit scale is nan"),
        ("orthographic", "yes", "kind is 'yes'"),
    ],
)
def test_a_camera_that_makes_no_picture_is_refused(name, value, told, tmp_path):
    stack = small_stack()
    stack = replace(stack, camera=replace(stack.camera, **{name: value}))
    with pytest.raises(InputError, match=told):
        save_layers(tmp_path / "a.exr", stack)


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("width", 6.5, "width is 6.5"),
        ("overscan", [-1, 0], "overscan is"),
        ("pixel_aspect", 0, "pixel aspect is 0"),
        ("frame", "x", "frame is 'x'"),
        ("engine", None, "engine is None"),
        ("layers", 7, "'stack' cannot be read"),
        ("layers", [[5.0, None], [0.0, 5.0], [None, None]], "the foremost layer is not the first"),
    ],
)
def test_numbers_of_a_picture_that_are_none_are_refused(name, value, told, written):
    def change(number, header, _channels):
        if number == 0:
            header["stack"] = json.dumps(json.loads(header["stack"]) | {name: value})

    rewritten(written, change)
    assert told in refusal(written)


def test_layers_that_lost_their_attributes_are_no_picture_with_a_depth_pass(written):
    def forget(_number, header, _channels):
        for name in ("format", "formatVersion", "stack", "passes"):
            header.pop(name, None)

    kept = written.read_bytes()
    for change in (forget, lambda number, _header, _channels: number != 0):
        written.write_bytes(kept)
        rewritten(written, change)
        with pytest.raises(InputError, match="but not their attributes"):
            is_layer_file(written)


def test_layers_that_do_not_fit_are_not_written(tmp_path):
    stack = small_stack()
    with pytest.raises(InputError, match="layer 0 are"):
        save_layers(tmp_path / "a.exr", replace(stack, width=5))
    with pytest.raises(InputError, match="no layers"):
        save_layers(tmp_path / "a.exr", replace(stack, layers=()))
    assert not list(tmp_path.iterdir())


def test_a_file_that_cannot_be_written_leaves_the_old_one(written, monkeypatch):
    before = written.read_bytes()

    def fail(*_):
        raise RuntimeError("disk\nfull")

    monkeypatch.setattr(OpenEXR.File, "write", fail)
    with pytest.raises(UnfinishedFileError, match="disk full"):
        save_layers(written, small_stack())
    assert written.read_bytes() == before
    assert [path.name for path in written.parent.iterdir()] == [written.name]
