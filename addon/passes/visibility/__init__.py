"""Passes that find what hides a highlight from the lens (methods 10, 11)."""
