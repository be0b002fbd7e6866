"""Whether a picture file that other software wrote is there to its end.

Blender writes what fits on a full disk, and says nothing. Formats tell where they end: PNG and
JPEG by their last bytes, OpenEXR by a table of its chunks before the first of them.
"""

import os
import struct

_PNG, _PNG_END = b"\x89PNG\r\n\x1a\n", b"\x00\x00\x00\x00IEND\xaeB`\x82"
_JPEG, _JPEG_END = b"\xff\xd8\xff", b"\xff\xd9"
_EXR = b"\x76\x2f\x31\x01"
# Flags of an EXR file's version: what is not made of rows, and several parts.
_TILED, _DEEP, _MULTIPART = 0x200, 0x800, 0x1000
# A header is some kilobytes; Cryptomatte's manifests are the longest things in it.
_MOST_HEADER = 1 << 28


def is_whole_picture(path):
    """Whether a picture file is not empty, and not cut off.

    Parameters
    ----------
    path : Path
        A file of a format that is not known counts as whole if it is not empty.

    Returns
    -------
    bool
    """
    try:
        with open(path, "rb") as file:
            size = os.fstat(file.fileno()).st_size
            start = file.read(8)
            if start == _PNG:
                return _ends_with(file, size, _PNG_END)
            if start.startswith(_JPEG):
                return _ends_with(file, size, _JPEG_END)
            if start.startswith(_EXR):
                return _has_all_chunks(file, size, struct.unpack("<I", start[4:])[0])
            return size > 0
    except OSError:
        return False


def _ends_with(file, size, end):
    file.seek(max(0, size - len(end)))
    return file.read() == end


def _has_all_chunks(file, size, version):
    """Whether the chunks that an EXR file's table tells of are there; `file` is behind the version.

    Parts' tables follow the headers, and the first chunk follows the tables. Chunks that were not
    written have the offset 0.
    """
    if not _skip_headers(file, bool(version & _MULTIPART)):
        return False
    place, first, last = file.tell(), size, 0
    while place < first:
        word = file.read(8)
        if len(word) < 8:
            return False
        offset = struct.unpack("<Q", word)[0]
        place += 8
        if not place <= offset < size:
            return False
        first, last = min(first, offset), max(last, offset)
    if version & (_TILED | _DEEP) or not last:
        return bool(last)
    # Of a chunk of rows: its part, if there are several, its first row, and its size.
    file.seek(last + (8 if version & _MULTIPART else 4))
    word = file.read(4)
    return len(word) == 4 and file.tell() + struct.unpack("<I", word)[0] <= size


def _skip_headers(file, multipart):
    """Go behind the headers of an EXR file; False if it ends before."""
    while True:
        empty = True
        while name := _read_name(file):
            empty = False
            kind, length = _read_name(file), file.read(4)
            if kind is None or len(length) < 4:
                return False
            count = struct.unpack("<I", length)[0]
            if count > _MOST_HEADER or len(file.read(count)) < count:
                return False
        # None is the file's end, an empty name that of a header, an empty header that of all.
        if name is None:
            return False
        if empty or not multipart:
            return True


def _read_name(file):
    name = bytearray()
    while byte := file.read(1):
        if byte == b"\x00":
            return bytes(name)
        name += byte
    return None
