"""The words of `aplanat bench`."""

import pytest

from addon.errors import InputError
from benchmarks.arguments import parse


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--samples", "0"], "not between"),
        (["--lens", "tessar", "--scene", "toys"], "not allowed with"),
        (["--peers"], "belongs to --method adaptive"),
        (["--chromatic", "--method", "adaptive"], "neither --method nor --lens"),
        (["--bokeh", "truth", "--lens", "tessar"], "neither --method nor --lens"),
    ],
)
def test_words_that_make_no_bench_are_refused(words, message):
    with pytest.raises(InputError, match=message):
        parse(["bench", *words])


def test_help_is_printed(capsys):
    with pytest.raises(SystemExit) as ended:
        parse(["bench", "--help"])
    assert ended.value.code == 0
    assert "usage: aplanat bench" in capsys.readouterr().out
