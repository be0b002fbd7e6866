"""The camera of a picture with a depth pass: from options, the file's header, or defaults."""

import math

import numpy as np

from .layer_stack import LayerCamera

# Of Blender's own camera.
_FOCAL_LENGTH_MM, _SENSOR_WIDTH_MM, _F_STOP = 50.0, 36.0, 2.8
# Standard attributes of the format.
_FOCAL_LENGTHS = ("pinholeFocalLength", "effectiveFocalLength", "nominalFocalLength")
_SENSORS = ("sensorAcquisitionRectangle", "sensorOverallDimensions")


def flat_camera(header, window, depth, options, report):
    """Return the camera of a picture.

    Parameters
    ----------
    header : dict
        Of the EXR file.
    window : object
        With ``width``, ``height``, ``pixel_aspect`` and ``overscan`` of the picture.
    depth : ndarray of shape (height, width)
        With the overscan, m.
    options : FlatOptions
    report : list of str
        Gets a line for each number that nobody told.

    Returns
    -------
    LayerCamera
    """
    if options.camera is not None:
        return options.camera
    guessed = []

    def number(what, option, names, otherwise, unit):
        if option is not None:
            return option
        for name in names:
            found = _positive(header.get(name))
            if found is not None:
                return found
        guessed.append(f"{what} {otherwise:.4g}{unit}")
        return otherwise

    focal_length = number(
        "focal length", options.focal_length_mm, _FOCAL_LENGTHS, _FOCAL_LENGTH_MM, " mm"
    )
    sensor = number("sensor", options.sensor_width_mm, _SENSORS, _SENSOR_WIDTH_MM, " mm")
    f_stop = number("f-number", options.f_stop, ("aperture",), _F_STOP, "")
    focus = number("focus", options.focus_distance, ("focus",), _middle(depth), " m")
    if guessed:
        report.append(f"the file does not tell its camera: taken are {', '.join(guessed)}")
    width, height = window.width, window.height * window.pixel_aspect
    across = 2.0 * focal_length / sensor * max(width, height) / width
    up = across * width / height
    rows = ((across, 0, 0, 0), (0, up, 0, 0), (0, 0, -1.0002, -0.20002), (0, 0, -1, 0))
    return LayerCamera(
        projection=tuple(tuple(float(value) for value in row) for row in rows),
        f_stop=f_stop,
        focus_distance=focus,
        focal_length_mm=focal_length,
    )


def _positive(value):
    """Return an attribute as a number that may be a length, or None."""
    if value is None:
        return None
    try:
        # Dimensions of a sensor: the first is the width.
        found = float(np.ravel(value)[0])
    except (TypeError, ValueError, IndexError):
        return None
    return found if math.isfinite(found) and found > 0.0 else None


def _middle(depth):
    """Return the depth in the middle of a picture, or near it."""
    rows, columns = depth.shape
    for share in (0.02, 0.2, 1.0):
        y, x = max(1, round(rows * share / 2)), max(1, round(columns * share / 2))
        part = depth[
            max(0, rows // 2 - y) : rows // 2 + y, max(0, columns // 2 - x) : columns // 2 + x
        ]
        if np.isfinite(part).any():
            return float(np.median(part[np.isfinite(part)]))
    return 10.0
