"""Visibility of highlights: masks over the lens of what is not occluded (methods 10, 11)."""
