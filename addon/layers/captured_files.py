"""Files that can be refocused: which ones a name stands for, and what is in them."""

import re

from ..errors import InputError
from ..files.frame_path import frame_path
from .flat_input import load_flat
from .layer_file import is_layer_file, load_layers


def captured_files(path, frames):
    """Find the captured files that a name stands for.

    Parameters
    ----------
    path : Path
        Its last run of # stands for a frame number.
    frames : iterable of int or None
        None: all that there are.

    Returns
    -------
    dict of int to Path
        By frame; a file without a number is frame 0.

    Raises
    ------
    InputError
        If there are none, or one is missing.
    """
    if "#" not in path.name:
        if not path.is_file():
            raise InputError(f"captured file '{path}' does not exist")
        return {0: path}
    if frames is not None:
        found = {frame: frame_path(path, frame) for frame in frames}
        missing = [frame for frame, file in found.items() if not file.is_file()]
        if missing:
            raise InputError(
                f"captured file '{found[missing[0]]}' does not exist"
                + (f" ({len(missing)} of {len(found)} frames are missing)" * (len(missing) > 1))
            )
        return found
    first, last = list(re.finditer("#+", path.name))[-1].span()
    pattern = re.compile(
        re.escape(path.name[:first]) + r"(-?\d+)" + re.escape(path.name[last:]), re.IGNORECASE
    )
    names = sorted(path.parent.iterdir()) if path.parent.is_dir() else []
    matches = [(pattern.fullmatch(file.name), file) for file in names]
    found = {int(match[1]): file for match, file in matches if match and file.is_file()}
    if not found:
        raise InputError(f"no captured file is called '{path}', whatever its number")
    return found


def check_apart(files, outputs):
    """Refuse to write over captured files.

    Parameters
    ----------
    files : iterable of Path
        Captured files.
    outputs : iterable of Path
        Where pictures of them go.

    Raises
    ------
    InputError
        If a picture would replace a captured file, whatever its path is called.
    """
    captured = {file.resolve() for file in files}
    for output in outputs:
        if output.resolve() in captured:
            raise InputError(
                f"'{output}' is a captured file, which the picture would replace; write the picture"
                " elsewhere"
            )


def load_captured(path, flat):
    """Read a file of depth layers, or any picture with a depth pass.

    Parameters
    ----------
    path : Path
    flat : FlatOptions
        What is known about a picture with a depth pass; captured layers tell all themselves.

    Returns
    -------
    LayerStack

    Raises
    ------
    InputError
        If it is neither, damaged, or not whole.
    """
    return load_layers(path) if is_layer_file(path) else load_flat(path, flat)
