"""Reading EXR files whole: every part with its header and channels.

`OpenEXR.File` reads a file that was cut off without an exception: parts whose pixels are not all
there are missing, and a line is printed. The headers tell how many parts there should be.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import InputError


@dataclass(frozen=True, eq=False)
class ExrPart:
    """One part of an EXR file.

    Parameters
    ----------
    name : str
        Empty in a file of one part, as a rule.
    header : dict
        Attributes, as the OpenEXR package gives them.
    channels : dict of str to ndarray of shape (height, width)
        Rows from the bottom up; empty where only headers were read.
    """

    name: str
    header: dict
    channels: dict[str, np.ndarray]

    @property
    def size(self):
        """Width and height of the data window."""
        (left, top), (right, bottom) = self.header["dataWindow"]
        return int(right) - int(left) + 1, int(bottom) - int(top) + 1


def read_exr(path, header_only=False):
    """Return the parts of an EXR file.

    Parameters
    ----------
    path : Path
    header_only : bool

    Returns
    -------
    list of ExrPart

    Raises
    ------
    InputError
        If there is no such file, it is no EXR file, not whole, or of a kind that is not read.
    """
    import OpenEXR

    path = Path(path)
    if not path.is_file():
        raise InputError(f"file '{path}' does not exist; check the path")
    _check_readable(path)
    try:
        headers = _parts(OpenEXR, path, True)
        for part in headers:
            _check_kind(path, part)
        if header_only:
            return headers
        parts = _parts(OpenEXR, path, False)
    # Whatever the library does not understand of a foreign or damaged file.
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, MemoryError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"'{path}' cannot be read as an EXR file ({_one_line(error)}); is it one, and whole?"
        ) from error
    if len(parts) != len(headers) or any(
        set(read.channels) != _channel_names(known)
        for read, known in zip(parts, headers, strict=True)
    ):
        raise InputError(
            f"'{path}' is not whole: {len(headers) - len(parts) or 'some'} of its {len(headers)}"
            " parts cannot be read to the end; copy or write it again"
        )
    return parts


def _check_readable(path):
    try:
        with open(path, "rb") as file:
            start = file.read(4)
    except OSError as error:
        raise InputError(f"file '{path}' cannot be read: {error.strerror or error}") from error
    # The library tells of neither of these why it fails.
    if start != b"\x76\x2f\x31\x01":
        kind = "is empty" if not start else "is no EXR file"
        raise InputError(f"'{path}' {kind}; name an EXR file")


def _parts(library, path, header_only):
    parts = []
    with library.File(str(path), separate_channels=True, header_only=header_only) as file:
        for part in file.parts:
            channels = {}
            if not header_only:
                # A copy: the pixels are the file's, and end with it.
                channels = {n: np.array(c.pixels[::-1]) for n, c in part.channels.items()}
            parts.append(ExrPart(part.header.get("name", ""), dict(part.header), channels))
    return parts


def _check_kind(path, part):
    kind = str(part.header.get("type", ""))
    if "deep" in kind:
        raise InputError(
            f"'{path}' is a deep EXR file, which is not read; write a flat one with a depth pass"
        )
    for channel in part.header["channels"]:
        if channel.xSampling != 1 or channel.ySampling != 1:
            raise InputError(
                f"'{path}': channel '{channel.name}' has fewer pixels than the picture; write it at"
                " full size"
            )


def _channel_names(part):
    return {channel.name for channel in part.header["channels"]}


def _one_line(error):
    return " ".join(str(error).split())
