"""Seeing and setting the focus in the 3D view, for every render engine."""
