"""Lens profiles kept on disk: made once, found again by what the lens is.

A file's name is the hash of everything that its content depends on, so that a changed lens or a
new version of the format is another file; nothing is ever out of date. Files appear whole, writers
do not disturb each other, and a damaged file is made again. A folder that cannot be written to
only costs time. The oldest files go when the folder grows too large.
"""

import contextlib
import hashlib
import os
import time
from pathlib import Path

from ..errors import InputError, OutputError
from ..files.cache_folder import cache_folder
from ..lens_bokeh.tables.profile import make_profile
from .profile_file import FORMAT_VERSION, StoredProfile, load_profile, save_profile

LARGEST_SIZE = 512 * 1024 * 1024
# Version of tracer and tables, part of the hash: raised when they give another result.
CONTENT_VERSION = 1
# Endings of the files of this cache and of those that share its folder; no others are removed.
_OWN_FILES = ("*.exr", "thumb-*.npy")
# An unfinished file that old was left by a process that ended.
_ABANDONED_SECONDS = 24 * 3600.0


def profile_folder():
    """Return the folder of cached profiles; it may not exist yet."""
    return cache_folder("profiles")


def content_hash(prescription, label=None):
    """Hash of all optical properties of a lens at a zoom position.

    Parameters
    ----------
    prescription : Prescription
    label : str or None

    Returns
    -------
    str
        64 hexadecimal digits; equal for lenses whose surfaces, glasses, openings, nominal values
        and focus groups are equal, whatever their names and notes.
    """
    configuration = prescription.configuration(label)
    # The text of a frozen dataclass gives each number with all its digits.
    told = (FORMAT_VERSION, CONTENT_VERSION, configuration, prescription.focus)
    return hashlib.sha256(repr(told).encode()).hexdigest()


def profile(
    prescription,
    label=None,
    *,
    chromatic=True,
    folder=None,
    lens_id="",
    progress=None,
    cancelled=None,
):
    """Return the bokeh profile of a lens, from the cache if it is there.

    Parameters
    ----------
    prescription : Prescription
    label : str or None
        Zoom position; None: the first.
    chromatic : bool
    folder : Path or None
        None: `profile_folder`.
    lens_id : str
        Written into the file.
    progress : callable or None
        Called with the share done, 0 to 1.
    cancelled : callable or None
        Asked between steps; true ends the work.

    Returns
    -------
    LensProfile

    Raises
    ------
    PrescriptionError
        If the lens forms no image or has no such position.
    RenderCancelledError
        If it was cancelled; nothing is left behind.
    """
    configuration = prescription.configuration(label)

    def make():
        made = make_profile(
            configuration,
            name=prescription.name,
            focus_group=prescription.focus,
            chromatic=chromatic,
            progress=progress,
            cancelled=cancelled,
        )
        return StoredProfile(made)

    kind = "rgb" if chromatic else "mono"
    stored = _kept(prescription, configuration.label, kind, folder, lens_id, make)
    if progress:
        progress(1.0)
    return stored.profile


def pupil_tables(
    prescription,
    label=None,
    *,
    wavelengths_nm=None,
    folder=None,
    lens_id="",
    progress=None,
    cancelled=None,
):
    """Return the off-axis pupil of a lens, from the cache if it is there.

    Parameters
    ----------
    prescription, label, folder, lens_id, progress, cancelled
        As for `profile`.
    wavelengths_nm : sequence of float or None
        None: the reference wavelength.

    Returns
    -------
    PupilTables

    Raises
    ------
    PrescriptionError, RenderCancelledError
        As for `profile`.
    """
    from ..lens_bokeh.tables.pupil_parts import LAYOUT, pack, unpack
    from ..lens_bokeh.tables.pupil_tracing import build_pupil_tables

    configuration = prescription.configuration(label)
    options = {} if wavelengths_nm is None else {"wavelengths_nm": tuple(wavelengths_nm)}

    def make():
        tables = build_pupil_tables(
            configuration, progress=progress, cancelled=cancelled, **options
        )
        words, pictures = pack(tables)
        return StoredProfile(None, None, words, pictures)

    colors = hashlib.sha256(repr(options).encode()).hexdigest()[:8]
    stored = _kept(
        prescription, configuration.label, f"pupil{LAYOUT}-{colors}", folder, lens_id, make
    )
    if progress:
        progress(1.0)
    return unpack(stored.words, stored.pictures)


def prune(folder, largest=LARGEST_SIZE):
    """Remove the least recently used files of a cache until the others fit.

    Parameters
    ----------
    folder : Path
    largest : int
        Bytes.
    """
    found = []
    for path in [path for pattern in _OWN_FILES for path in folder.glob(pattern)]:
        with contextlib.suppress(OSError):
            status = path.stat()
            found.append((status.st_mtime, status.st_size, path))
    total = sum(size for _, size, _ in found)
    for _, size, path in sorted(found):
        if total <= largest:
            break
        _remove(path)
        total -= size
    for path in folder.glob(".*.part"):
        with contextlib.suppress(OSError):
            if time.time() - path.stat().st_mtime > _ABANDONED_SECONDS:
                _remove(path)


def _kept(prescription, label, kind, folder, lens_id, make):
    """Read a stored profile, or make and keep it."""
    folder = profile_folder() if folder is None else Path(folder)
    key = content_hash(prescription, label)
    path = folder / f"{key[:32]}-{kind}.exr"
    with contextlib.suppress(InputError):
        stored = load_profile(path)
        if stored.words.get("lensHash") == key:
            # So that files in use are the last to go.
            with contextlib.suppress(OSError):
                os.utime(path)
            return stored
    stored = make()
    # Without a cache the work is done again next time, and that is all.
    with contextlib.suppress(OSError, OutputError):
        folder.mkdir(parents=True, exist_ok=True)
        save_profile(path, stored, lens_id=lens_id, content_hash=key)
        prune(folder)
    return stored


def _remove(path):
    with contextlib.suppress(OSError):
        path.unlink()
