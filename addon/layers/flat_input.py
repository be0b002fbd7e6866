"""Any picture with a depth pass as layers: its surfaces are one, and the world behind is another.

What a file does not tell is guessed, and every guess is a line of the stack's report.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from ..errors import InputError
from .exr_file import read_exr
from .flat_camera import flat_camera
from .flat_channels import color_channels, depth_channel
from .layer_stack import DepthLayer, LayerCamera, LayerStack
from .slices import NOTHING

# Depths whose largest is this near to 1, and none larger, look as if they were normalised.
_LOOKS_NORMALISED = 0.98


# Least alpha of a picture without holes: half precision ends there.
_OPAQUE = 0.999


@dataclass(frozen=True)
class FlatOptions:
    """The user's options for a picture with a depth pass; None is guessed.

    Parameters
    ----------
    depth_channel : str or None
        Name of the depth's channel.
    color_layer : str or None
        What stands before ``.R`` in the names of the colours' channels.
    ray : bool or None
        Depth is the distance from the lens, not the one along the optical axis.
    depth_range : tuple of 2 float or None
        Depths in m that the values 0 and 1 stand for; the values are normalised then.
    inverted : bool or None
        Normalised values are 1 at the near end; others are one over the depth.
    depth_scale : float or None
        Metres in a unit of depth; None: one, if they do not look normalised.
    camera : LayerCamera or None
        Of the scene, instead of all that follows.
    focal_length_mm, sensor_width_mm, f_stop, focus_distance : float or None
    """

    depth_channel: str | None = None
    color_layer: str | None = None
    ray: bool | None = None
    depth_range: tuple[float, float] | None = None
    inverted: bool | None = None
    depth_scale: float | None = None
    camera: LayerCamera | None = None
    focal_length_mm: float | None = None
    sensor_width_mm: float | None = None
    f_stop: float | None = None
    focus_distance: float | None = None


def load_flat(path, options=None):
    """Read a picture with a depth pass.

    Parameters
    ----------
    path : Path
    options : FlatOptions, optional

    Returns
    -------
    LayerStack
        One layer, and behind it a world where the depth is infinite.

    Raises
    ------
    InputError
        If the file has no colours or no depth that can be used.
    """
    options = options or FlatOptions()
    parts = read_exr(path)
    names, color_part = color_channels(path, parts, options.color_layer)
    depth_name, depth_part = depth_channel(path, parts, options.depth_channel)
    window = _Window(color_part.header)
    report = [
        f"colours are {', '.join(names)}; depth is channel '{depth_name}'",
        "one layer does not know what is hidden behind something: where near things are blurred,"
        " what is around them is seen instead",
    ]
    color = np.stack([window.placed(color_part, name, 0.0) for name in names], axis=-1)
    if len(names) == 3:
        color = np.concatenate([color, window.placed(color_part, None, 1.0)[..., None]], axis=-1)
    color = color.astype(np.float32)
    _mend_colors(color, report)
    depth = window.placed(depth_part, depth_name, np.inf).astype(np.float64)
    _check_covered(window, (color_part, names[0]), (depth_part, depth_name), report)
    depth = _in_metres(path, depth, color[..., 3], depth_name, options, report)
    camera = flat_camera(color_part.header, window, depth, options, report)
    if options.ray and not camera.orthographic:
        depth = depth * _cosines(camera, window)
    elif options.ray is None:
        report.append("depth is taken for the distance along the optical axis, not from the lens")
    return LayerStack(
        layers=_layers(color, depth.astype(np.float32)),
        camera=camera,
        width=window.width,
        height=window.height,
        overscan=window.overscan,
        pixel_aspect=window.pixel_aspect,
        frame=_frame(color_part.header),
        color_space="",
        engine=str(color_part.header.get("software", color_part.header.get("Software", ""))),
        report=tuple(report),
        fills=bool(color[..., 3].min(initial=1.0) >= _OPAQUE),
    )


class _Window:
    """The picture of a file, its overscan, and where channels lie in them.

    A data window that is larger than the picture on all sides is overscan; one that is smaller is
    filled up.
    """

    def __init__(self, header):
        (left, top), (right, bottom) = _corners(header["displayWindow"])
        (data_left, data_top), (data_right, data_bottom) = _corners(header["dataWindow"])
        self.width, self.height = right - left + 1, bottom - top + 1
        self.overscan = (
            max(0, min(left - data_left, data_right - right)),
            max(0, min(top - data_top, data_bottom - bottom)),
        )
        self._corner = left - self.overscan[0], bottom + self.overscan[1]
        # Of the format, the width of a pixel over its height.
        ratio = float(header.get("pixelAspectRatio", 1.0))
        self.pixel_aspect = 1.0 / ratio if math.isfinite(ratio) and ratio > 0.0 else 1.0

    @property
    def shape(self):
        """Rows and columns with the overscan."""
        return self.height + 2 * self.overscan[1], self.width + 2 * self.overscan[0]

    def placed(self, part, name, otherwise):
        """Return a channel in this window; `otherwise` where the part has no pixels."""
        pixels = np.full(self.shape, otherwise)
        if name is None:
            return pixels
        (left, _), (_, bottom) = _corners(part.header["dataWindow"])
        source = part.channels[name]
        # Both from the bottom up: the first row of each is its lowest.
        x, y = left - self._corner[0], self._corner[1] - bottom
        rows, columns = self.shape
        x0, x1 = max(0, x), min(columns, x + source.shape[1])
        y0, y1 = max(0, y), min(rows, y + source.shape[0])
        if x0 < x1 and y0 < y1:
            pixels[y0:y1, x0:x1] = source[y0 - y : y1 - y, x0 - x : x1 - x]
        return pixels


def _check_covered(window, color, depth, report):
    """Report a depth that ends before the colours do; both as a part and its channel."""
    colored, known = (
        window.placed(replace(part, channels={"": np.ones(part.channels[name].shape)}), "", 0.0)
        for part, name in (color, depth)
    )
    missing = int(((colored > 0.0) & (known == 0.0)).sum())
    if missing:
        part, name = depth
        rows, columns = part.channels[name].shape
        report.append(
            f"channel '{name}' has {columns} x {rows} pixels and leaves {missing} of the picture's"
            f" {int(colored.sum())} without a depth: taken for background"
        )


def _corners(window):
    return tuple(tuple(int(value) for value in corner) for corner in window)


def _mend_colors(color, report):
    broken = ~np.isfinite(color).all(axis=-1)
    if broken.any():
        color[broken] = np.where(np.isfinite(color[broken]), color[broken], 0.0)
        report.append(f"{int(broken.sum())} pixels have colours that are no numbers: taken for 0")
    color[..., 3] = np.clip(color[..., 3], 0.0, 1.0)


def _in_metres(path, depth, coverage, name, options, report):
    """Return depths in m, inf where there is no surface."""
    count = int(np.isnan(depth).sum())
    if count:
        report.append(f"{count} pixels have a depth that is no number: taken for background")
    values = np.where(np.isnan(depth) | (np.abs(depth) >= NOTHING), np.inf, depth)
    known = np.isfinite(values)
    if not known.any():
        raise InputError(
            f"'{path}': channel '{name}' has no depth that is a finite number; name another one"
            " with --depth-channel"
        )
    if options.depth_range is None and not values[known].any():
        raise InputError(
            f"'{path}': channel '{name}' has depth 0 everywhere; name another one with"
            " --depth-channel"
        )
    if options.depth_range is None and (values[known] < 0.0).mean() > 0.9:
        values = -values
        report.append("depths are negative: taken for positions before the camera, turned round")
        values[~known] = np.inf
    if options.depth_range is not None:
        values = _from_range(values, coverage, options, report)
    elif options.inverted:
        values = np.divide(1.0, values, out=np.full_like(values, np.inf), where=values > 0.0)
    elif options.depth_scale is None and _looks_normalised(values[known]):
        raise InputError(
            f"'{path}': depths of channel '{name}' end at 1, as if they were normalised; give the"
            " depths that 0 and 1 stand for (--depth-range NEAR,FAR), or --depth-scale 1 if they"
            " are metres"
        )
    values = values * (options.depth_scale or 1.0)
    behind = values <= 0.0
    if behind.any():
        report.append(
            f"{int(behind.sum())} pixels have no depth in front of the camera: taken for background"
        )
    return np.where(behind, np.inf, values)


def _looks_normalised(values):
    return _LOOKS_NORMALISED <= values.max() <= 1.0 and values.min() >= 0.0


def _from_range(values, coverage, options, report):
    near, far = options.depth_range
    inverted = options.inverted
    if inverted is None:
        # What covers nothing is as far as can be: black there means that white is near.
        empty = values[(coverage == 0.0) & np.isfinite(values)]
        inverted = bool(empty.size and np.median(empty) < 0.5)
        report.append(f"depth is normalised, and {'1' if inverted else '0'} taken for the near end")
    share = np.clip(1.0 - values if inverted else values, 0.0, np.inf)
    found = near + (far - near) * share
    # The far end itself is where nothing is.
    return np.where(np.isfinite(values) & (share < 1.0), found, np.inf)


def _cosines(camera, window):
    """Return the cosine of each pixel's ray to the optical axis; shape (height, width)."""
    rows, columns = window.shape
    projection = np.array(camera.projection)
    x = (np.arange(columns) + 0.5 - window.overscan[0]) / window.width * 2.0 - 1.0
    y = (np.arange(rows) + 0.5 - window.overscan[1]) / window.height * 2.0 - 1.0
    across = (x + projection[0, 2]) / projection[0, 0]
    up = (y + projection[1, 2]) / projection[1, 1]
    return 1.0 / np.sqrt(1.0 + across[None, :] ** 2 + up[:, None] ** 2)


def _layers(color, depth):
    nothing = ~np.isfinite(depth)
    surface = np.where(nothing[..., None], 0.0, color).astype(np.float32)
    near = DepthLayer(surface, np.where(surface[..., 3] > 0.0, depth, np.inf).astype(np.float32))
    world = np.where(nothing[..., None], color, 0.0).astype(np.float32)
    if not world[..., 3].any():
        return (near,)
    return near, DepthLayer(world, np.full_like(depth, np.inf), math.inf)


def _frame(header):
    for name in ("Frame", "frame", "imageCounter"):
        try:
            return int(header[name])
        except (KeyError, TypeError, ValueError):
            continue
    return 1
