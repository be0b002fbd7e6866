"""Files that are there whole or not at all.

The bytes go to a file without a name in the destination's folder, which vanishes with the process
however it ends, and get their name when all of them are on the disk. Where the system has no such
files, a temporary name is used, and removed on SIGINT and SIGTERM. Either way the file has the
permissions that the user's umask leaves, as if it had been opened for writing.
"""

import contextlib
import os
import re
import secrets
import shutil
import signal
import stat
import threading
from pathlib import Path

from ..errors import OutputError, UnfinishedFileError

# Characters of a file's name that its temporary name keeps: file systems allow 255 bytes, and a
# character takes up to four.
_LONGEST_STEM = 50

# What a signal removes: files, and folders with all that is in them.
_unfinished = set()
_unfinished_folders = set()


@contextlib.contextmanager
def whole_file(destination):
    """Write a file; it appears when the `with` block ends without an exception.

    Parameters
    ----------
    destination : Path

    Yields
    ------
    str
        The path to write to.

    Raises
    ------
    OutputError
        If there can be no such file.
    UnfinishedFileError
        If it could not be written to its end.
    """
    writer = _begin(Path(destination))
    try:
        yield writer.path
        writer.publish()
    except OSError as error:
        reason = error.strerror or error
        raise UnfinishedFileError(
            f"cannot write '{destination}' to its end: {reason}; nothing of it is left"
        ) from error
    finally:
        writer.close()


def check_writable(destination):
    """Make sure that a file could be written, leaving nothing behind.

    Raises
    ------
    OutputError
    """
    _begin(Path(destination)).close()


def _begin(destination):
    """Return the writer of a file, or raise `OutputError` with its path and the reason."""
    # As with a file that is opened for writing, a link stays one.
    place = Path(os.path.realpath(destination)) if os.path.islink(destination) else destination
    try:
        kind = _kind(place)
        if kind == "folder":
            raise OutputError(f"cannot write '{destination}': it is a folder; name a file")
        if kind is not None:
            raise OutputError(f"cannot write '{destination}': it is {kind}; name a plain file")
        return _open(place)
    except OSError as error:
        reason = _reason(place.parent, error)
        raise OutputError(f"cannot write '{destination}': {reason}") from error


def _kind(place):
    """Return the kind of file at a path in words, if it may not be replaced."""
    try:
        mode = os.lstat(place).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return None
    if stat.S_ISREG(mode):
        return None
    if stat.S_ISLNK(mode):
        return "a link that leads to itself"
    return "folder" if stat.S_ISDIR(mode) else "a device or a pipe"


def _reason(folder, error):
    """Return why no file can be made in a folder, in words, and what to do."""
    try:
        if not stat.S_ISDIR(os.stat(folder).st_mode):
            return f"'{folder}' is no folder"
    except FileNotFoundError:
        return f"folder '{folder}' does not exist; create it first"
    except OSError as deeper:
        return deeper.strerror or str(deeper)
    if isinstance(error, FileNotFoundError):
        # Error numbers of virtual file systems, such as /proc.
        return f"no file can be made in '{folder}'; choose another folder"
    return error.strerror or str(error)


def _open(destination):
    if hasattr(os, "O_TMPFILE") and os.path.isdir("/proc/self/fd"):
        with contextlib.suppress(IsADirectoryError, NotImplementedError, OSError):
            return _NamelessFile(destination)
    return _NamedFile(destination)


def reason_of(error):
    """Return why a library could not write a `whole_file`, without the hidden name of the file.

    Parameters
    ----------
    error : Exception

    Returns
    -------
    str
        Without a dot at the end.
    """
    words = " ".join(str(error).split())
    words = re.sub(r"""(to (image )?file )?["']?/proc/self/fd/\d+["']?[.:]?""", "", words)
    return " ".join(words.split()).rstrip(" .") or type(error).__name__


def _shortened(name):
    # So that what is added makes no name too long for the file system.
    return name[:_LONGEST_STEM]


class _NamelessFile:
    def __init__(self, destination):
        self._destination = destination
        self._folder = os.open(destination.parent, os.O_RDONLY | os.O_DIRECTORY)
        try:
            self._file = os.open(destination.parent, os.O_TMPFILE | os.O_RDWR, 0o666)
        except OSError:
            os.close(self._folder)
            raise
        self.path = f"/proc/self/fd/{self._file}"

    def publish(self):
        os.fsync(self._file)
        final = self._destination.name
        try:
            self._link(final)
        except FileExistsError:
            # Not the ending of a picture: no program takes it for one.
            name = f".{_shortened(final)}.{os.getpid()}.part"
            with contextlib.suppress(FileNotFoundError):
                os.unlink(name, dir_fd=self._folder)
            self._link(name)
            os.replace(name, final, src_dir_fd=self._folder, dst_dir_fd=self._folder)

    def _link(self, name):
        # With a folder given, os.link follows the link in /proc to the file itself.
        folder = self._folder
        os.link(self.path, name, src_dir_fd=folder, dst_dir_fd=folder, follow_symlinks=True)

    def close(self):
        os.close(self._file)
        os.close(self._folder)


class _NamedFile:
    def __init__(self, destination):
        self._destination = destination
        # Not by tempfile, which keeps its files from everybody else.
        name = f".{_shortened(destination.name)}.{secrets.token_hex(8)}.part"
        self.path = str(destination.parent / name)
        os.close(os.open(self.path, os.O_CREAT | os.O_EXCL | os.O_RDWR, 0o666))
        remember_file(self.path)

    def publish(self):
        with open(self.path, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(self.path, self._destination)

    def close(self):
        with contextlib.suppress(FileNotFoundError):
            os.unlink(self.path)
        forget_file(self.path)


def remember_file(path):
    """Remove a file on SIGINT and SIGTERM, if it is empty or has the ending ``.part``."""
    _unfinished.add(str(path))


def forget_file(path):
    """Undo `remember_file`."""
    _unfinished.discard(str(path))


def remember_folder(path):
    """Remove a folder with all that is in it on SIGINT and SIGTERM."""
    _unfinished_folders.add(str(path))


def forget_folder(path):
    """Undo `remember_folder`."""
    _unfinished_folders.discard(str(path))


@contextlib.contextmanager
def removed_on_signals():
    """In the `with` block, SIGINT and SIGTERM remove what is unfinished and end the process."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    for number in previous:
        signal.signal(number, _remove_and_end)
    try:
        yield
    finally:
        for number, handler in previous.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def _remove_and_end(number, _frame):
    for path in tuple(_unfinished):
        with contextlib.suppress(OSError):
            if path.endswith(".part") or os.stat(path).st_size == 0:
                os.unlink(path)
    for path in tuple(_unfinished_folders):
        shutil.rmtree(path, ignore_errors=True)
    # As if there had been no handler, so that the caller sees what ended the process.
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
