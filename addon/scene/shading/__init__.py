"""Readers of Blender's materials, lights and worlds."""
