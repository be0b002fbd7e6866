"""Names of files that have a frame number."""

import re


def frame_path(path, frame):
    """Put a frame number into the last run of # of a file name.

    Parameters
    ----------
    path : Path
    frame : int

    Returns
    -------
    Path
        The same path if its name has no #.
    """
    runs = list(re.finditer("#+", path.name))
    if not runs:
        return path
    first, last = runs[-1].span()
    digits = f"{'-' if frame < 0 else ''}{abs(frame):0{last - first}d}"
    return path.with_name(path.name[:first] + digits + path.name[last:])
