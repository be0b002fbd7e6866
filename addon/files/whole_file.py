"""Files that are there whole or not at all.

The bytes go to a file without a name in the destination's folder, which vanishes with the process
however it ends, and get their name when all of them are on the disk. Where the system has no such
files, a temporary name is used, and removed on SIGINT and SIGTERM.
"""

import contextlib
import os
import signal
import tempfile
import threading
from pathlib import Path

from ..errors import OutputError

_unfinished = set()


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
        If the folder cannot be written to.
    """
    destination = Path(destination)
    try:
        writer = _open(destination)
    except OSError as error:
        raise _cannot_write(destination, error) from error
    try:
        yield writer.path
        try:
            writer.publish()
        except OSError as error:
            raise _cannot_write(destination, error) from error
    finally:
        writer.close()


def check_writable(destination):
    """Make sure that a file could be written, leaving nothing behind.

    Raises
    ------
    OutputError
    """
    destination = Path(destination)
    if not destination.parent.is_dir():
        raise OutputError(f"folder '{destination.parent}' does not exist; create it first")
    if destination.is_dir():
        raise OutputError(f"'{destination}' is a folder; name a file")
    try:
        _open(destination).close()
    except OSError as error:
        raise _cannot_write(destination, error) from error


def _cannot_write(destination, error):
    return OutputError(f"cannot write '{destination}': {error.strerror or error}")


def _open(destination):
    if hasattr(os, "O_TMPFILE") and os.path.isdir("/proc/self/fd"):
        with contextlib.suppress(IsADirectoryError, NotImplementedError, OSError):
            return _NamelessFile(destination)
    return _NamedFile(destination)


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
            # No picture's ending: nobody takes it for one.
            name = f".{final}.{os.getpid()}.part"
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
        handle, self.path = tempfile.mkstemp(
            prefix=f".{destination.name}.", suffix=".part", dir=destination.parent
        )
        os.close(handle)
        _unfinished.add(self.path)

    def publish(self):
        with open(self.path, "rb+") as file:
            os.fsync(file.fileno())
        os.replace(self.path, self._destination)

    def close(self):
        with contextlib.suppress(FileNotFoundError):
            os.unlink(self.path)
        _unfinished.discard(self.path)


@contextlib.contextmanager
def removed_on_signals():
    """In the `with` block, SIGINT and SIGTERM remove unfinished files and end the process."""
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
            os.unlink(path)
    # As if there had been no handler, so that the caller sees what ended the process.
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
