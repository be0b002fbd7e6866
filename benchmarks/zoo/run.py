"""`scripts/zoo`: many scenes in worker processes, resumed, shrunk, summed up."""

import argparse
import os
import queue
import signal
import sys
import threading
import time
from collections import Counter
from pathlib import Path

from ..kept_results import KeptResults, fingerprint
from .scenes.script import script
from .shrink import shrink
from .worker_process import REPOSITORY, START_SECONDS, Worker

# What decides how a scene comes out: with other sources, scenes are judged again.
_SOURCES = ("addon", "gpu_shaders", "lens_profiles", "benchmarks/zoo")


class Run:
    """A run over the scenes of one seed.

    Parameters
    ----------
    options : argparse.Namespace
    """

    def __init__(self, options):
        self.options = options
        self.folder = options.folder
        self.folder.mkdir(parents=True, exist_ok=True)
        self.results = KeptResults(
            self.folder / f"{options.state}.jsonl", fingerprint(*_SOURCES), ("number",)
        )
        self.end = time.monotonic() + options.time_limit if options.time_limit else None
        self.stopped = ""
        self._start = time.monotonic()
        self._lock = threading.Lock()
        self._workers = []
        wanted = [options.scene] if options.scene is not None else range(options.count)
        self.numbers = list(wanted)

    def go(self):
        """Judge all scenes that are not judged yet."""
        waiting = queue.SimpleQueue()
        for number in self.numbers:
            if (number,) not in self.results.found:
                waiting.put(number)
        count = min(self.options.workers, max(waiting.qsize(), 1))
        self._workers = [Worker(self.folder / f"worker-{i}.log", 1) for i in range(count)]
        threads = [
            threading.Thread(target=self._work, args=(worker, waiting), daemon=True)
            for worker in self._workers
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            while thread.is_alive():
                thread.join(0.2)
                if self._left() <= 0.0 and not self.stopped:
                    self.stop("time limit")

    def stop(self, reason):
        """Have no more scenes judged and end the workers."""
        self.stopped = self.stopped or reason
        for worker in self._workers:
            worker.close()

    def _left(self):
        return float("inf") if self.end is None else self.end - time.monotonic()

    def _work(self, worker, waiting):
        while not self.stopped:
            try:
                number = waiting.get_nowait()
            except queue.Empty:
                break
            request = {"seed": self.options.seed, "number": number}
            if self.options.no_reference:
                request["ask"] = ["not repeatable"]
            verdict = worker.ask(request, self.options.scene_seconds)
            if self.stopped:
                # Not the scene's fault.
                break
            if verdict["kind"] != "ok" and "recipe" not in verdict:
                verdict["recipe"] = self._recipe(worker, number)
            if verdict["kind"] == "ok":
                verdict.pop("recipe", None)
            elif not self.options.no_shrink and verdict.get("recipe"):
                self._shrink(worker, number, verdict)
            if self.stopped:
                # Shrinking was broken off.
                break
            with self._lock:
                self.results.add({"number": number, **verdict})
                self._tell(number, verdict)
        worker.close()

    def _recipe(self, worker, number):
        request = {"seed": self.options.seed, "number": number, "draw": True}
        return worker.ask(request, START_SECONDS).get("recipe")

    def _shrink(self, worker, number, verdict):
        kind, text = verdict["kind"], _place(verdict)
        ask = [kind] if kind in {"not repeatable", "disagrees"} else []
        if kind in {"time", "crash"}:
            ask = ["not repeatable", "disagrees"]

        def fails(recipe):
            if self.stopped:
                return False
            request = {"recipe": recipe, "ask": ask}
            found = worker.ask(request, self.options.scene_seconds)
            return found["kind"] == kind and _place(found) == text

        seconds = min(self.options.shrink_seconds, self._left())
        verdict["recipe"], tries = shrink(verdict["recipe"], fails, 400, seconds)
        title = f"Scene {self.options.seed}:{number}: {kind}: {verdict['text']}"
        path = self.folder / f"{self.options.seed}-{number}.py"
        path.write_text(script(verdict["recipe"], title, path.name))
        verdict["script"] = str(path)
        verdict["tries"] = tries

    def _tell(self, number, verdict):
        done = sum((n,) in self.results.found for n in self.numbers)
        if verdict["kind"] == "ok":
            if self.options.verbose:
                numbers = " ".join(f"{k} {v:.3g}" for k, v in verdict["measured"].items())
                print(f"{self.options.seed}:{number} ok, {verdict['seconds']:.1f} s, {numbers}")
            elif done % 50 == 0:
                print(f"{done} of {len(self.numbers)} scenes", flush=True)
            return
        print(f"{self.options.seed}:{number} {verdict['kind']}: {verdict['text']}")
        if verdict["detail"]:
            print(verdict["detail"].rstrip())
        if "script" in verdict:
            print(Path(verdict["script"]).read_text())
        sys.stdout.flush()

    def summary(self):
        """Return the last lines: six at most, the failures among them."""
        found = [self.results.found[n,] for n in self.numbers if (n,) in self.results.found]
        kinds = Counter(entry["kind"] for entry in found)
        undecided = sum(bool(entry["measured"].get("undecided")) for entry in found)
        bad = [entry for entry in found if entry["kind"] != "ok"]
        left = len(self.numbers) - len(found)
        lines = [
            f"zoo: seed {self.options.seed}: {len(found)} of {len(self.numbers)} scenes,"
            f" {len(bad)} failed, {undecided} undecided by noise,"
            f" {time.monotonic() - self._start:.0f} s"
            + (f"; stopped ({self.stopped}), run again to go on" if left else ""),
            "zoo: "
            + ", ".join(
                f"{kinds[kind]} {text}"
                for kind, text in (
                    ("traceback", "tracebacks"),
                    ("refused", "refused"),
                    ("not finite", "non-finite"),
                    ("no pass", "without a pass"),
                    ("not repeatable", "differing repeats"),
                    ("disagrees", "disagree with the reference method"),
                    ("time", "too slow"),
                    ("crash", "crashed"),
                )
            ),
        ]
        for entry in bad[:3]:
            text = f"  {self.options.seed}:{entry['number']} {entry['kind']}: {entry['text']}"
            lines.append(
                text[:150] + (f" ({_short(entry['script'])})" if "script" in entry else "")
            )
        if len(bad) > 3:
            rest = " ".join(f"{self.options.seed}:{entry['number']}" for entry in bad[3:40])
            lines.append(f"  and {len(bad) - 3} more: {rest}")
        return lines, len(bad)


def _short(path):
    path = Path(path)
    return path.relative_to(REPOSITORY) if path.is_relative_to(REPOSITORY) else path


def _place(verdict):
    """Return what tells one failure from another: where a traceback ends, what it says."""
    if verdict["kind"] != "traceback":
        return ""
    places = [line for line in verdict["detail"].splitlines() if line.startswith('  File "')]
    return places[-1] if places else verdict["text"].partition(":")[0]


def arguments(words=None):
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(
        prog="scripts/zoo",
        description="Render random scenes and check each: no traceback, finite pixels, every pass"
        " there, the same bits twice, and agreement with the reference method. A scene that fails"
        " is shrunk, and the script that builds it is printed and kept in build/zoo. A run goes on"
        " where the last one with the same seed and sources stopped.",
    )
    parser.add_argument("--seed", type=int, default=1, help="which scenes; default 1")
    parser.add_argument("--count", type=int, default=500, help="how many; default 500")
    parser.add_argument("--scene", type=int, metavar="N", help="only this one of the seed's scenes")
    parser.add_argument(
        "--time-limit", type=float, metavar="SECONDS", help="stop then; another run goes on"
    )
    parser.add_argument(
        "--scene-seconds",
        type=float,
        default=60.0,
        metavar="SECONDS",
        help="a scene that takes more processor time has failed; default 60",
    )
    parser.add_argument(
        "--shrink-seconds",
        type=float,
        default=120.0,
        metavar="SECONDS",
        help="how long a scene that failed is shrunk; default 120",
    )
    parser.add_argument("--no-shrink", action="store_true", help="leave failures as they are")
    parser.add_argument(
        "--workers",
        type=int,
        default=min(os.cpu_count() or 1, 4),
        help="processes; default one a core, four at most",
    )
    parser.add_argument(
        "--no-reference", action="store_true", help="do not compare with the reference method"
    )
    parser.add_argument("--again", action="store_true", help="judge scenes again that were judged")
    parser.add_argument("--script", action="store_true", help="print the script of --scene, only")
    parser.add_argument("--verbose", action="store_true", help="a line for every scene")
    parser.add_argument(
        "--folder", type=Path, default=REPOSITORY / "build" / "zoo", help=argparse.SUPPRESS
    )
    options = parser.parse_args(words)
    # What was not compared is judged again where it is to be.
    options.state = f"seed-{options.seed}{'-alone' if options.no_reference else ''}"
    if options.script and options.scene is None:
        parser.error("--script needs --scene")
    if min(options.count, options.workers) < 1:
        parser.error("--count and --workers must be at least 1")
    return options


def main(words=None):
    """Run the zoo; returns the exit code: 0 only if no scene failed."""
    options = arguments(words)
    if options.script:
        print(_script_of(options.seed, options.scene))
        return 0
    if options.again:
        (options.folder / f"{options.state}.jsonl").unlink(missing_ok=True)
    run = Run(options)

    def end(number, _frame):
        run.stop("ended")
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, end)
    try:
        run.go()
    except KeyboardInterrupt:
        run.stop("ended")
    lines, failed = run.summary()
    print(*lines, sep="\n", flush=True)
    # Threads that wait for a worker that was ended are left behind.
    return 1 if failed else 0


def _script_of(seed, number):
    import bpy

    import addon

    from .scenes.recipe import make_recipe

    addon.register()
    return script(make_recipe(bpy, seed, number), f"Scene {seed}:{number}.")


if __name__ == "__main__":
    sys.exit(main())
