"""The lenses that can be chosen by name: those that ship and those of the user's folders."""

from pathlib import Path

from ..errors import LensFileError
from .any_lens_file import read_any_lens
from .toml.findings import Finding

SHIPPED_FOLDER = Path(__file__).resolve().parents[2] / "lens_profiles"
ENDING = ".toml"


class Library:
    """Folders of lens files; the id of a lens is the name of its file without the ending.

    Where two folders have the same id, the user's lens is taken.

    Parameters
    ----------
    folders : sequence of Path or str
        The user's folders, the most important first. The shipped folder comes last by itself.
    """

    def __init__(self, folders=()):
        self.folders = (*(Path(folder) for folder in folders), SHIPPED_FOLDER)

    def ids(self):
        """Return the ids of all lenses, sorted.

        Returns
        -------
        tuple of str
        """
        return tuple(sorted(self.paths()))

    def path_of(self, lens_id):
        """Return the file of a lens.

        Parameters
        ----------
        lens_id : str

        Returns
        -------
        Path

        Raises
        ------
        LensFileError
            If no folder has it (E01, with near names).
        """
        paths = self.paths()
        if lens_id in paths:
            return paths[lens_id]
        from difflib import get_close_matches

        near = get_close_matches(lens_id[:100], paths, 3, 0.5)
        hint = f"; near names are {', '.join(near)}" if near else "; `aplanat lens list` names all"
        raise LensFileError(
            lens_id, [Finding("E01", "", f"there is no lens and no file of this name{hint}")]
        )

    def open(self, lens):
        """Read a lens.

        Parameters
        ----------
        lens : str or Path
            An id, or the path of a lens file of any format; an id goes first.

        Returns
        -------
        LensFile

        Raises
        ------
        LensFileError
            If there is no such lens, or with every error of its file.
        """
        return read_any_lens(self.file_of(lens))

    def file_of(self, lens):
        """Return the file of a lens by its id or path, without reading it.

        Parameters
        ----------
        lens : str or Path
            An id, or the path of a lens file of any format; an id goes first.

        Returns
        -------
        Path or str
            A path as it was given.

        Raises
        ------
        LensFileError
            If it is neither an id nor looks like a path (E01, with near names).
        """
        paths = self.paths()
        if str(lens) in paths:
            return paths[str(lens)]
        return lens if _looks_like_path(lens) else self.path_of(str(lens))

    def paths(self):
        """Return the file of every lens.

        Returns
        -------
        dict of str to Path
            By id.
        """
        paths = {}
        for folder in reversed(self.folders):
            paths.update(_lens_files(folder))
        return paths


def _lens_files(folder):
    try:
        return {
            path.name.removesuffix(ENDING): path
            for path in sorted(folder.iterdir())
            if path.name.endswith(ENDING) and not path.name.startswith(".")
        }
    except OSError:
        # A folder that is not there, or may not be read, has no lenses.
        return {}


def _looks_like_path(lens):
    if isinstance(lens, Path) or "/" in lens or "\\" in lens or lens.endswith(ENDING):
        return True
    try:
        return Path(lens).exists()
    except (OSError, ValueError):
        return False
