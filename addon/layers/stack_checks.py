"""Whether a picture as depth layers can be used: numbers of its header and values of its pixels."""

import math
from numbers import Integral, Real

import numpy as np

from ..errors import InputError
from .layer_stack import is_world


def check_stack(stack, name):
    """Refuse a stack that nothing can be made of.

    Parameters
    ----------
    stack : LayerStack
    name : str
        What it is, for messages.

    Raises
    ------
    InputError
    """
    if not stack.layers:
        raise InputError(f"{name} has no layers; capture again")
    _check_picture(stack, name)
    _check_camera(stack.camera, name)
    size = stack.width + 2 * stack.overscan[0], stack.height + 2 * stack.overscan[1]
    for number, layer in enumerate(stack.layers):
        for what, pixels in (
            ("colours", layer.color),
            ("depth", layer.depth),
            *((f"pass '{n}'", p) for n, p in layer.passes.items()),
        ):
            if pixels.shape[1::-1] != size:
                raise InputError(
                    f"{name}: {what} of layer {number} are {pixels.shape[1]} x {pixels.shape[0]}"
                    f" pixels, and picture and overscan {size[0]} x {size[1]}; capture again"
                )
        _check_values(name, number, layer, number == len(stack.layers) - 1)


def _check_picture(stack, name):
    _refuse_others(
        name,
        "the picture's",
        (
            ("width", stack.width, _is_whole(stack.width, 1)),
            ("height", stack.height, _is_whole(stack.height, 1)),
            ("overscan", stack.overscan, all(_is_whole(side, 0) for side in stack.overscan)),
            ("pixel aspect", stack.pixel_aspect, _is_positive(stack.pixel_aspect)),
            ("frame", stack.frame, _is_whole(stack.frame)),
            ("colour space", stack.color_space, isinstance(stack.color_space, str)),
            ("engine", stack.engine, isinstance(stack.engine, str)),
        ),
    )
    nears = [layer.near for layer in stack.layers]
    if any(after < before for before, after in zip(nears, nears[1:], strict=False)):
        raise InputError(f"{name}: the foremost layer is not the first; capture again")


def _check_camera(camera, name):
    projection = np.array(camera.projection, np.float64)
    usable = projection.shape == (4, 4) and np.isfinite(projection).all()
    if not usable or np.linalg.matrix_rank(projection) < 4:
        raise InputError(f"{name}: the camera's projection makes no picture; capture again")
    radius, sensor = camera.aperture_radius, camera.sensor_mm
    _refuse_others(
        name,
        "the camera's",
        (
            ("f-number", camera.f_stop, _is_positive(camera.f_stop)),
            ("focus distance", camera.focus_distance, _is_positive(camera.focus_distance)),
            ("focal length", camera.focal_length_mm, _is_positive(camera.focal_length_mm)),
            ("ratio of the aperture", camera.aperture_ratio, _is_positive(camera.aperture_ratio)),
            ("aperture radius", radius, radius is None or _is_positive(radius)),
            ("number of blades", camera.blades, _is_whole(camera.blades, 0)),
            ("blade rotation", camera.blade_rotation, _is_finite(camera.blade_rotation)),
            ("sensor", sensor, sensor is None or all(map(_is_positive, sensor))),
            ("unit scale", camera.unit_scale, _is_positive(camera.unit_scale)),
            ("kind", camera.orthographic, isinstance(camera.orthographic, bool | np.bool_)),
        ),
    )


def _refuse_others(name, whose, numbers):
    for what, value, is_usable in numbers:
        if not is_usable:
            shown = f"{value:g}" if isinstance(value, Real) else repr(value)
            raise InputError(f"{name}: {whose} {what} is {shown}; capture again")


def _is_finite(value):
    return isinstance(value, Real) and math.isfinite(value)


def _is_positive(value):
    return _is_finite(value) and value > 0.0


def _is_whole(value, least=-math.inf):
    return isinstance(value, Integral) and value >= least


def _check_values(name, number, layer, is_last):
    if not np.isfinite(layer.color).all():
        count = int((~np.isfinite(layer.color)).any(axis=-1).sum())
        raise InputError(
            f"{name}: layer {number} has colours that are no finite numbers at {count} pixels;"
            " capture again"
        )
    depth = layer.depth
    count = int((np.isnan(depth) | (depth < 0.0)).sum())
    if count:
        raise InputError(
            f"{name}: layer {number} has depths that are negative or no numbers at {count} pixels;"
            " capture again"
        )
    if is_last and is_world(layer):
        return
    count = int((np.isinf(depth) & (layer.color[..., 3] > 0.0)).sum())
    if count:
        raise InputError(
            f"{name}: layer {number} has infinite depth at {count} pixels that it covers; only the"
            " world may, as the last layer: capture again"
        )
