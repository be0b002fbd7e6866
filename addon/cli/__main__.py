"""The command line as a script: ``python -m addon.cli WORD ...``."""

from .. import register
from .command import run_process

run_process(register)
