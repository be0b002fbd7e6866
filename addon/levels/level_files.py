"""Disk cache of levels of detail of large meshes: the collapses of each level, by content hash.

Where a file is damaged, of another version or missing, the levels are made again. When the folder
is full, the least recently used files are removed.
"""

import contextlib
import hashlib
import os
import zipfile
from dataclasses import fields

import numpy as np

from ..errors import OutputError
from ..files.whole_file import whole_file
from .making.mesh_levels import Halving

# Version of the cache; raised when the same mesh would get other levels.
_VERSION = 6
_FIELDS = tuple(field.name for field in fields(Halving))


class LevelFiles:
    """A cache folder of halvings (see `level_collapses.Halving`).

    Parameters
    ----------
    folder : Path
        Made when something is written.
    limit : int
        Most bytes of all its files.
    """

    def __init__(self, folder, limit):
        self.folder = folder
        self._limit = limit

    def path(self, key):
        """Return the file of a key."""
        return self.folder / f"{key}.npz"

    def read(self, key):
        """Return halvings and shrinkage of a key, or None if there is no usable file."""
        path = self.path(key)
        try:
            with open(path, "rb") as file, np.load(file, allow_pickle=False) as arrays:
                if int(arrays["version"]) != _VERSION or _digest(arrays) != str(arrays["digest"]):
                    return None
                halvings = tuple(
                    Halving(*(arrays[f"{name}_{number}"] for name in _FIELDS))
                    for number in range(int(arrays["count"]))
                )
                shrinkage = float(arrays["shrinkage"])
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None
        with contextlib.suppress(OSError):
            os.utime(path)
        return halvings, shrinkage

    def write(self, key, halvings, shrinkage):
        """Write halvings; does nothing where the folder cannot be written.

        Parameters
        ----------
        key : str
        halvings : sequence of Halving
        shrinkage : float
            See `level_making.Collapses`.
        """
        arrays = {
            f"{name}_{number}": getattr(halving, name)
            for number, halving in enumerate(halvings)
            for name in _FIELDS
        }
        arrays["version"] = np.array(_VERSION)
        arrays["count"] = np.array(len(halvings))
        arrays["shrinkage"] = np.array(shrinkage, np.float64)
        arrays["digest"] = np.array(_digest(arrays))
        with contextlib.suppress(OSError, OutputError):
            self.folder.mkdir(parents=True, exist_ok=True)
            with whole_file(self.path(key)) as name, open(name, "wb") as file:
                np.savez(file, **arrays)
            self._make_room()

    def clear(self):
        """Remove all files of the cache."""
        for path in self.folder.glob("*.npz"):
            with contextlib.suppress(OSError):
                path.unlink()

    def _make_room(self):
        found = [(path, path.stat()) for path in self.folder.glob("*.npz")]
        found.sort(key=lambda item: item[1].st_mtime, reverse=True)
        total = 0
        for path, status in found:
            total += status.st_size
            if total > self._limit:
                with contextlib.suppress(OSError):
                    path.unlink()


def _digest(arrays):
    digest = hashlib.blake2b(digest_size=16)
    for name in sorted(arrays):
        if name != "digest":
            digest.update(name.encode())
            digest.update(np.ascontiguousarray(arrays[name]))
    return digest.hexdigest()
