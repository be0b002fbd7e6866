"""Findings: errors and warnings about a lens file, each with a code."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One error or warning.

    Parameters
    ----------
    code : str
        E01 to E25, W01 to W07, or I01 to I08.
    path : str
        Where in the file: a key such as ``surface[3].radius_mm`` (counted from 1), or a line.
        Empty if the whole file is meant.
    message : str
        One sentence that names the value and what is allowed.
    """

    code: str
    path: str
    message: str

    def as_json(self):
        """Return the finding as the command line prints it."""
        return {"code": self.code, "path": self.path, "message": self.message}
