"""A process that judges scenes of the zoo, watched from outside."""

import json
import os
import selectors
import subprocess
import sys
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
START_SECONDS = 120.0
# Scenes after which a worker is replaced, so that what one leaves behind stays bounded.
_SCENES_A_WORKER = 100
# A scene may take so many times its limit of processor time by the clock: a machine that does much
# else is slow, and what sleeps for ever must end.
_MOST_WAITING = 12.0


class Worker:
    """A process that judges scenes, started again when it dies.

    Parameters
    ----------
    log : Path
        Where it writes what Blender says.
    threads : int
        Of software OpenGL, and of numpy's products of matrices.
    """

    def __init__(self, log, threads):
        self._log = log
        self._threads = threads
        self._process = None
        self._judged = 0

    def ask(self, request, seconds):
        """Return the answer to a request.

        Parameters
        ----------
        request : dict
            See `worker`.
        seconds : float
            Of processor time, after which the process is ended.

        Returns
        -------
        dict
            With ``kind`` ``"time"`` or ``"crash"`` where there was no answer.
        """
        if self._judged >= _SCENES_A_WORKER:
            self.close()
        if self._process is None and not self._start():
            return self._lost("crash", "the worker does not start")
        self._judged += 1
        try:
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()
        except (BrokenPipeError, ValueError, AttributeError):
            return self._lost("crash", "the process is gone")
        answer = self._answer(seconds)
        if answer is not None:
            return answer
        process = self._process
        if process is not None and process.poll() is None:
            return self._lost("time", f"not done after {seconds:.0f} s of processor time")
        return self._lost("crash", f"the process ended with {process and process.returncode}")

    def close(self):
        """End the process."""
        process, self._process, self._judged = self._process, None, 0
        if process is not None:
            process.kill()
            process.wait()
            process.stdin.close()
            process.stdout.close()

    def _start(self):
        # Threads of numpy, too: on a busy machine they wait for one another, and waiting counts.
        threads = str(self._threads)
        environment = dict(os.environ, LP_NUM_THREADS=threads, OPENBLAS_NUM_THREADS=threads)
        environment["PYTHONPATH"] = str(REPOSITORY)
        self._process = subprocess.Popen(
            [sys.executable, "-X", "faulthandler", "-m", "benchmarks.zoo.worker"],
            cwd=REPOSITORY,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log.open("w"),
            text=True,
        )
        return self._answer(START_SECONDS) is not None

    def _answer(self, seconds):
        process = self._process
        begun, end = _processor_seconds(process.pid), time.monotonic() + _MOST_WAITING * seconds
        with selectors.DefaultSelector() as selector:
            selector.register(process.stdout, selectors.EVENT_READ)
            while not selector.select(0.2):
                used = _processor_seconds(process.pid) - begun
                if used > seconds or time.monotonic() > end:
                    return None
        try:
            line = process.stdout.readline()
        except ValueError:
            return None
        if not line:
            process.wait()
            return None
        return json.loads(line)

    def _lost(self, kind, text):
        self.close()
        tail = self._log.read_text(errors="replace")[-3000:] if self._log.exists() else ""
        return {"kind": kind, "text": text, "detail": tail, "measured": {}, "seconds": 0.0}


def _processor_seconds(pid):
    """Return the processor time of a process, or the time of day where none is told."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return time.monotonic()
    # utime and stime.
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
