"""Drawings of lenses, with matplotlib, which is imported when something is drawn."""
