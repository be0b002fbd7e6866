"""A census of the live graphics objects, for leak tests and diagnosis.

Blender's GPU types support neither weak references nor subclasses. So while a census is taken, it
holds a reference to every object made through `addon.device`, and drops those that nothing else
refers to, which the device then frees. Without a census in progress, nothing is recorded.
"""

from contextlib import contextmanager

from . import keeping

_in_progress = []

_KEPT = {"texture", "framebuffer"}

# Bytes of a texel.
TEXEL_BYTES = {
    "RGBA32F": 16,
    "RGBA16F": 8,
    "RGBA8": 4,
    "RG32F": 8,
    "R32F": 4,
    "R16F": 2,
    "R8": 1,
    "R32UI": 4,
    "RG32UI": 8,
    "RGBA32UI": 16,
    "DEPTH_COMPONENT32F": 4,
}


class Census:
    """The graphics objects made since it began."""

    def __init__(self):
        self._entries = []

    def record(self, kind, holder, size):
        """Add an object to the census.

        Parameters
        ----------
        kind : str
        holder : list
            With the object; it may be emptied when the object is gone.
        size : int
            In bytes.
        """
        self._entries.append((kind, size, holder))

    def alive(self):
        """Return the number and the bytes of the objects that are alive.

        Returns
        -------
        dict of str to (int, int)
            By kind: ``"texture"``, ``"framebuffer"``, ``"uniform_buffer"``, ``"vertex_buffer"``,
            ``"index_buffer"``, ``"batch"``.
        """
        # Frame buffers and batches hold textures and buffers: repeat until nothing more dies.
        while True:
            keeping.let_go()
            living = [entry for entry in self._entries if _is_alive(entry[2])]
            if len(living) == len(self._entries):
                break
            self._entries = living
        counts = {}
        for kind, size, _ in self._entries:
            count, total = counts.get(kind, (0, 0))
            counts[kind] = (count + 1, total + size)
        return counts


@contextmanager
def taken():
    """Take a census of what is made inside a `with` block.

    Yields
    ------
    Census
    """
    census = Census()
    _in_progress.append(census)
    try:
        yield census
    finally:
        _in_progress.remove(census)


def record(kind, thing, size=0):
    """Add a new object to the censuses in progress, and return it.

    Textures and frame buffers are kept for the thread that draws; see `keeping`.

    Parameters
    ----------
    kind : str
    thing : object
    size : int
        In bytes.

    Returns
    -------
    object
    """
    holder = keeping.keep(thing) if kind in _KEPT else [thing] if _in_progress else None
    for census in _in_progress:
        census.record(kind, holder, size)
    return thing


def texture_bytes(width, height, texel_format, layers=1):
    """Return how many bytes a texture takes."""
    return width * height * max(layers, 1) * TEXEL_BYTES[texel_format]


def size_of_texture(texture):
    """Return how many bytes a plain 2D texture takes."""
    return texture_bytes(texture.width, texture.height, texture.format)


def _is_alive(holder):
    return bool(holder) and not keeping.is_orphan(holder)
