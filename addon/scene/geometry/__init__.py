"""Readers of Blender's evaluated objects."""
