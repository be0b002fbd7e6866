"""`aplanat bench`, run in this process."""

import json
from types import SimpleNamespace

import pytest

from tests.cli.conftest import make_blend, refused, small_blend  # noqa: F401


@pytest.fixture
def aplanat(aplanat_bpy, capfd):
    """Run a bench in this process; tells code, out, err, and the answer of --json."""
    from benchmarks.command import main

    def run(*words):
        capfd.readouterr()
        code = main([str(word) for word in words])
        out, err = capfd.readouterr()
        answer = json.loads(out) if "--json" in words else None
        return SimpleNamespace(code=code, out=out, err=err, answer=answer)

    return run
