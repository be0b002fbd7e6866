"""Extraction of a snapshot from Blender's evaluated scene: the only reader of Blender's data."""
