"""Sample sequences, pixel filter, thin lens and spectrum: pure numpy, no Blender."""
