"""Mesh simplification: from a mesh to its next level of detail."""
