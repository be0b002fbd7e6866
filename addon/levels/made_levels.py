"""Memory cache of levels of detail, by the content of their meshes."""

from collections import OrderedDict


class MadeLevels:
    """Levels of detail by content; unused ones are dropped when they take too much memory.

    Not safe to use from several threads at once: `LevelStore` holds its lock meanwhile.

    Parameters
    ----------
    memory_limit : int
        Most bytes of unused levels.

    Attributes
    ----------
    bytes : int
        Of all levels that are here.
    """

    def __init__(self, memory_limit):
        self._memory_limit = memory_limit
        self._levels = OrderedDict()
        self._sizes = {}

    def __contains__(self, key):
        """Whether the levels of a key are cached."""
        return key in self._levels

    @property
    def bytes(self):
        """Bytes of all levels that are here."""
        return sum(self._sizes.values())

    def get(self, key):
        """Return the levels of a key, or None."""
        return self._levels.get(key)

    def add(self, key, levels):
        """Add levels.

        Parameters
        ----------
        key : bytes
            See `level_making.content_key`.
        levels : tuple of MeshLevel
        """
        self._levels[key] = levels
        self._sizes[key] = size_of_levels(levels)

    def clear(self):
        """Remove all levels."""
        self._levels.clear()
        self._sizes.clear()

    def make_room(self, used):
        """Drop unused levels, least recently used first, until they keep to the limit.

        Parameters
        ----------
        used : set of bytes
            Keys of levels in use; they stay.
        """
        for key in used & self._levels.keys():
            self._levels.move_to_end(key)
        spare = sum(size for key, size in self._sizes.items() if key not in used)
        for key in [key for key in self._levels if key not in used]:
            if spare <= self._memory_limit:
                break
            del self._levels[key]
            spare -= self._sizes.pop(key)


def size_of_levels(levels):
    """Return how many bytes levels of detail take.

    Parameters
    ----------
    levels : iterable of MeshLevel

    Returns
    -------
    int
    """
    return sum(
        array.nbytes
        for level in levels
        for array in (level.positions, level.triangles, level.merged, *level.attributes.values())
    )
