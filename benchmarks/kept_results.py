"""Results that a long run keeps in a file, so that one that was ended goes on from there."""

import hashlib
import json
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]


class KeptResults:
    """Rows of results in a file, one JSON object a line; those of other sources are passed over.

    Parameters
    ----------
    path : Path
    mark : str
        Of the sources that were measured: their `fingerprint`, or a name of the user's.
    names : tuple of str
        The entries of a row that tell what was measured.

    Attributes
    ----------
    found : dict of tuple to dict
        Rows by the values of `names`.
    """

    def __init__(self, path, mark, names):
        self._path, self._mark, self._names = Path(path), mark, names
        lines = self._path.read_text().splitlines() if self._path.exists() else []
        self.found = {}
        for line in lines:
            # The last line of a run that was killed may be half of one.
            try:
                row = json.loads(line)
            except ValueError:
                continue
            if isinstance(row, dict) and row.get("mark") == mark:
                self.found[self._key(row)] = row

    def _key(self, row):
        return tuple(row[name] for name in self._names)

    def add(self, row):
        """Keep a row, a dict that JSON can hold."""
        row["mark"] = self._mark
        self.found[self._key(row)] = row
        with self._path.open("a") as file:
            # A line of its own, also behind half a line.
            start = "\n" if file.tell() and not self._ends_in_newline() else ""
            file.write(start + json.dumps(row) + "\n")

    def _ends_in_newline(self):
        with self._path.open("rb") as file:
            file.seek(-1, 2)
            return file.read() == b"\n"


def fingerprint(*folders):
    """Return a text that changes with the sources in some folders of the repository."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted((REPOSITORY / folder).rglob("*")):
            if path.is_file() and "__pycache__" not in path.parts:
                digest.update(str(path.relative_to(REPOSITORY)).encode() + path.read_bytes())
    return digest.hexdigest()[:16]
