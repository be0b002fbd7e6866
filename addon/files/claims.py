"""Placeholders: empty files that show other processes that a file of this name is being made.

Blender calls them placeholders: a frame of an animation that several machines render is taken by
the first that makes its file, and the others go on to the next.
"""

import contextlib
import os
from pathlib import Path

from ..errors import OutputError
from .whole_file import forget_file, remember_file


class Claims:
    """The files that this process has claimed; those still empty go at the end of a `with` block.

    A process that ends by SIGINT or SIGTERM gives its claims back, too.
    """

    def __enter__(self):
        """Begin without claims."""
        self._paths = set()
        return self

    def __exit__(self, *_):
        """Remove the claimed files that are still empty."""
        self.give_back(list(self._paths))

    def take(self, paths):
        """Claim files, all or none.

        Parameters
        ----------
        paths : list of Path

        Returns
        -------
        bool
            False if one of them is there already.

        Raises
        ------
        OutputError
            If a file cannot be made.
        """
        taken = []
        for path in paths:
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                is_ours = _make(path)
            except OSError as error:
                self.give_back(taken)
                raise OutputError(f"cannot write '{path}': {error.strerror or error}") from error
            if not is_ours:
                self.give_back(taken)
                return False
            taken.append(path)
            self._paths.add(path)
            remember_file(path)
        return True

    def settle(self, path):
        """Keep a claimed file, which is written now."""
        self._paths.discard(path)
        forget_file(path)

    def give_back(self, paths):
        """Remove claimed files; one that is no longer empty is somebody's work and stays.

        Parameters
        ----------
        paths : list of Path
        """
        for path in paths:
            with contextlib.suppress(OSError):
                if Path(path).stat().st_size == 0:
                    os.unlink(path)
            self.settle(path)


def _make(path):
    try:
        # One process only gets through here, whatever the others do.
        os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
    except FileExistsError:
        return False
    return True
