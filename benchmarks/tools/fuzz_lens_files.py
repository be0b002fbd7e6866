"""Mutated lens files: bytes, numbers and structure of real ones, read as a user's file would be.

Nothing but our own error may come out, no file may take two seconds, memory stays bounded, and what
loads must be usable: it is written, read back, and traced to finite numbers.

    python benchmarks/tools/fuzz_lens_files.py --count 10000

Every case follows from the seed, its format and its number alone, so `--format NAME --only NUMBER`
repeats one (`--save FILE` keeps its bytes).
"""

import argparse
import random
import re
import resource
import sys
import time
import traceback
import warnings
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
if str(REPOSITORY) not in sys.path:
    sys.path.insert(0, str(REPOSITORY))

from addon.errors import AplanatError, LensFileError, PrescriptionError  # noqa: E402
from addon.lens_io.toml.toml_reader import parse_lens  # noqa: E402
from addon.lens_io.toml.toml_writer import lens_toml  # noqa: E402
from addon.optics.focus import focused  # noqa: E402
from addon.optics.glass import REFERENCE_WAVELENGTH_NM  # noqa: E402
from addon.optics.lens_facts import lens_facts  # noqa: E402
from addon.optics.paraxial import first_order, image_distance  # noqa: E402
from addon.optics.rays.trace import Rays, trace  # noqa: E402
from benchmarks.tools.lens_file_formats import FORMATS, sample_folders, samples  # noqa: E402

# Processor time of one file: what else the machine does is not counted.
SLOWEST_ALLOWED_S = 2.0
# Number texts at the edges of what readers and arithmetic can do.
NUMBERS = (
    *("0", "-0.0", "1", "-1", "-1.0", "nan", "inf", "-inf", "1e308", "-1e308", "1e-308", "5e-324"),
    *("1e400", "-1e400", "1e-400", "1e15", "1e-15", "9223372036854775808", "true", "false", "[]"),
    *("1979-05-27", "'text'", "{}", "[1.0]", "0x7fffffff", "1_000", "+1.0", "07", "1.", ".5"),
    *("9" * 400, "1" * 5000, "0." + "3" * 3000),
)
NUMBER = re.compile(r"(?<![\w.])[+-]?(?:\d+\.?\d*(?:[eE][+-]?\d+)?|inf)(?![\w.])")
WORDS = (
    *("air", "N-BK7", "n-bk7", "XX99", "MIRROR", "stop", "radius_mm", "material", "surface"),
    *("lens", "zoom", "focus", "id", "INFINITY", "AS", "STO"),
)


@dataclass
class Outcome:
    """What a run found."""

    counts: Counter = field(default_factory=Counter)
    codes: Counter = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    slowest_s: float = 0.0
    slowest: str = ""
    grown_mib: float = 0.0


def mutated(name, number, contents, seed=0):
    """Return the bytes of one mutated file.

    Parameters
    ----------
    name : str
        A key of `FORMATS`.
    number, seed : int
    contents : sequence of bytes
        Of sample files.

    Returns
    -------
    bytes
    """
    chance = random.Random(f"{seed} {name} {number}")
    content = chance.choice(contents)
    for _ in range(chance.choice((1, 1, 1, 2, 3, 8))):
        kind = chance.choice((_mutate_bytes, _mutate_numbers, _mutate_numbers, _mutate_lines))
        content = kind(chance, content, contents, FORMATS[name])
    return content


def _mutate_bytes(chance, content, contents, _):
    data = bytearray(content)
    at = chance.randrange(len(data) + 1)
    size = chance.choice((1, 1, 2, 7, 50, 1000))
    match chance.randrange(7):
        case 0:
            data[at : at + size] = chance.randbytes(size)
        case 1:
            del data[at : at + size]
        case 2:
            data[at:at] = data[at : at + size]
        case 3:
            del data[at:]
        case 4:
            data[at:at] = bytes([chance.choice(b"[]{}=\"'#.,\n\r\t \\\x00\x7f\xff")]) * size
        case 5:
            other = chance.choice(contents)
            data[at:] = other[chance.randrange(len(other) + 1) :]
        case _ if data:
            data[min(at, len(data) - 1)] ^= 1 << chance.randrange(8)
    return bytes(data)


def _mutate_numbers(chance, content, _, __):
    text, encode = _decoded(content)
    found = list(NUMBER.finditer(text))
    if not found:
        return content
    chosen = chance.choice(found)
    match chance.randrange(5):
        case 0 | 1:
            new = chance.choice(NUMBERS)
        case 2:
            new = repr(float(chosen.group()) * 10.0 ** chance.uniform(-3.0, 3.0))
        case 3:
            new = repr(-float(chosen.group()))
        case _:
            new = chance.choice(found).group()
    return encode(text[: chosen.start()] + new + text[chosen.end() :])


def _mutate_lines(chance, content, contents, kind):
    text, encode = _decoded(content)
    lines = text.split("\n")
    at, other = chance.randrange(len(lines)), chance.randrange(len(lines))
    low, high = min(at, other), max(at, other)
    match chance.randrange(9):
        case 0:
            del lines[at]
        case 1:
            lines.insert(other, lines[at])
        case 2:
            lines[at], lines[other] = lines[other], lines[at]
        case 3:
            lines[at:at] = lines[low:high] * chance.choice((1, 2, 20))
        case 4:
            del lines[low:high]
        case 5 | 6 if kind.lines:
            lines.insert(at, chance.choice(kind.lines))
        case 7:
            words = lines[at].split(" ")
            words[chance.randrange(len(words))] = chance.choice(WORDS)
            lines[at] = " ".join(words)
        case _:
            lines[at:at] = _decoded(chance.choice(contents))[0].split("\n")[low:high]
    # Doubling blocks again and again would only test the limit of the size.
    return encode("\n".join(lines)[:200_000])


