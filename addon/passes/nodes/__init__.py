"""Node trees as GLSL."""
