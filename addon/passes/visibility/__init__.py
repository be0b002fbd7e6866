"""Passes that find the occluders between highlights and the lens (methods 10, 11)."""
