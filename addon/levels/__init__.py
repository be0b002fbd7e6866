"""Levels of detail: made in the background, kept, chosen (methods 3)."""
