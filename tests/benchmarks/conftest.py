"""`aplanat bench`, run in this process."""

import pytest

from tests.cli.conftest import make_blend, refused, small_blend  # noqa: F401
from tests.cli.running import runner


@pytest.fixture
def aplanat(aplanat_bpy, capfd):
    """Run a bench in this process; tells code, out, err, and the answer of --json."""
    from benchmarks.command import main

    return runner(main, capfd)