def _decoded(content):
    name = "utf-16" if content.startswith((b"\xff\xfe", b"\xfe\xff")) else "latin-1"
    if name == "latin-1":
        try:
            text, name = content.decode("utf-8"), "utf-8"
        except UnicodeDecodeError:
            text = content.decode("latin-1")
    else:
        text = content.decode("utf-16", errors="replace")
    return text, lambda changed: changed.encode(name, errors="replace")


def check(name, content, outcome, label=""):
    """Read one file and note what came of it.

    Parameters
    ----------
    name : str
        A key of `FORMATS`.
    content : bytes
    outcome : Outcome
    label : str
        How messages name the case.
    """
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            _use(FORMATS[name].read(content))
        outcome.counts["loaded"] += 1
    except AplanatError as error:
        outcome.counts["refused"] += 1
        if isinstance(error, LensFileError):
            outcome.codes.update({finding.code for finding in error.findings})
            # What goes to a terminal or to JSON must be one printable line.
            if not all(one.message.isprintable() for one in error.findings):
                outcome.failures.append(f"{label}: a message is not printable")
    except Exception:
        outcome.failures.append(f"{label}:\n{traceback.format_exc()}")
    seconds = time.process_time() - start
    if seconds > outcome.slowest_s:
        outcome.slowest_s, outcome.slowest = seconds, label
    if seconds > SLOWEST_ALLOWED_S:
        outcome.failures.append(f"{label}: took {seconds:.2f} s")
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024.0
    outcome.grown_mib = max(outcome.grown_mib, grown)


def _use(prescription):
    again = parse_lens(lens_toml(prescription).encode(), "again").prescription
    assert again == prescription, "what was written reads back differently"
    for label, configuration in zip(
        prescription.labels, prescription.configurations(), strict=True
    ):
        for use in (_first_order, _facts, _focus, _rays):
            try:
                use(prescription, configuration, label)
            except PrescriptionError:
                # Loaded, but with nothing to trace under these settings: said in our words.
                continue


def _first_order(prescription, configuration, label):
    for wavelength in (REFERENCE_WAVELENGTH_NM, 440.0, 680.0):
        _check_finite(vars(first_order(configuration, wavelength)).values())
        _check_finite([image_distance(configuration, 1000.0, wavelength)])


def _facts(prescription, configuration, label):
    _check_finite(vars(lens_facts(prescription, label)).values())


def _focus(prescription, configuration, label):
    near = focused(configuration.stopped_down(8.0), 1000.0, prescription.focus)
    _check_finite([near.sensor, *near.vertices])


def _rays(prescription, configuration, label):
    height = min(first_order(configuration).enp_diameter, 1.0e6)
    heights = np.linspace(-1.0, 1.0, 9) * height
    origins = np.stack([0.3 * heights, heights, np.full(9, -1.0)], axis=-1)
    rays = Rays(origins, np.tile([0.0, np.sin(0.1), np.cos(0.1)], (9, 1)))
    for clip in (True, False):
        traced = trace(configuration, rays, REFERENCE_WAVELENGTH_NM, clip=clip, transmission=True)
        for values in (traced.points, traced.directions, traced.at_plane(10.0)):
            _check_finite(values.ravel())
        _check_finite(traced.transmission)


def _check_finite(values):
    numbers = [value for value in values if value is not None]
    assert np.isfinite(numbers).all(), f"not finite: {numbers}"


def run(count, names, seed=0, say=lambda line: None):
    """Read mutated files, spread evenly over formats.

    Parameters
    ----------
    count : int
    names : sequence of str
    seed : int
    say : callable
        Takes a line of progress.

    Returns
    -------
    Outcome
    """
    outcome = Outcome()
    contents = {name: samples(name, sample_folders()) for name in names}
    present = [name for name in names if contents[name]]
    for number in range(count):
        name = present[number % len(present)]
        content = mutated(name, number, contents[name], seed)
        check(name, content, outcome, f"--seed {seed} --format {name} --only {number}")
        if number % 1000 == 999:
            say(f"{number + 1} files, {len(outcome.failures)} failures")
    return outcome


def main():
    """Read mutated lens files and tell what failed."""
    parser = argparse.ArgumentParser(description="Read mutated lens files.")
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--format", choices=tuple(FORMATS), action="append")
    parser.add_argument("--only", type=int, help="read the file with this number alone")
    parser.add_argument("--save", type=Path, help="with --only: where to keep its bytes")
    options = parser.parse_args()
    names = options.format or list(FORMATS)
    if options.only is not None:
        outcome = Outcome()
        contents = samples(names[0], sample_folders())
        content = mutated(names[0], options.only, contents, options.seed)
        if options.save:
            options.save.write_bytes(content)
        check(names[0], content, outcome, str(options.only))
    else:
        outcome = run(options.count, names, options.seed, lambda line: print(line, flush=True))
    for failure in outcome.failures[:8]:
        print(failure)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(dict(outcome.counts), dict(sorted(outcome.codes.items())))
    print(
        f"{len(outcome.failures)} failures; slowest {outcome.slowest_s:.3f} s ({outcome.slowest}); "
        f"peak memory {peak:.0f} MiB, at most {outcome.grown_mib:.0f} MiB more by one file"
    )
    return 1 if outcome.failures else 0


if __name__ == "__main__":
    sys.exit(main())
