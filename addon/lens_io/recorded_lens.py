"""A lens as another file keeps it: its whole text beside its id, for libraries that differ.

An id is a word of one machine's library: elsewhere there is no such lens, or another one.
"""

from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from ..errors import LensFileError
from .lens_shelf import ShelvedLens
from .toml.toml_reader import parse_lens
from .toml.toml_writer import lens_toml


def text_of(shelf, lens_id):
    """Return the text of a library's lens, to be recorded.

    Parameters
    ----------
    shelf : LensShelf
    lens_id : str

    Returns
    -------
    str or None
        A lens file; None if the library has no such lens or it cannot be used.
    """
    found = shelf.find(lens_id) if lens_id else None
    return lens_toml(found.lens.prescription) if found and found.lens else None


class RecordedShelf:
    """A library in which one lens is the recorded one; asked as `LensShelf` is.

    Parameters
    ----------
    shelf : LensShelf
    lens_id : str
    text : str
        Of `text_of`.

    Attributes
    ----------
    problem : str or None
        Where the library has another lens of that id, or the record cannot be read: one sentence.
    """

    def __init__(self, shelf, lens_id, text):
        self._shelf = shelf
        self._id = lens_id
        self._lens = None
        self.problem = None
        try:
            lens = parse(text)
        except LensFileError as error:
            self.problem = (
                f"lens '{lens_id}' as it was recorded cannot be read ({error.findings[0].message}):"
                " the library's is taken"
            )
            return
        self._lens = ShelvedLens(lens_id, Path(f"{lens_id}.toml"), False, lens, None, None)
        if differs(shelf, lens_id, text):
            self.problem = (
                f"lens '{lens_id}' of this library is not the one that was recorded, which is taken"
            )

    def find(self, lens_id):
        """Return a lens as `LensShelf.find` does."""
        if self._lens is not None and lens_id == self._id:
            return self._lens
        return self._shelf.find(lens_id)

    def near_ids(self, lens_id):
        """Return near ids as `LensShelf.near_ids` does."""
        return self._shelf.near_ids(lens_id)


def differs(shelf, lens_id, text):
    """Whether a library has another lens of an id than the recorded one.

    Who made a lens and what is noted about it makes no difference.

    Parameters
    ----------
    shelf : LensShelf
    lens_id : str
    text : str
        Of `text_of`.

    Returns
    -------
    bool
        False where the library has none, or the text is no lens.
    """
    own = text_of(shelf, lens_id)
    if own is None or own == text:
        return False
    try:
        return _bare(parse(own)) != _bare(parse(text))
    except LensFileError:
        return False


# Memo of its argument alone: panels ask again and again.
@lru_cache(maxsize=8)
def parse(text):
    """Read a recorded lens.

    Parameters
    ----------
    text : str

    Returns
    -------
    LensFile

    Raises
    ------
    LensFileError
    """
    return parse_lens(text.encode("utf-8"), "recorded lens")


def _bare(lens):
    nothing = {"name": "", "designer": None, "source": None, "year": None, "notes": None}
    return replace(lens.prescription, **nothing)
