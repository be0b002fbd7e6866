"""Depth layers in EXR files: a frame each, a part of the file for each layer.

A part ``layer.NN`` has the channels R, G, B, A (scene linear, premultiplied) and Z (m along the
optical axis, inf where there is nothing), and those of further passes, ``Normal.X`` and so on. The
display window is the picture, the data window the picture with its overscan. Attributes of the
first part's header say in plain words and numbers what other software can use; the attribute
``stack`` has, as JSON with all digits, what a `LayerStack` has besides its pixels.

Rows of EXR files run from the top; here, as everywhere, from the bottom.
"""

import json
import math
import re
from dataclasses import asdict, fields

import numpy as np

from ..errors import InputError, UnfinishedFileError
from ..files.whole_file import reason_of, whole_file
from .exr_file import read_exr
from .layer_stack import DepthLayer, LayerCamera, LayerStack, is_world
from .stack_checks import check_stack

FORMAT = "aplanat-depth-layers"
FORMAT_VERSION = 1
_PART_NAME = re.compile(r"layer\.\d\d+")
_COLOR = "RGBA"
_DEPTH = "Z"
# Passes whose channels are coordinates; of the others three or four channels are colours.
_COORDINATES = ("normal", "position", "vector", "uv", "tangent")
# Of a camera, what files of the first versions have as well.
_ALWAYS_TOLD = ("orthographic", "f_stop", "focus_distance", "focal_length_mm")
_STACK_NUMBERS = ("width", "height", "overscan", "pixel_aspect", "frame", "color_space", "engine")


def save_layers(path, stack, *, words=None, half=False):
    """Write a stack of layers; the file is there whole or not at all.

    Parameters
    ----------
    path : Path
    stack : LayerStack
    words : dict of str to str, optional
        Further attributes of the header.
    half : bool
        Colours in half precision, with values to 65504; depth and passes stay in single precision.

    Raises
    ------
    InputError
        If the layers do not fit together.
    OutputError
        If the file cannot be written.
    """
    import OpenEXR

    check_stack(stack, f"what should become '{path}'")
    left, below = stack.overscan
    display = np.array([0, 0], np.int32), np.array([stack.width - 1, stack.height - 1], np.int32)
    data = (
        np.array([-left, -below], np.int32),
        np.array([stack.width - 1 + left, stack.height - 1 + below], np.int32),
    )
    parts = []
    for number, layer in enumerate(stack.layers):
        # A dictionary for each part: the library writes into it.
        header = {
            "type": OpenEXR.scanlineimage,
            "compression": OpenEXR.ZIP_COMPRESSION,
            "displayWindow": display,
            "dataWindow": data,
            # Of the format, the width of a pixel over its height.
            "pixelAspectRatio": 1.0 / stack.pixel_aspect,
        }
        if number == 0:
            header |= {**(words or {}), **_words(stack)}
        header["passes"] = json.dumps({n: len(names) for n, names in _channels(layer).items()})
        parts.append(OpenEXR.Part(header, _pixels(layer, half), f"layer.{number:02d}"))
    with whole_file(path) as place:
        try:
            OpenEXR.File(parts).write(place)
        except RuntimeError as error:
            raise UnfinishedFileError(
                f"cannot write '{path}': {reason_of(error)}; is the disk full?"
            ) from error


def load_layers(path):
    """Read a stack of layers.

    Parameters
    ----------
    path : Path

    Returns
    -------
    LayerStack

    Raises
    ------
    InputError
        If the file is no capture, of another version, damaged, or not whole.
    """
    parts = read_exr(path)
    header = _known_header(path, parts)
    try:
        told = json.loads(header["stack"])
        bounds = [
            tuple(math.inf if bound is None else float(bound) for bound in (near, far))
            for near, far in told["layers"]
        ]
        stack_numbers = {name: told[name] for name in _STACK_NUMBERS}
        stack_numbers["overscan"] = tuple(told["overscan"])
        camera = _camera(told["camera"])
        report = tuple(told["report"])
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"'{path}' is damaged: its attribute 'stack' cannot be read ({error}); capture again"
        ) from error
    by_name = {part.name: part for part in parts}
    layers = []
    for number, (near, far) in enumerate(bounds):
        name = f"layer.{number:02d}"
        if name not in by_name:
            raise InputError(
                f"'{path}' lacks layer {number} of {len(bounds)} (part '{name}'); capture again"
            )
        layers.append(_layer(path, by_name[name], near, far))
    stack = LayerStack(layers=tuple(layers), camera=camera, report=report, **stack_numbers)
    check_stack(stack, f"'{path}'")
    return stack


def load_words(path):
    """Return the text attributes of a file of layers, without reading its pixels.

    Parameters
    ----------
    path : Path

    Returns
    -------
    dict of str to str

    Raises
    ------
    InputError
        If it is no such file.
    """
    header = _known_header(path, read_exr(path, header_only=True))
    return {name: value for name, value in header.items() if isinstance(value, str)}


def is_layer_file(path):
    """Whether an EXR file has depth layers of this format; other EXR files may be flat input.

    Raises
    ------
    InputError
        If it is no EXR file, or has lost what a file of layers tells of itself.
    """
    parts = read_exr(path, header_only=True)
    if any(part.header.get("format") == FORMAT for part in parts):
        return True
    left = next((part.name for part in parts if _PART_NAME.fullmatch(part.name)), None)
    if left is not None:
        # Taken for any picture with a depth, it would be one layer of many.
        raise InputError(
            f"'{path}' has a part '{left}' as depth layers have, but not their attributes: other"
            " software has written it anew, or its first part is missing; capture again"
        )
    return False


