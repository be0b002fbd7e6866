"""Readers of Blender's node trees."""
