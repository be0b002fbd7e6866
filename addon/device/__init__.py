"""The graphics device: the only importer of Blender's `gpu` module."""