def _known_header(path, parts):
    header = next((p.header for p in parts if p.header.get("format") == FORMAT), None)
    if header is None:
        raise InputError(
            f"'{path}' is an EXR file without depth layers; make one with 'aplanat capture'"
        )
    if header.get("formatVersion") != str(FORMAT_VERSION):
        raise InputError(
            f"'{path}' has version {header.get('formatVersion')} of the format of depth layers;"
            f" this Aplanat reads version {FORMAT_VERSION}: capture again"
        )
    return header


def _words(stack):
    camera = stack.camera
    cuts = [layer.near for layer in stack.layers[1:] if not is_world(layer)]
    told = {name: getattr(stack, name) for name in _STACK_NUMBERS}
    told["report"] = stack.report
    told["camera"] = asdict(camera)
    # JSON knows no infinity.
    told["layers"] = [
        [None if math.isinf(bound) else float(bound) for bound in (layer.near, layer.far)]
        for layer in stack.layers
    ]
    words = {
        "format": FORMAT,
        "formatVersion": str(FORMAT_VERSION),
        "stack": json.dumps(told),
        "layers": str(len(stack.layers)),
        "cuts_m": ", ".join(f"{cut:.6g}" for cut in cuts),
        "engine": stack.engine,
        "colorSpace": stack.color_space,
        "frame": str(stack.frame),
        # Standard attributes of the format, in its units: m, f-number, mm.
        "focus": float(camera.focus_distance),
        "aperture": float(camera.f_stop),
        "nominalFocalLength": float(camera.focal_length_mm),
    }
    if camera.view is not None:
        # The format multiplies rows from the left.
        words["worldToCamera"] = np.array(camera.view, np.float32).T.copy()
    # What no single precision holds is told by `stack` alone.
    return {
        name: value
        for name, value in words.items()
        if not isinstance(value, float) or abs(value) < float(np.finfo(np.float32).max)
    }


def _camera(told):
    values = {each.name: told[each.name] for each in fields(LayerCamera) if each.name in told}
    missing = {"projection", *_ALWAYS_TOLD} - set(values)
    if missing:
        raise KeyError(min(missing))
    if values.get("sensor_mm") is not None:
        width, height = map(float, values["sensor_mm"])
        values["sensor_mm"] = width, height
    if not isinstance(values.get("lens_settings", {}), dict | None):
        raise ValueError("lens_settings are no settings")
    for name in ("projection", "view"):
        if values.get(name) is not None:
            matrix = np.array(values[name], np.float64)
            if matrix.shape != (4, 4) or not np.isfinite(matrix).all():
                raise ValueError(f"{name} is no matrix of 4 x 4 numbers")
            values[name] = tuple(tuple(map(float, row)) for row in matrix)
    return LayerCamera(**values)


def _channels(layer):
    """Return the channels of each pass, in order."""
    return {name: channel_names(name, p.shape[2]) for name, p in layer.passes.items()}


def channel_names(name, count):
    """Return the names of the channels of a pass in EXR files.

    Parameters
    ----------
    name : str
        Of the pass.
    count : int

    Returns
    -------
    tuple of str
        Letters that say whether they are colours, coordinates or Cryptomatte's ids.
    """
    if count == 1:
        letters = "X"
    elif count <= 4:
        is_coordinate = any(word in name.lower() for word in _COORDINATES) or count == 2
        letters = ("XYZW" if is_coordinate else "RGBA")[:count]
        # In lower case no software takes them for colours.
        letters = "rgba"[:count] if name.startswith("Crypto") else letters
    else:
        return tuple(f"{name}.c{i:03d}" for i in range(count))
    return tuple(f"{name}.{letter}" for letter in letters)


def _pixels(layer, half):
    # Rows from the top down.
    kind = np.float16 if half else np.float32
    largest = np.finfo(kind).max
    channels = {
        letter: np.ascontiguousarray(np.clip(layer.color[::-1, :, i], -largest, largest), kind)
        for i, letter in enumerate(_COLOR)
    }
    channels[_DEPTH] = np.ascontiguousarray(layer.depth[::-1], np.float32)
    for name, names in _channels(layer).items():
        for i, channel in enumerate(names):
            pixels = layer.passes[name][::-1, :, i]
            channels[channel] = np.ascontiguousarray(pixels, np.float32)
    return channels


def _layer(path, part, near, far):
    def picture(names):
        missing = [name for name in names if name not in part.channels]
        if missing:
            raise InputError(
                f"'{path}': part '{part.name}' lacks channel '{missing[0]}'; capture again"
            )
        return np.stack([part.channels[name] for name in names], axis=-1).astype(np.float32)

    try:
        counts = json.loads(part.header["passes"])
        passes = {n: channel_names(n, int(count)) for n, count in counts.items()}
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            f"'{path}' is damaged: part '{part.name}' does not tell its passes; capture again"
        ) from error
    return DepthLayer(
        color=picture(_COLOR),
        depth=picture(_DEPTH)[..., 0],
        near=near,
        far=far,
        passes={name: picture(names) for name, names in passes.items()},
    )
