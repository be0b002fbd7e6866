"""Skies of Blender's Sky Texture, computed on the CPU: plain numpy."""
