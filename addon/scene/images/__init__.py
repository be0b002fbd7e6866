"""Readers of Blender's images."""
