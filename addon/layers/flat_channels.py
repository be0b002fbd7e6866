"""Which channels of an EXR file are the picture, and which one is its depth."""

import re

from ..errors import InputError

# Names of depth channels, the likeliest first: in lower case, without the view layer before them.
_DEPTHS = (
    *(r"depth\.(z|r|v|x|y)", r"z", r"depth", r"z\.(z|r|v|x|y)"),
    *(r"z_?depth(\.\w+)?", r"depth_?z(\.\w+)?", r"(vray|rm|aov|ai)_?(z|z_?depth|depth)(\.\w+)?"),
    *(r"depthpass(\.\w+)?", r"(linear|camera)_?depth(\.\w+)?"),
)
# Layers of colours, the likeliest first; "" are plain R, G, B.
_COLORS = ("", "combined", "composite.combined", "beauty", "rgba", "rgb", "color", "image")
_LISTED = 12


def color_channels(path, parts, layer=None):
    """Find the colours.

    Parameters
    ----------
    path : Path
    parts : list of ExrPart
    layer : str or None
        What stands before ``.R``; None: the likeliest.

    Returns
    -------
    names : tuple of str
        Red, green, blue, and alpha if there is one.
    part : ExrPart

    Raises
    ------
    InputError
    """
    found = []
    for part in parts:
        for name in part.channels:
            stem, letter = _split(name)
            if letter.lower() not in {"r", "red"}:
                continue
            names = _colors_of(part, stem, letter)
            if names:
                found.append((stem or _own_name(part), names, part))
    if layer is not None:
        found = [entry for entry in found if entry[0].lower() == layer.lower()]
    if not found:
        what = f"colours of layer '{layer}'" if layer else "colours (channels R, G and B)"
        raise InputError(f"'{path}' has no {what}; it has {_listed(parts)}")
    return min(found, key=lambda entry: _rank(entry[0]))[1:]


def depth_channel(path, parts, name=None):
    """Find the depth.

    Parameters
    ----------
    path : Path
    parts : list of ExrPart
    name : str or None
        Of its channel, or of the layer if that has one channel; None: the likeliest.

    Returns
    -------
    name : str
        As in the part.
    part : ExrPart

    Raises
    ------
    InputError
    """
    everything = [(channel, part) for part in parts for channel in part.channels]
    if name is not None:
        wanted = name.lower()
        for channel, part in everything:
            if wanted in {
                channel.lower(),
                _full(channel, part).lower(),
                _split(channel)[0].lower(),
            }:
                return channel, part
        raise InputError(
            f"--depth-channel {name}: '{path}' has no such channel; it has {_listed(parts)}"
        )
    for pattern in _DEPTHS:
        for channel, part in everything:
            # Behind any number of layers and views.
            if re.fullmatch(rf"(.*\.)?{pattern}", _full(channel, part).lower()) and not (
                _is_coordinate(channel, part)
            ):
                return channel, part
    raise InputError(
        f"'{path}' has no depth that is known by its name; name one with --depth-channel: it has"
        f" {_listed(parts)}"
    )


def _is_coordinate(channel, part):
    """Whether a channel Z is the third coordinate of something."""
    stem, letter = _split(channel)
    beside = {_split(other)[1].lower() for other in part.channels if _split(other)[0] == stem}
    return letter.lower() in {"x", "y", "z"} and {"x", "y"} <= beside


def _colors_of(part, stem, red):
    letters = ("red", "green", "blue", "alpha") if len(red) > 1 else ("r", "g", "b", "a")
    by_letter = {_split(name)[1].lower(): name for name in part.channels if _split(name)[0] == stem}
    if not all(letter in by_letter for letter in letters[:3]):
        return None
    # In lower case and with a number before them they are Cryptomatte's.
    if red == "r" and re.search(r"crypto|\d\d$", stem.lower()):
        return None
    return tuple(by_letter[letter] for letter in letters if letter in by_letter)


def _rank(stem):
    short = stem.lower()
    for place, known in enumerate(_COLORS):
        if short == known or (known and short.endswith(f".{known}")):
            return place
    return len(_COLORS)


def _split(channel):
    stem, _, letter = channel.rpartition(".")
    return stem, letter


def _own_name(part):
    # The name of a file's only part, or of its main one, says nothing.
    return "" if part.name.lower() in {"", "rgba", "main", "default"} else part.name


def _full(channel, part):
    """Return a channel's name, with the part's name in front if it lacks that."""
    return channel if "." in channel or not part.name else f"{part.name}.{channel}"


def _listed(parts):
    names = [_full(channel, part) for part in parts for channel in part.channels]
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(names[:_LISTED]) + more
