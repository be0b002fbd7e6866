"""Blender's multilayer EXR of one view layer as a picture with its passes."""

from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from .exr_file import read_exr

# In the order that pixels have; files list channels by the alphabet.
_ORDERS = ("RGBA", "rgba", "XYZW", "UVA")


@dataclass(frozen=True, eq=False)
class RenderPicture:
    """What a renderer has drawn.

    Parameters
    ----------
    color : ndarray of shape (height, width, 4)
        float32, scene linear, premultiplied.
    depth : ndarray of shape (height, width)
        float32, m.
    passes : dict of str to ndarray of shape (height, width, channels)
    light : frozenset of str
        Those of the passes that are colours, premultiplied as the picture is.
    words : dict of str to str
        Attributes of the file about Cryptomatte.
    """

    color: np.ndarray
    depth: np.ndarray
    passes: dict[str, np.ndarray]
    light: frozenset[str]
    words: dict[str, str]


def read_render(path, layer):
    """Read what Blender has written of a view layer.

    Parameters
    ----------
    path : Path
    layer : str
        Name of the view layer.

    Returns
    -------
    RenderPicture

    Raises
    ------
    InputError
        If the file has no colours or no depth of this layer.
    """
    passes, words = {}, {}
    for part in read_exr(path):
        words |= {k: v for k, v in part.header.items() if k.startswith("cryptomatte/")}
        for channel, pixels in part.channels.items():
            # A name may have dots itself: the layer is known, the channel is behind the last.
            if channel.startswith(f"{layer}."):
                name, _, letter = channel.removeprefix(f"{layer}.").rpartition(".")
                passes.setdefault(name, {})[letter] = pixels
    if "Combined" not in passes or "Depth" not in passes:
        lost = "picture" if "Combined" not in passes else "depth"
        raise InputError(
            f"the renderer gave no {lost} of view layer '{layer}'; switch the layer on (View Layer"
            " > Use for Rendering)"
        )
    color = _stacked(passes.pop("Combined"))
    if color.shape[2] != 4:
        raise InputError(f"the renderer gave no transparency of view layer '{layer}'")
    depth = _stacked(passes.pop("Depth"))[..., 0]
    light = frozenset(name for name, channels in passes.items() if "R" in channels)
    found = {name: _stacked(channels) for name, channels in passes.items()}
    return RenderPicture(color, depth, found, light, words)


def _stacked(channels):
    letters = sorted(channels, key=_place)
    return np.stack([channels[letter] for letter in letters], axis=-1).astype(np.float32)


def _place(letter):
    for order in _ORDERS:
        if letter in order:
            return order.index(letter), letter
    return len(_ORDERS[0]), letter
