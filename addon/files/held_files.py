"""Files that are held back in a temporary folder until they are published or dropped.

Software that writes its files in place, in several steps, is given a stand-in for its output folder
and writes there. The files are then published, each whole or not at all, or removed with the
folder.
"""

import shutil
import tempfile
from pathlib import Path

from ..errors import OutputError
from .whole_file import forget_folder, remember_folder, whole_file


class HeldFiles:
    """A folder for held files; it vanishes at the end of a `with` block, and on signals.

    It lies where the system keeps temporary files (``TMPDIR``).
    """

    def __enter__(self):
        """Make the folder, or raise `OutputError`."""
        try:
            self._folder = Path(tempfile.mkdtemp(prefix="aplanat-"))
        except OSError as error:
            # Without a folder at all, the message names those that were tried.
            where = f" in '{tempfile.tempdir}'" if tempfile.tempdir else ""
            raise OutputError(
                f"cannot make a folder for unfinished files{where}: {error.strerror or error}; set"
                " TMPDIR"
            ) from error
        remember_folder(self._folder)
        return self

    def __exit__(self, *_):
        """Remove the folder with what is still in it."""
        shutil.rmtree(self._folder, ignore_errors=True)
        forget_folder(self._folder)

    def room(self, name):
        """Return the folder of one writer; made at first use.

        Parameters
        ----------
        name : str

        Returns
        -------
        Path
        """
        folder = self._folder / name
        folder.mkdir(exist_ok=True)
        return folder

    def stand_in(self, name, path):
        """Return where a writer writes instead of to an absolute path.

        Parameters
        ----------
        name : str
            Of the writer's room.
        path : str
            Absolute; its end may hold patterns that only the writer understands.

        Returns
        -------
        str
        """
        anchor = Path(path).anchor
        drive = Path(path).drive.replace(":", "").strip("\\/").replace("\\", "+")
        room = self.room(name) / f"root{'+' if drive else ''}{drive}"
        room.mkdir(exist_ok=True)
        (self.room(name) / f"{room.name}.anchor").write_text(anchor, encoding="utf-8")
        return f"{room.as_posix()}/{path[len(anchor) :]}"

    def found(self, name):
        """Return what a writer has written under its stand-ins.

        Parameters
        ----------
        name : str

        Returns
        -------
        list of (Path, Path)
            Where each file is held, and where it belongs.
        """
        pairs = []
        for anchor in sorted(self.room(name).glob("*.anchor")):
            root = anchor.with_suffix("")
            real = Path(anchor.read_text(encoding="utf-8"))
            held = sorted(path for path in root.rglob("*") if path.is_file())
            pairs += [(path, real / path.relative_to(root)) for path in held]
        return pairs


def publish(held, real):
    """Move a held file to its destination, with the permissions of the user's umask.

    Parameters
    ----------
    held, real : Path

    Raises
    ------
    OutputError
        If it cannot be written there.
    """
    with whole_file(real) as place:
        shutil.copyfile(held, place)
