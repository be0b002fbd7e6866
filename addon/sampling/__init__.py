"""Sample sequences and the thin lens: pure numpy, no Blender."""
