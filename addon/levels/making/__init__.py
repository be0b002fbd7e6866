"""From a mesh to its next level of detail."""
