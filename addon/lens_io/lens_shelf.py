"""The library of lenses as one process uses it: what was read is kept, and read again on demand.

A lens that is drawn in panels and asked for in every frame is read once. What is in memory stays
the truth until `LensShelf.reload`, so that a file being edited does not change a running render.
"""

import threading
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from ..errors import LensFileError
from .any_lens_file import read_any_lens
from .library import SHIPPED_FOLDER, Library
from .toml.toml_reader import LensFile


@dataclass(frozen=True, eq=False)
class ShelvedLens:
    """A lens of the library, as it was read.

    Parameters
    ----------
    id : str
    path : Path
    shipped : bool
        Whether the file came with Aplanat.
    lens : LensFile or None
        None if the file cannot be used.
    error : LensFileError or None
        Why not.
    stamp : tuple of int or None
        Time of change and size of the file when it was read; None if it could not be asked.
    """

    id: str
    path: Path
    shipped: bool
    lens: LensFile | None
    error: LensFileError | None
    stamp: tuple[int, int] | None

    @property
    def name(self):
        """Name of the lens, or its id if the file cannot be used."""
        return self.lens.prescription.name if self.lens else self.id

    @property
    def title(self):
        """The name with focal length and f-number, where the name does not say them."""
        if self.lens is None or ("mm" in self.name and "f/" in self.name):
            return self.name
        made = self.lens.prescription
        return f"{self.name} {made.focal_length:.3g} mm f/{made.f_number:.3g}"

    @property
    def search_text(self):
        """What a lens is looked for by, in small letters: name, figures, kind, designer, year."""
        words = [self.id, self.title]
        if self.lens is not None:
            made = self.lens.prescription
            words += [f"{made.focal_length:.3g}mm", f"f/{made.f_number:.3g}", made.projection]
            words += [str(word) for word in (made.designer, made.year) if word]
            words += ["zoom"] * bool(made.zoom) + ["prime"] * (not made.zoom)
        return " ".join(words).casefold()


@dataclass(frozen=True)
class Reloaded:
    """Changes that `LensShelf.reload` found.

    Parameters
    ----------
    added, removed, changed : tuple of str
        Ids, sorted.
    """

    added: tuple[str, ...]
    removed: tuple[str, ...]
    changed: tuple[str, ...]


class LensShelf:
    """Lenses by id, kept in memory; may be asked from several threads.

    Parameters
    ----------
    folders : sequence of Path
        The user's folders, the most important first; the shipped lenses come last by themselves.
    """

    def __init__(self, folders=()):
        self._library = Library(folders)
        self._lock = threading.RLock()
        self._paths = None
        self._extra = {}
        self._read = {}

    def ids(self):
        """Return the ids of all lenses, sorted.

        Returns
        -------
        tuple of str
        """
        return tuple(sorted(self._known_paths()))

    def find(self, lens_id):
        """Return a lens, reading its file if that was not done yet.

        Parameters
        ----------
        lens_id : str

        Returns
        -------
        ShelvedLens or None
            None if the library has no such lens.
        """
        with self._lock:
            known = self._read.get(lens_id)
            if known is None and (path := self._known_paths().get(lens_id)):
                known = self._read[lens_id] = _read(lens_id, path)
            return known

    def near_ids(self, lens_id):
        """Return up to three ids of the library that look like one that it does not have.

        Parameters
        ----------
        lens_id : str

        Returns
        -------
        list of str
            The nearest first.
        """
        ids = self.ids()
        near = get_close_matches(lens_id[:100], ids, 3, 0.5)
        folded = lens_id.casefold()
        return near or [other for other in ids if folded and folded in other.casefold()][:3]

    def is_out_of_date(self, lens_id):
        """Whether the file of a lens that was read has changed on the disk since, or is gone.

        Parameters
        ----------
        lens_id : str

        Returns
        -------
        bool
        """
        known = self._read.get(lens_id)
        return known is not None and _stamp(known.path) != known.stamp

    def add_file(self, path):
        """Read a lens file into the library, for as long as the process runs.

        A file that was read before is read again; what `find` returns from then on is this.

        Parameters
        ----------
        path : Path or str

        Returns
        -------
        str
            Its id: the name of the file without ending, made unique.

        Raises
        ------
        LensFileError
            If the file cannot be used.
        """
        place = Path(path).absolute()
        stamp = _stamp(place)
        lens = read_any_lens(path)
        with self._lock:
            known = self._known_paths()
            lens_id = next((key for key, there in known.items() if there == place), None)
            if lens_id is None:
                lens_id = unused_id(place.stem, self.ids())
                self._extra[lens_id] = self._paths[lens_id] = place
            self._read[lens_id] = _shelved(lens_id, place, lens, None, stamp)
            return lens_id

    def reload(self):
        """Look for new files, and forget what was read from files that changed or are gone.

        Returns
        -------
        Reloaded
        """
        with self._lock:
            before = self._known_paths()
            self._paths = None
            now = self._known_paths()
            changed = [
                lens_id
                for lens_id in before.keys() & now.keys()
                if before[lens_id] != now[lens_id] or self.is_out_of_date(lens_id)
            ]
            removed = sorted(before.keys() - now.keys())
            for lens_id in (*changed, *removed):
                self._read.pop(lens_id, None)
            return Reloaded(
                tuple(sorted(now.keys() - before.keys())), tuple(removed), tuple(sorted(changed))
            )

    def _known_paths(self):
        with self._lock:
            if self._paths is None:
                self._paths = self._library.paths() | self._extra
            return self._paths


def unused_id(wanted, used):
    """Return an id, numbered if it is in use.

    Parameters
    ----------
    wanted : str
    used : collection of str

    Returns
    -------
    str
    """
    if wanted not in used:
        return wanted
    number = 2
    while f"{wanted}-{number}" in used:
        number += 1
    return f"{wanted}-{number}"


def _read(lens_id, path):
    # Before the file: a change in between is noticed.
    stamp = _stamp(path)
    try:
        return _shelved(lens_id, path, read_any_lens(path), None, stamp)
    except LensFileError as error:
        return _shelved(lens_id, path, None, error, stamp)


def _shelved(lens_id, path, lens, error, stamp):
    return ShelvedLens(lens_id, path, path.parent == SHIPPED_FOLDER, lens, error, stamp)


def _stamp(path):
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size
