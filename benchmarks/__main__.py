"""`aplanat bench` as a script: ``python -m benchmarks bench WORD ...``."""

from .command import run_process

run_process()
