"""Captured pictures seen through the lens again: another focus, f-number, lens, bokeh."""
