"""The command line as a script: ``python -m addon.cli WORD ...``."""

from .command import run_process

run_process()
