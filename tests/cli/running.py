"""The command line, run in the process of a test."""

import json
from types import SimpleNamespace


def runner(main, capfd):
    """Return a function that runs a command's words; tells code, out, err, answer of --json.

    Parameters
    ----------
    main : callable
        From a list of words to the exit code.
    capfd : fixture
    """

    def run(*words):
        capfd.readouterr()
        code = main([str(word) for word in words])
        out, err = capfd.readouterr()
        answer = json.loads(out) if "--json" in words else None
        return SimpleNamespace(code=code, out=out, err=err, answer=answer)

    return run
