"""A few hundred mutated lens files; benchmarks/tools/fuzz_lens_files.py reads thousands."""

import pytest

from benchmarks.tools import fuzz_lens_files as fuzz
from tests.lens_io.lens_texts import SINGLET, ZOOM

# One file may take this much more memory, in MiB: parsed text and findings of a file of 1 MiB.
MOST_GROWTH_MIB = 64.0


def test_mutated_lens_files_raise_nothing_but_our_error():
    outcome = fuzz.Outcome()
    contents = [*fuzz.samples("toml", fuzz.sample_folders()), SINGLET.encode(), ZOOM.encode()]
    for number in range(600):
        content = fuzz.mutated("toml", number, contents, seed=1)
        fuzz.check("toml", content, outcome, f"file {number}")
    assert not outcome.failures, "\n".join(outcome.failures[:3])
    assert outcome.counts["loaded"] > 30
    # Mutations reach most of the reader: if not, they would prove little.
    assert len(outcome.codes) >= 15
    assert outcome.grown_mib < MOST_GROWTH_MIB


@pytest.mark.parametrize("name", sorted(set(fuzz.FORMATS) - {"toml"}))
def test_mutated_foreign_files_raise_nothing_but_our_error(name):
    contents = fuzz.samples(name, fuzz.sample_folders())
    if not contents:
        pytest.skip(f"there is no {name} sample beside this checkout")
    outcome = fuzz.Outcome()
    for number in range(100):
        content = fuzz.mutated(name, number, contents, seed=1)
        fuzz.check(name, content, outcome, f"file {number}")
    assert not outcome.failures, "\n".join(outcome.failures[:3])


@pytest.mark.parametrize("text", [SINGLET, ZOOM], ids=["singlet", "zoom"])
def test_any_value_in_the_place_of_any_other_is_read_or_refused(text):
    # Each of these is a file's mistake; each must be noted at the key where it stands.
    values = ("true", "0", "-1", "1e308", "5e-324", "nan", "inf", "1e400", '""', "[]", "{}", "[[]]")
    values += ("9" * 400, "1979-05-27", "[1.0, 2.0]", "{ nd = 1.5 }", "{ a4_per_mm3 = 1e300 }")
    lines = text.splitlines()
    outcome = fuzz.Outcome()
    for at, line in enumerate(lines):
        key, equals, _ = line.partition(" = ")
        for value in values if equals else ():
            content = "\n".join([*lines[:at], f"{key} = {value}", *lines[at + 1 :]])
            fuzz.check("toml", content.encode(), outcome, f"{key} = {value[:20]} in line {at + 1}")
    assert not outcome.failures, "\n".join(outcome.failures[:3])
    assert outcome.counts["loaded"] > 20
