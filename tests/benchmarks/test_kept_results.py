"""Results of long runs: kept, gone on from, and measured anew for other sources."""

from benchmarks.kept_results import KeptResults, fingerprint

NAMES = ("case", "number")


def test_a_run_goes_on_where_another_was_killed(tmp_path):
    path = tmp_path / "results.jsonl"
    KeptResults(path, "a", NAMES).add({"case": "toys", "number": 1, "error": 0.5})
    with path.open("a") as file:
        file.write('{"case": "toys", "nu')
    again = KeptResults(path, "a", NAMES)
    assert list(again.found) == [("toys", 1)]
    again.add({"case": "toys", "number": 2})
    assert list(KeptResults(path, "a", NAMES).found) == [("toys", 1), ("toys", 2)]
    assert KeptResults(path, "b", NAMES).found == {}


def test_a_fingerprint_is_that_of_its_folders():
    assert fingerprint("farm") == fingerprint("farm") != fingerprint("findings")
