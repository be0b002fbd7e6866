"""Readers of a Blender camera."""
