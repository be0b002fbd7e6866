"""The command's two channels: one answer on stdout, progress and messages on stderr.

Blender, its drivers and libraries print to both. Their file descriptors are redirected to a
temporary file, whose end is shown if something fails unexpectedly.
"""

import contextlib
import ctypes
import os
import sys
import tempfile
import time

# Seconds between shown progress: rewritten on a terminal, as lines in a log.
_TERMINAL_SECONDS, _LOG_SECONDS = 0.5, 10.0


class Console:
    """Stdout and stderr without Blender's own messages.

    Parameters
    ----------
    verbose : bool
        Pass Blender's messages to stderr.
    """

    def __init__(self, verbose=False):
        _flush()
        self._kept = os.dup(1), os.dup(2)
        out, err = os.dup(1), os.dup(2)
        self.out = os.fdopen(out, "w", encoding="utf-8", errors="replace")
        self.err = os.fdopen(err, "w", encoding="utf-8", errors="replace")
        self._chatter = tempfile.TemporaryFile()  # noqa: SIM115 (closed with the console)
        if verbose:
            os.dup2(2, 1)
        else:
            os.dup2(self._chatter.fileno(), 1)
            os.dup2(self._chatter.fileno(), 2)
        # Python's streams may be other files than the descriptors, such as a test's.
        self._streams = sys.stdout, sys.stderr
        sys.stdout = open(1, "w", closefd=False, errors="replace")  # noqa: SIM115
        sys.stderr = open(2, "w", closefd=False, errors="replace")  # noqa: SIM115
        self._terminal = self.err.isatty()
        self._last = time.monotonic()
        self._line_open = False

    def answer(self, text):
        """Print a line on stdout."""
        try:
            self.out.write(text + "\n")
            self.out.flush()
        except BrokenPipeError:
            # The reader has closed the pipe (`| head`): drop the rest.
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.out.fileno())
            os.close(nowhere)

    def say(self, text):
        """Print a line on stderr."""
        self._end_progress()
        self.err.write(f"aplanat: {' '.join(text.split())}\n")
        self.err.flush()

    def progress(self, text):
        """Show progress, at most once in an interval."""
        now = time.monotonic()
        if now - self._last < (_TERMINAL_SECONDS if self._terminal else _LOG_SECONDS):
            return
        self._last = now
        if self._terminal:
            self._line_open = True
            self.err.write(f"\r\033[Kaplanat: {text}")
        else:
            self.err.write(f"aplanat: {text}\n")
        self.err.flush()

    def show_chatter(self, lines=20):
        """Print the end of what Blender printed, on stderr."""
        _flush()
        self._chatter.seek(0)
        text = self._chatter.read().decode("utf-8", "replace")
        self.err.writelines(line + "\n" for line in text.splitlines()[-lines:])
        self.err.flush()

    def close(self):
        """Restore stdout and stderr."""
        self._end_progress()
        _flush()
        sys.stdout, sys.stderr = self._streams
        for number, kept in zip((1, 2), self._kept, strict=True):
            os.dup2(kept, number)
            os.close(kept)
        self.out.close()
        self.err.close()
        self._chatter.close()

    def _end_progress(self):
        if self._line_open:
            self.err.write("\r\033[K")
            self._line_open = False


def _flush():
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(AttributeError, ValueError, OSError):
            stream.flush()
    # Blender's own prints wait in the C library's buffers.
    library = ctypes.CDLL("ucrtbase") if os.name == "nt" else ctypes.CDLL(None)
    library.fflush(None)
