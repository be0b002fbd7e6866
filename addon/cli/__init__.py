"""The command line: `python -m addon.cli`, and `blender --command aplanat`."""
