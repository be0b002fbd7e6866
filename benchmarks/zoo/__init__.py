"""Random scenes from seeds, and a judge of what Aplanat makes of them: `scripts/zoo`."""
